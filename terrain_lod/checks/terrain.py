"""Checks of the kernels that make a terrain of a heightmap, and of those that measure it."""

from __future__ import annotations

from functools import cache, cached_property
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..camera.camera import Camera
from ..device.device import Device
from ..device.layout import DEFAULT_TILE, FIXED_ONE
from ..errors import InputError
from ..ground.grid import TileGrid
from ..ground.heightmap import Heightmap
from ..ground.relief import Relief
from ..measure.error import vertical_error
from ..mesh.mesh import Mesh
from ..reference.measure import error
from ..reference.terrain import (
    analysis,
    domain,
    holes,
    hull,
)
from ..reference.terrain.lod import Formula
from ..terrain.analysis import PLANES, analyse_on_device
from ..terrain.buffers import DeviceAnalysis, DeviceGround
from ..terrain.control_points import patches_on_device
from ..terrain.domain import displace_on_device
from ..terrain.holes import without_holes_on_device
from ..terrain.hull import EDGE_RULES, hull_on_device
from ..terrain.lod import Lod
from ..terrain.lod_formulas import CoplanarityLod, DistanceLod, ScreenAreaLod, UniformLod
from ..terrain.tiles import DeviceTiles
from ..tessellation.pattern import DevicePattern
from .checkup import Check, largest_difference, unequal_rows

Array = npt.NDArray[Any]

# two roundings of coordinates of thousands of metres, and of factors up to 63
METRES: Final = 1e-3
_SEGMENTS: Final = 1e-4
# share of the height range: sums of 256 heights, and a normal over the width of a tile
_FIT: Final = 2e-6
# of a case's detail, a cell along x and y
_STEPS: Final = (3, 5)

_LODS: Final[tuple[Lod, ...]] = (
    UniformLod(5.5),
    DistanceLod(falloff=2.5),
    CoplanarityLod(),
    ScreenAreaLod(),
)


