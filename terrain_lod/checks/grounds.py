"""Ground, ordinary and hard on 32-bit floats, with what the references find of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Final

import numpy as np
import numpy.typing as npt

from ..camera.camera import Camera
from ..device.device import Device
from ..device.layout import FLAT_TILE
from ..ground.grid import TileGrid
from ..ground.heightmap import Heightmap
from ..ground.relief import Relief
from ..mesh.mesh import Mesh
from ..reference.terrain import analysis, hull, ladder
from ..terrain.buffers import DeviceAnalysis, DeviceGround, DevicePatches
from ..terrain.control_points import patch_indices
from ..terrain.tiles import DeviceTiles
from .check import Array, highest_of

_SIZE: Final = 46  # samples along a side: three tiles of 15 cells
_STEP: Final = 30.0  # metres from sample to sample
_FAR: Final = (500_000.0, 4_000_000.0)


class Ground:
    """A heightmap with what its references find; they are given the sum of it and its detail."""

    def __init__(
        self, ground: Heightmap, *, detail: Heightmap | None = None, tile: int = FLAT_TILE
    ) -> None:
        self.relief = Relief(ground, detail)
        self.sum = self.relief.sum() if detail else ground
        self.grid = TileGrid.of(self.sum, tile)
        self.origin = (*self.sum.origin, self.sum.base)
        known = self.sum.heights[self.sum.valid].astype(np.float64)
        self.highest, self.range = highest_of(known), float(np.ptp(known))

    def upload(self, device: Device) -> DeviceGround:
        return DeviceGround.upload(self.relief, self.grid.tile, device)

    @cached_property
    def fits(self) -> list[analysis.TileFit]:
        return analysis.analyse(self.sum, tile=self.grid.tile)

    @cached_property
    def ranges(self) -> npt.NDArray[np.float64]:
        """Height range of each tile; 0 where it has no data."""
        return np.nan_to_num([fit.maximum - fit.minimum for fit in self.fits])

    @property
    def lowest(self) -> float:
        """Where corners without data stand."""
        return float(np.nanmin([fit.minimum for fit in self.fits]))

    def tiles(self, device: Device) -> DeviceTiles:
        """Upload the ground, and what the kernels before a stage should have found of it."""
        shape = (*self.grid.shape, 4)
        planes, details = (
            device.array(each.astype(np.float32).reshape(shape))
            for each in planes_and_details(self.fits)
        )
        corners = hull.control_points(self.sum, self.grid, self.lowest)
        points = np.pad(corners, [(0, 0), (0, 0), (0, 1)], constant_values=1.0)
        return DeviceTiles(
            self.upload(device),
            DeviceAnalysis("least_squares", planes, details),
            DevicePatches(
                device.array(points.astype(np.float32)),
                device.array(patch_indices(*self.grid.shape)),
            ),
        )

    @cached_property
    def ladder(self) -> tuple[Array, Array, Array, Array]:
        """Errors of tiles, of their inner samples, of edges across and of edges down."""
        return ladder.ladder(self.sum, self.grid, self.fits)

    @property
    def largest(self) -> Array:
        """Largest x, y and z relative to the origin, for bounds in their last place."""
        return np.array([*self.sum.extent, self.highest])

    def crossing_triangles(self, seed: int) -> Mesh:
        """Return triangles of all sizes that cross each other and the raster's border."""
        random, (rows, columns) = np.random.default_rng(seed), self.sum.shape
        low, high = (height - self.sum.base for height in self.sum.height_range)
        corners = random.uniform((-9, -rows - 9, low), (columns + 9, 9, high), (300, 3))
        corners[:, :2] *= self.sum.spacing
        return Mesh(
            corners.astype(np.float32),
            np.tile(np.array([0, 0, 1], np.float32), (len(corners), 1)),
            random.integers(0, len(corners), (200, 3)).astype(np.int32),
            origin=np.array(self.origin),
        )


def planes_and_details(fits: list[analysis.TileFit]) -> tuple[Array, Array]:
    """Return the analysis kernel's two outputs, (P, 4) each."""
    planes = [(*fit.normal, fit.height) for fit in fits]
    details = [(fit.deviation, fit.minimum, fit.maximum, fit.nodata) for fit in fits]
    return np.array(planes), np.array(details)


@cache
def plain_grounds() -> dict[str, Ground]:
    """Return ordinary ground of some dozen tiles, far from its world's origin.

    Kernels are built differently for ground with holes and with detail.
    """
    return {
        "rough": Ground(_rough(66, 50)),
        "with holes": Ground(_rough(66, 50, holed=True)),
        "with holes and detail": Ground(
            _rough(13, 16, holed=True),
            detail=Heightmap(
                np.random.default_rng(2).normal(size=(11, 13)), spacing=(30.0 / 3, 20.0 / 5)
            ),
        ),
    }


