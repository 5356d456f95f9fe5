"""The mesh of one tile: made with a promise, given its borders, measured, and mended.

::

    lattice ─▶ Terrain.mesh ─▶ onto the tile's grid ─▶ weld to the borders ─▶ measure ─┬─▶ TileMesh
                                                                               ▲       │
                                                                               └ insert┘ samples

Everything is a function of the ground and the tile. What stands on a border is a function of the
heights along that border alone, so neighbours of one level agree there to the bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import numpy.typing as npt

from ..device.device import Device
from ..ground.heightmap import Heightmap
from ..terrain.lod_promises import MaxErrorLod
from ..terrain.terrain import Terrain
from .borders import tile_sides
from .ellipsoid import Floats, bulge
from .levels import CELLS, Level, reach
from .refine import insert
from .residuals import Surface, Triangles
from .schemes import Bounds, Scheme, Tile, bounds_of, lines
from .source import Samples, Source
from .weld import Outline, Places

# cells along the engine's tiles of a tile's lattice
_PATCH: Final = 4
# what of the error the lattice's mesh may use: between its points there are samples
_SHARE: Final = 0.8
# what arithmetic adds to a measured error, metres: some roundings at the Earth's size
_ROUNDING: Final = 1e-6


@dataclass(frozen=True, eq=False)
class TileMesh:
    """The triangles of a tile.

    Attributes
    ----------
    tile : (z, x, y)
    bounds : (west, south, east, north)
        Degrees.
    level : Level
    places : (V, 2) int64
        0..size eastwards and northwards.
    quanta : (V,) int64
        Heights above the ellipsoid, in quanta.
    triangles : (T, 3) int32
        Counter-clockwise from above.
    error : float
        Metres: no sample within the tile is farther from it, see `residuals`.
    samples : int
        So many were measured.
    """

    tile: Tile
    bounds: Bounds
    level: Level
    places: Places
    quanta: npt.NDArray[np.int64]
    triangles: Triangles
    error: float
    samples: int

    @cached_property
    def surface(self) -> Surface:
        return Surface.of(self.bounds, self.level.size, self.places, self.heights, self.triangles)

    @property
    def heights(self) -> Floats:
        """Metres above the ellipsoid; (V,)."""
        return np.asarray(self.quanta * self.level.quantum, np.float64)


def tile_mesh(
    source: Source, scheme: Scheme, tile: Tile, level: Level, device: Device | None = None
) -> TileMesh:
    """Return the mesh of a tile, within what the level allows wherever that can be had."""
    bounds = bounds_of(scheme, tile)
    longitudes, latitudes = lines(scheme, tile, CELLS)
    far = reach(source, scheme, tile[0])
    heights = source.heights(*np.meshgrid(longitudes, latitudes), far)
    heights = np.nan_to_num(heights, nan=level.bare)
    sides = tile_sides(source, scheme, tile, level)
    places, triangles = _meshed(heights, longitudes, latitudes, level, device)
    outline = Outline(places, triangles, level.size)
    for side in sides:
        outline.fit(side.axis, side.line, side.places.tolist())
    places, triangles = outline.result()
    used, triangles = _compact(triangles)
    places = places[used]
    quanta = np.rint(_between(heights, places / level.size * CELLS) / level.quantum)
    quanta = quanta.astype(np.int64)
    for side in sides:
        on_side = places[:, 1 - side.axis] == side.line
        along = np.searchsorted(side.places, places[on_side, side.axis])
        quanta[on_side] = side.quanta[along]
    if level.holed:
        bare = quanta * level.quantum < source.height_range[0] - level.allowed
        triangles = triangles[~bare[triangles].any(axis=1)]
        used, triangles = _compact(triangles)
        places, quanta = places[used], quanta[used]
    return _within(source, tile, bounds, level, places, quanta, triangles)


def _meshed(
    heights: Floats, longitudes: Floats, latitudes: Floats, level: Level, device: Device | None
) -> tuple[Places, Triangles]:
    """Mesh the lattice with the engine; the ellipsoid's curvature counts as height."""
    middle = float(longitudes[CELLS // 2]), float(latitudes[CELLS // 2])
    curved = heights - bulge(longitudes[None, :], latitudes[:, None], middle)
    ground = Heightmap(curved[::-1], origin=(0.0, float(CELLS)))
    terrain = Terrain(ground, tile=_PATCH, device=device)
    mesh = terrain.mesh(lod=MaxErrorLod(_SHARE * level.allowed), partitioning="integer")
    steps = (mesh.vertices[:, :2] + mesh.origin[:2]) * (level.size / CELLS)
    places = np.rint(steps).astype(np.int64)
    # patches have vertices of their own
    unique, same = np.unique(places[:, 0] * (level.size + 1) + places[:, 1], return_inverse=True)
    columns, rows = np.divmod(unique, level.size + 1)
    return np.stack([columns, rows], axis=1), same.astype(np.int32)[mesh.triangles]


def _compact(triangles: Triangles) -> tuple[npt.NDArray[np.int64], Triangles]:
    """Return the vertices that are used, and the triangles by the numbers of these."""
    used, numbers = np.unique(triangles, return_inverse=True)
    return used.astype(np.int64), numbers.reshape(-1, 3).astype(np.int32)


def _between(heights: Floats, steps: Floats) -> Floats:
    """Return lattice heights, bilinear at (column, row) with fractions; (V,)."""
    first = np.minimum(steps.astype(np.int64), CELLS - 1)
    across, up = (steps - first).T
    column, row = first.T
    south = heights[row, column] * (1 - across) + heights[row, column + 1] * across
    north = heights[row + 1, column] * (1 - across) + heights[row + 1, column + 1] * across
    return np.asarray(south * (1 - up) + north * up)


def _within(
    source: Source,
    tile: Tile,
    bounds: Bounds,
    level: Level,
    places: Places,
    quanta: npt.NDArray[np.int64],
    triangles: Triangles,
) -> TileMesh:
    """Measure a mesh, and put samples into the triangles that are too far from theirs."""

    def surface() -> Surface:
        heights = np.asarray(quanta * level.quantum, np.float64)
        return Surface.of(bounds, level.size, places, heights, triangles)

    worst, count, missed = 0.0, 0, []
    whole = surface()
    for samples in source.samples(bounds) if len(triangles) else ():
        owners = whole.owners(samples, source)
        over = owners >= 0
        samples, owners = samples.chosen(over), owners[over]
        residuals = whole.residuals(samples, owners)
        exceeding = np.zeros(len(triangles), bool)
        exceeding[owners[residuals > level.allowed]] = True
        bad = exceeding[owners]
        worst = max(worst, float(residuals[~bad].max(initial=0.0)))
        count += len(owners)
        if bad.any():
            missed.append((samples.chosen(bad), owners[bad]))
    if missed:
        left = Samples(*(np.concatenate(parts) for parts in zip(
            *(vars(samples).values() for samples, _ in missed), strict=True)))  # fmt: skip
        owners = np.concatenate([owners for _, owners in missed])
        points = _on_grid(left, bounds, level.size)
        tried = np.zeros(len(owners), bool)
        residuals = whole.residuals(left, owners)
        while (over := (residuals > level.allowed) & ~tried).any():
            chosen = _worst_of_each(owners, residuals, over)
            on_grid = np.rint(points[chosen]).astype(np.int64)
            cut = insert(places, triangles, owners[chosen], on_grid, level.size)
            triangles, parents = cut.triangles, cut.parents
            tried[chosen[cut.put]] = tried[chosen[cut.hopeless]] = True
            places = np.concatenate([places, on_grid[cut.put]])
            new = np.rint(left.height[chosen[cut.put]] / level.quantum).astype(np.int64)
            quanta = np.concatenate([quanta, new])
            owners = _given_to_parts(points, owners, places, triangles, parents)
            residuals = surface().residuals(left, owners)
        worst = max(worst, float(residuals.max()))
    error = worst + level.rounding + _ROUNDING if count else 0.0
    return TileMesh(tile, bounds, level, places, quanta, triangles, error, count)


def _on_grid(samples: Samples, bounds: Bounds, size: int) -> Floats:
    """Return where samples stand on the tile's grid, with fractions; (S, 2)."""
    west, south, east, north = bounds
    across = (samples.longitude - west) / (east - west)
    return size * np.stack([across, (samples.latitude - south) / (north - south)], axis=1)


def _worst_of_each(
    owners: npt.NDArray[np.int64], residuals: Floats, among: npt.NDArray[np.bool_]
) -> npt.NDArray[np.int64]:
    """Return the sample of each triangle that it misses most."""
    numbers = np.flatnonzero(among)
    order = numbers[np.lexsort([residuals[numbers], owners[numbers]])]
    last = np.append(owners[order][1:] != owners[order][:-1], True)
    return np.asarray(order[last])


def _given_to_parts(
    points: Floats,
    owners: npt.NDArray[np.int64],
    places: Places,
    triangles: Triangles,
    parents: npt.NDArray[np.int64],
) -> npt.NDArray[np.int64]:
    """Return which part of its former triangle each sample stands over."""
    first = len(triangles) - len(parents)
    order = np.argsort(parents, kind="stable")
    starts = np.searchsorted(parents[order], np.arange(first + 1))
    best = _depth(points, places, triangles[owners])
    result = owners.copy()
    for turn in range(2):  # a triangle has at most two new parts
        at = starts[owners] + turn
        there = np.flatnonzero(at < starts[owners + 1])
        part = first + order[at[there]]
        depth = _depth(points[there], places, triangles[part])
        better = depth > best[there]
        result[there[better]] = part[better]
        best[there[better]] = depth[better]
    return result


def _depth(points: Floats, places: Places, triangles: Triangles) -> Floats:
    """Return the least barycentric coordinate of points in triangles; negative outside."""
    a, b, c = (places[triangles[:, corner]].astype(np.float64) for corner in range(3))

    def area(p: Floats, q: Floats, r: Floats) -> Floats:
        u, v = q - p, r - p
        return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])

    parts = np.stack([area(points, b, c), area(points, c, a), area(points, a, b)])
    return np.asarray((parts / area(a, b, c)).min(axis=0))
