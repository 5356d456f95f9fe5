"""Each kernel against its reference in 64 bits, on one ground or for one camera.

A bound is stated for each quantity, in the terms that rounding allows: a share of the value, or
units in the last place (ulp, of float32) of the numbers that it is computed from.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ...camera.camera import Camera
from ...device.device import Device
from ...device.layout import DEFAULT_TILE
from ...ground.grid import TileGrid
from ...ground.heightmap import Heightmap
from ...ground.relief import Relief
from ...measure.error import vertical_error
from ...reference.measure import error
from ...reference.terrain import (
    analysis,
    domain,
    hull,
    ladder,
    selection,
)
from ...terrain.buffers import DeviceGround
from ...terrain.domain import displace_on_device
from ...terrain.hull import hull_on_device
from ...terrain.lod_formulas import CoplanarityLod
from ...terrain.lod_promises import MaxErrorLod
from ...terrain.promise import Promise
from ...terrain.selection import Selection
from ...terrain.terrain import Terrain
from ...terrain.tiles import DeviceTiles
from ...tessellation.pattern import DevicePattern

Array = npt.NDArray[Any]

_LARGEST: Final = float(np.finfo(np.float32).max)

# quantities, what each is measured in, and the bound that each keeps
BOUNDS: Final = {
    "deviation": "1e-5 of it, or 4 ulp of the tile's height range",
    "plane height": "2e-6 of the tile's farthest height from 0, or 4 ulp of its height range",
    "plane normal": "1e-5",
    "factors": "1e-4 segments",
    "allowed error": "1e-5 of it, and 2e-6 of the tile's height range",
    "ladder of tiles": "16 ulp of the tile's height range",
    "ladder of edges": "16 ulp of the height range",
    "position": "4 ulp of the largest coordinate",
    "normal": "1e-5",
    "tile error": "16 ulp of the height range below, 1e-4 of it above",
    "vertical error": "1/2 ulp of it",
    "shift by 1,000 km": "no bit of the mesh",
}


@dataclass(frozen=True)
class Finding:
    """How far one quantity is from its reference, where it is nearest to its bound.

    Attributes
    ----------
    case, quantity : str
    error : float
        Infinite where only one of the two is a number.
    ulp, relative : float
        The same in units in the last place of, and as a share of, what the bound speaks of.
    share : float
        Of the bound; met up to 1.
    """

    case: str
    quantity: str
    error: float
    ulp: float
    relative: float
    share: float

    @property
    def is_met(self) -> bool:
        return self.share <= 1.0


def ulp(values: Any) -> Array:
    """Return the distance from float32 `values` to the next; in float64."""
    size = np.minimum(np.abs(np.asarray(values, np.float64)), _LARGEST)
    return np.spacing(size.astype(np.float32)).astype(np.float64)


def finding(
    case: str, quantity: str, found: Array, expected: Array, scale: Any, allowed: Any
) -> Finding:
    """Return how far `found` is from `expected` where that is most of what is `allowed`."""
    found = np.asarray(found, np.float64).reshape(np.shape(expected))
    with np.errstate(invalid="ignore"):  # infinity from infinity
        error = np.where(found == expected, 0.0, np.abs(found - expected))
    # no number where none is expected is right; anywhere else it is not
    error = np.where(np.isnan(found) & np.isnan(expected), 0.0, error)
    error = np.where(np.isnan(error), np.inf, error).ravel()
    scale = np.broadcast_to(np.abs(scale), np.shape(expected)).ravel()
    allowed = np.broadcast_to(allowed, np.shape(expected)).ravel()
    if not len(error):
        return Finding(case, quantity, 0.0, 0.0, 0.0, 0.0)
    share = np.divide(error, allowed, out=np.where(error > 0, np.inf, 0.0), where=allowed > 0)
    worst = int(np.argmax(share))
    off, size = float(error[worst]), float(scale[worst])
    size = size if np.isfinite(size) else 0.0
    relative = off / size if size else (0.0 if off == 0 else np.inf)
    return Finding(case, quantity, off, off / float(ulp(size)), relative, float(share[worst]))


class OnGround:
    """One ground, what the references find of it, and it on the device."""

    def __init__(self, name: str, ground: Heightmap, device: Device) -> None:
        self.name, self.ground, self.device = name, ground, device
        self.grid = TileGrid.of(ground, DEFAULT_TILE)
        self.fits = analysis.analyse(ground)
        uploaded = DeviceGround.upload(Relief(ground), DEFAULT_TILE, device)
        self.tiles = DeviceTiles.of(uploaded).with_ladder()
        self.ranges = np.array([fit.maximum - fit.minimum for fit in self.fits])
        known = np.abs(ground.heights[ground.valid]).astype(np.float64)
        self.highest = float(known.max())
        self.range = float(np.ptp(ground.heights[ground.valid].astype(np.float64)))

    def findings(self) -> Iterator[Finding]:
        """Yield every quantity."""
        yield from self._analysis()
        yield from self._ladder()
        yield from self._domain_and_tile_error()
        yield self._vertical_error()
        yield self._shift()

    def _find(
        self, quantity: str, found: Array, expected: Array, scale: Any, allowed: Any
    ) -> Finding:
        return finding(self.name, quantity, found, expected, scale, allowed)

    def _analysis(self) -> Iterator[Finding]:
        planes = self.tiles.analysis.planes.host().reshape(-1, 4)
        details = self.tiles.analysis.details.host().reshape(-1, 4)
        four_ulp = 4 * ulp(np.nan_to_num(self.ranges))
        expected = np.array([fit.deviation for fit in self.fits])
        allowed = np.maximum(four_ulp, 1e-5 * np.nan_to_num(expected))
        yield self._find("deviation", details[:, 0], expected, self.ranges, allowed)
        expected = np.array([fit.height for fit in self.fits])
        farthest = np.array([max(abs(fit.minimum), abs(fit.maximum)) for fit in self.fits])
        allowed = np.maximum(four_ulp, 2e-6 * np.nan_to_num(farthest))
        yield self._find("plane height", planes[:, 3], expected, self.ranges, allowed)
        normals = np.array([fit.normal for fit in self.fits])
        yield self._find("plane normal", planes[:, :3], normals, 1.0, 1e-5)

    def _ladder(self) -> Iterator[Finding]:
        found = self.tiles.ladder
        assert found is not None
        tiles, inner, across, down = ladder.ladder(self.ground, self.grid, self.fits)
        ranges = np.nan_to_num(self.ranges)[:, None, None]
        every = np.stack([found.tiles.host(), found.inner.host()])
        expected = np.stack([tiles, inner])
        yield self._find("ladder of tiles", every, expected, ranges, 16 * ulp(ranges))
        expected = np.concatenate([across, down])
        edges = np.concatenate([found.across.host(), found.down.host()])
        yield self._find("ladder of edges", edges, expected, self.range, 16 * ulp(self.range))

    def _domain_and_tile_error(self) -> Iterator[Finding]:
        """Mesh with transition strips, displace it and measure it."""
        # half the height range lets most of a mesh be coarse
        promise = Promise(self.tiles, None, "fractional_odd", "edge", cull=False)
        kept = promise.keep(MaxErrorLod(max(self.range / 4, 1e-30)))
        pattern = kept.made.pattern
        points = pattern.points.host()
        patch = np.repeat(np.arange(self.grid.count), np.diff(pattern.point_offsets.host()))
        positions, normals = domain.displace(self.ground, self.grid, points, patch)
        found = displace_on_device(self.tiles.patch_set, pattern)
        used = np.unique(pattern.primitives.host())
        largest = np.array([*self.ground.extent, max(self.highest, 1e-45)])
        yield self._find(
            "position", found.positions.host()[used], positions[used], largest, 4 * ulp(largest)
        )
        yield self._find("normal", found.normals.host()[used], normals[used], 1.0, 1e-5)
        yield self._tile_error(pattern, positions, patch)

    def _tile_error(self, pattern: DevicePattern, positions: Array, patch: Array) -> Finding:
        state = Selection.start(self.tiles, None, metres=1.0, pixels=np.inf)
        state.changed.fill(1)
        state.measure(pattern)
        columns, rows = domain.global_coordinates(self.grid, pattern.points.host(), patch)
        placed = np.stack([columns / 65536, rows / 65536, positions[:, 2]], axis=1)
        triangles = pattern.primitives.host()
        offsets = pattern.primitive_offsets.host()
        expected = np.zeros(self.grid.count)
        for index, (row, column) in enumerate(np.ndindex(self.grid.shape)):
            top, bottom = self.grid.corner_rows[row : row + 2]
            left, right = self.grid.corner_columns[column : column + 2]
            window = slice(top, bottom + 1), slice(left, right + 1)
            own = placed[triangles[offsets[index] : offsets[index + 1]]] - (left, top, 0)
            expected[index] = selection.tile_error(
                self.ground.heights[window].astype(np.float64), self.ground.valid[window], own
            )
        found = state.measured.host().astype(np.float64)
        # too much is safe, too little is not
        allowed = np.where(found > expected, 1e-4 * self.range, 16 * ulp(self.range))
        return self._find("tile error", found, expected, self.range, allowed)

    def _vertical_error(self) -> Finding:
        terrain = Terrain(self.ground, device=self.device)
        mesh = terrain.mesh(lod=MaxErrorLod(max(self.range / 4, 1e-30)))
        found = vertical_error(mesh, self.ground, field=True, device=self.device).field
        expected = error.error_field(mesh, self.ground)
        # and what 64 bits lose of the heights
        allowed = 0.5 * ulp(np.nan_to_num(expected)) + 1e-14 * self.highest
        assert found is not None  # asked for
        return self._find("vertical error", found, expected, np.nan_to_num(expected), allowed)

    def _shift(self) -> Finding:
        """Return bits of the mesh that change where the ground is moved by 1,000 km."""
        ground = self.ground
        moved = Heightmap(
            np.where(ground.valid, ground.heights, np.nan),
            spacing=ground.spacing,
            origin=(ground.origin[0] + 1e6, ground.origin[1] - 1e6),
            base=ground.base,
        )
        lod = MaxErrorLod(max(self.range / 100, 1e-30))
        here, there = (Terrain(each, device=self.device).mesh(lod=lod) for each in (ground, moved))
        same = all(
            np.array_equal(getattr(here, name), getattr(there, name))
            for name in ("vertices", "normals", "triangles")
        )
        return self._find(
            "shift by 1,000 km", np.array([0.0 if same else 1.0]), np.zeros(1), 1.0, 0.0
        )


def camera_findings(
    name: str, ground: Heightmap, camera: Camera, device: Device
) -> Iterator[Finding]:
    """Yield how far the factors, and the errors that tiles are allowed, are from the references."""
    case = OnGround(name, ground, device)
    grid, origin = case.grid, (*ground.origin, ground.base)
    lod = CoplanarityLod()
    found = hull_on_device(case.tiles, lod, camera, cull=False)
    eye = np.subtract(camera.eye, origin)
    edge, inside = hull.factors(ground, grid, case.fits, lod, case.tiles.scene, eye, None)
    factors = np.concatenate([found.edge.host(), found.inside.host()], axis=1)
    expected = np.concatenate([edge, inside], axis=1)
    yield finding(name, "factors", factors, expected, expected, 1e-4)

    state = Selection.start(case.tiles, camera, metres=np.inf, pixels=1.0, cull=False)
    boxes = [selection.bounding_box(grid, fit, index) for index, fit in enumerate(case.fits)]
    metres = np.array(
        [
            selection.metres_for_pixels(camera, low + origin, high + origin, 1.0)
            for low, high in boxes
        ]
    )
    allowed = 1e-5 * metres + 2e-6 * case.ranges
    scale = np.maximum(metres, case.ranges)
    yield finding(name, "allowed error", state.allowed.host(), metres, scale, allowed)