def _rough(rows: int, columns: int, *, holed: bool = False) -> Heightmap:
    random = np.random.default_rng(1)
    heights = random.normal(size=(rows, columns)).cumsum(axis=0).cumsum(axis=1)
    if holed:
        heights[random.random(heights.shape) < 0.01] = np.nan
        heights[: rows // 4, : columns // 3] = np.nan
    return Heightmap(heights, spacing=(30.0, 20.0), origin=_FAR)


def _tiled(tile: int) -> Ground:
    """Return ground with holes, in tiles of so many cells, some of them cut."""
    return Ground(_rough(5 * tile + 2, 3 * tile + 3, holed=True), tile=tile)


@cache
def hard_grounds() -> dict[str, Ground]:
    """Return the hard grounds by name; the same every time."""
    row, column = np.mgrid[:_SIZE, :_SIZE].astype(np.float64)
    noise = np.random.default_rng(3).normal(size=row.shape)
    rough = np.random.default_rng(5).normal(size=row.shape).cumsum(axis=0).cumsum(axis=1)
    heights = {
        "constant, 8,848 m": np.full(row.shape, 8848.0),
        "millimetres on a slope at 8,848 m": 8848 + 0.5 * column + 1e-3 * noise,
        "millimetres on a slope at 1,000 km": 1e6 + 0.5 * column + 1e-3 * noise,
        "one spike": np.where((row == 20) & (column == 21), 1e4, 0.0),
        "cliff of one cell": np.where(column > 22, 500.0, 0.0),
        "checkerboard of ±1": np.where((row + column) % 2, 1.0, -1.0),
        "denormals": 1e-42 * row * column,
        "near the end of float32": np.where(noise > 0, 1e38, -1e38),
        "extremes of int16": np.where(noise > 0, 32767.0, -32768.0),
        "hole of one sample": np.where((row == 20) & (column == 21), np.nan, rough),
        "hole of one row": np.where(row == 20, np.nan, rough),
        "hole of a tile": np.where((row <= 15) & (column <= 15), np.nan, rough),
        "all but one sample missing": np.where((row == 7) & (column == 8), 5.0, np.nan),
        "samples on one line": np.where(row == column, column, np.nan),
        "2 × 2 samples": rough[:2, :2],
        "one sample more than a tile": rough[:17, :17],
    }
    for slope in (0.001, 1.0, 1000.0):
        heights[f"plane of slope {slope:g}"] = slope * _STEP * (column - 0.3 * row)
    made = {name: Ground(Heightmap(each, spacing=_STEP)) for name, each in heights.items()}
    made["spacing 1 : 1000"] = Ground(Heightmap(rough, spacing=(1.0, 1000.0)))
    far, farther = (1e6, -1e6), (-3e5, 7e6)
    made["coordinates of 1,000 km"] = Ground(Heightmap(rough, spacing=_STEP, origin=far))
    fine = Heightmap(rough, spacing=(0.1, 0.3), origin=farther)
    made["decimetres at 7,000 km"] = Ground(fine)
    return made | {f"tiles of {tile} cells": _tiled(tile) for tile in (1, 3, 6, 7, 8)}


@cache
def steep_grounds() -> dict[str, Ground]:
    """Return the hard grounds, and some whose slopes pass float32's range."""
    noise = np.random.default_rng(7).normal(size=(_SIZE, _SIZE))
    tilted = np.arange(_SIZE) + 0.1 * noise
    made = {
        "slopes beyond float32": Heightmap(1e37 * noise, spacing=(1e-12, 3e-12)),
        "tilted beyond float32": Heightmap(1e25 * tilted, spacing=(1e-18, 1e-17)),
    }
    return hard_grounds() | {name: Ground(each) for name, each in made.items()}


@cache
def wide_tiles() -> dict[str, Ground]:
    """Return more sizes of tiles, whose ladders would take their reference too long."""
    return {f"tiles of {tile} cells": _tiled(tile) for tile in (2, 10, 16, 31, 63)}


@dataclass(frozen=True, eq=False)
class View:
    """A ground and a camera over it."""

    ground: Ground
    camera: Camera


def oblique(ground: Ground) -> View:
    """Return a ground under an ordinary camera."""
    x, y, z = ground.sum.centre
    return View(ground, Camera((x - 300, y - 400, z + 500), (x + 500, y + 700, z), far=5e4))


@cache
def plain_views() -> dict[str, View]:
    """Return an ordinary camera over each ordinary ground."""
    return {name: oblique(ground) for name, ground in plain_grounds().items()}


@cache
def hard_views() -> dict[str, View]:
    """Return the hard cameras over ordinary ground, and an ordinary one over each hard ground."""
    steps = np.random.default_rng(5).normal(size=(_SIZE, _SIZE))
    heights = 10 * steps.cumsum(axis=0).cumsum(axis=1)
    ground = Ground(Heightmap(heights, spacing=_STEP))
    x, y, z = ground.sum.centre
    x0, y0 = ground.sum.origin
    corner = x0, y0, ground.sum.base + float(ground.sum.heights[0, 0])
    above = x, y - 600.0, z + 900.0
    cameras = {
        "camera on a corner": Camera(corner, (x, y, z)),
        "camera inside the ground": Camera((x, y, z - 20.0), (x + 100.0, y + 50.0, z)),
        "camera at 10⁷ m": Camera((x - 1e7, y, z + 1e6), (x, y, z)),
        "field of view 0.1°": Camera(above, (x, y, z), fov=0.1),
        "field of view 179°": Camera(above, (x, y, z), fov=179.0),
        "parallel camera": Camera(above, (x, y, z), height=700.0),
    }
    over = {name: View(ground, camera) for name, camera in cameras.items()}
    return over | {name: oblique(ground) for name, ground in hard_grounds().items()}