class Case:
    """Ground far from its world's origin, and what the reference finds.

    With detail, kernels find the samples of `ground`, whereas references are given them.
    """

    def __init__(
        self, *, holed: bool, detailed: bool = False, shape: tuple[int, int] = (200, 170)
    ) -> None:
        random = np.random.default_rng(1)
        across, down = _STEPS if detailed else (1, 1)
        heights = random.normal(size=(shape[0] // down, shape[1] // across))
        heights = heights.cumsum(axis=0).cumsum(axis=1)
        if holed:
            heights[random.random(heights.shape) < 0.01] = np.nan
            heights[: 17 // down, : 17 // across] = np.nan
        ground = Heightmap(heights, spacing=(30.0, 20.0), origin=(500_000.0, 4_000_000.0))
        detail = Heightmap(random.normal(size=(11, 13)), spacing=(30.0 / across, 20.0 / down))
        self.relief = Relief(ground, detail if detailed else None)
        self.ground = self.relief.sum()
        self.grid = TileGrid.of(self.ground, DEFAULT_TILE)
        self.origin = (*self.ground.origin, self.ground.base)

    def upload(self, device: Device) -> DeviceGround:
        return DeviceGround.upload(self.relief, DEFAULT_TILE, device)

    @cached_property
    def fits(self) -> list[analysis.TileFit]:
        return analysis.analyse(self.ground)

    def tiles(self, device: Device) -> DeviceTiles:
        """Upload the ground, and what the analysis kernel should have found."""
        ground, shape = self.upload(device), (*self.grid.shape, 4)
        planes, details = (
            device.array(values.astype(np.float32).reshape(shape)) for values in _outputs(self.fits)
        )
        fits = DeviceAnalysis("least_squares", planes, details)
        return DeviceTiles(ground, fits, patches_on_device(ground, fits))


@cache
def cases() -> tuple[Case, Case, Case]:
    """Kernels are built differently for ground with holes and with detail, so all are tried."""
    return Case(holed=False), Case(holed=True), Case(holed=True, detailed=True)


def _outputs(fits: list[analysis.TileFit]) -> tuple[Array, Array]:
    """Return the analysis kernel's two outputs, (P, 4) each."""
    planes = [(*fit.normal, fit.height) for fit in fits]
    details = [(fit.deviation, fit.minimum, fit.maximum, fit.nodata) for fit in fits]
    return np.array(planes), np.array(details)


def check_analysis(device: Device) -> Check:
    differences = []
    for case in cases():
        # a normal's error tells in the height at the end of a tile
        length = DEFAULT_TILE * max(case.ground.spacing)
        reach = np.array([length, length, length, 1.0])
        for plane in PLANES:
            found = analyse_on_device(case.upload(device), plane=plane)
            planes, details = _outputs(analysis.analyse(case.ground, plane=plane))
            differences.append(
                largest_difference(found.planes.host().reshape(-1, 4) * reach, planes * reach)
            )
            differences.append(largest_difference(found.details.host(), details))
    return Check(max(differences), _FIT * float(np.ptp(cases()[0].ground.height_range)), "m")


def check_control_points(device: Device) -> Check:
    differences = []
    for case in cases():
        found = case.tiles(device).patches
        lowest = float(np.nanmin([fit.minimum for fit in case.fits]))
        expected = hull.control_points(case.ground, case.grid, lowest)
        differences.append(largest_difference(found.control_points.host()[..., :3], expected))
    return Check(max(differences), METRES, "m")


def check_hull(device: Device) -> Check:
    worst = max(check_lod(lod, device=device).error for lod in _LODS)
    return Check(worst, _SEGMENTS, "segments")


def check_lod(lod: Lod, reference: Formula | None = None, *, device: Device | None = None) -> Check:
    """Compare what a level of detail's header computes with its reference, on rough ground.

    Parameters
    ----------
    lod : Lod
    reference : callable, optional
        ``(patch, parameters) -> segments`` in float64: see
        :class:`terrain_lod.reference.terrain.lod.Patch`. Default: that of a header of ``kernels/``.
    device : Device, optional

    Returns
    -------
    Check
        ``error`` is the worst difference of a factor, in segments; ``bound`` what rounding allows.

    Raises
    ------
    InputError
        If `lod` has no header.
    """
    if not isinstance(lod, Lod):
        raise InputError(f"expected a level of detail with a header, got {lod!r}")
    device, differences = device or Device.open(), []
    for case in cases():
        ground, grid = case.ground, case.grid
        x, y, z = ground.centre
        camera = Camera((x - 300, y - 400, z + 500), (x + 500, y + 700, z), far=5e4)
        eye, tiles = np.subtract(camera.eye, case.origin), case.tiles(device)
        planes = camera.planes(case.origin)
        for edges in EDGE_RULES:
            found = hull_on_device(tiles, lod, camera, edge_rule=edges)
            looked: dict[str, Any] = {"edge_rule": edges, "camera": camera, "formula": reference}
            edge, inside = hull.factors(
                ground, grid, case.fits, lod, tiles.scene, eye, planes, **looked
            )
            differences.append(largest_difference(found.edge.host(), edge))
            differences.append(largest_difference(found.inside.host(), inside))
    return Check(max(differences), _SEGMENTS, "segments")


def check_domain(device: Device) -> Check:
    differences = []
    random, count = np.random.default_rng(3), 40
    for case in cases():
        grid = case.grid
        points = random.integers(0, FIXED_ONE + 1, (grid.count * count, 2)).astype(np.uint32)
        offsets = np.arange(0, len(points) + 1, count, dtype=np.uint32)
        none = device.zeros((0, 3), np.int32)
        pattern = DevicePattern(device.array(points), none, device.array(offsets), none)
        found = displace_on_device(case.tiles(device).patch_set, pattern)
        patch = np.repeat(np.arange(grid.count), count)
        positions, normals = domain.displace(case.ground, grid, points, patch)
        # a point in a cell without data has no height
        columns, rows = domain.global_coordinates(grid, points, patch)
        cells = np.pad(holes.cells_with_data(case.ground), (0, 1), mode="edge")
        known = cells[rows // FIXED_ONE, columns // FIXED_ONE]
        differences.append(largest_difference(found.positions.host()[known], positions[known]))
        differences.append(largest_difference(found.normals.host()[known], normals[known]))
    return Check(max(differences), METRES, "m")


def check_holes(device: Device) -> Check:
    return Check(max(_unlike_holes(case, device) for case in cases()[1:]), 0.0, "triangles")


def _unlike_holes(case: Case, device: Device) -> float:
    """Return how many triangles are left out, or stay, that should not."""
    # 6 x 6 points a tile, two triangles a cell between them
    side, tiles = 6, case.grid.count
    places = np.linspace(0, FIXED_ONE, side).round().astype(np.uint32)
    points = np.tile(np.stack(np.meshgrid(places, places), axis=-1).reshape(-1, 2), (tiles, 1))
    a = (side * np.arange(side - 1)[:, None] + np.arange(side - 1)).ravel()
    b, c, d = a + 1, a + side, a + side + 1
    cells = np.concatenate([np.stack([a, c, b], axis=1), np.stack([b, c, d], axis=1)])
    patch = np.repeat(np.arange(tiles), len(cells))
    triangles = (np.tile(cells, (tiles, 1)) + side**2 * patch[:, None]).astype(np.int32)
    pattern = DevicePattern(
        device.array(points),
        device.array(triangles),
        device.array(np.arange(0, len(points) + 1, side**2, dtype=np.uint32)),
        device.array(np.arange(0, len(triangles) + 1, len(cells), dtype=np.uint32)),
    )
    found = without_holes_on_device(case.tiles(device).patch_set, pattern)
    expected = triangles[holes.kept(case.ground, case.grid, points, triangles, patch)]
    used_points, corners = holes.with_used_points(points, expected)
    return unequal_rows(found.primitives.host(), corners) + unequal_rows(
        found.points.host(), used_points
    )


def check_vertical_error(device: Device) -> Check:
    case = cases()[1]
    rows, columns = case.ground.shape
    random = np.random.default_rng(4)
    # triangles of all sizes that cross each other, and the raster's border
    corners = random.uniform((-9, -rows - 9, -400), (columns + 9, 9, 100), (300, 3)) * (30, 20, 1)
    mesh = Mesh(
        corners.astype(np.float32),
        np.tile(np.array([0, 0, 1], np.float32), (len(corners), 1)),
        random.integers(0, len(corners), (200, 3)).astype(np.int32),
        origin=np.array(case.origin),
    )
    found = vertical_error(mesh, case.ground, field=True, device=device).field
    assert found is not None
    return Check(largest_difference(found, error.error_field(mesh, case.ground)), METRES, "m")
