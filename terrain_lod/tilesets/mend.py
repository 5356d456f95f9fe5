"""A tile's mesh measured, and samples put into the triangles that miss them by too much.

What is said of a mesh is what was measured of it when it was finished.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Final

import numpy as np
import numpy.typing as npt

from .ellipsoid import Floats
from .levels import Level
from .refine import Numbers, insert
from .residuals import Surface, Triangles
from .schemes import Bounds, Tile
from .source import Samples, Source
from .weld import Places

# a mesh that is mended is measured again, at most so often
_PASSES: Final = 8


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
    error: float = np.inf
    samples: int = 0

    @cached_property
    def surface(self) -> Surface:
        return Surface.of(self.bounds, self.level.size, self.places, self.heights, self.triangles)

    @property
    def heights(self) -> Floats:
        """Metres above the ellipsoid; (V,)."""
        return np.asarray(self.quanta * self.level.quantum, np.float64)


def mended(mesh: TileMesh, source: Source) -> TileMesh:
    """Return a mesh with its error, within what its level allows wherever that can be had.

    Samples come in parts. What is put in for one part changes what was measured of another, so
    that all of them are looked at again; the last time nothing is put in.
    """
    for turn in range(_PASSES):
        allowed = mesh.level.allowed if turn < _PASSES - 1 else np.inf
        worst, count, parts, vertices = 0.0, 0, 0, len(mesh.places)
        for samples in source.samples(mesh.bounds) if len(mesh.triangles) else ():
            mesh, residuals = _with_samples(mesh, samples, source, allowed)
            worst = max(worst, float(residuals.max(initial=0.0)))
            count, parts = count + len(residuals), parts + 1
        if parts <= 1 or len(mesh.places) == vertices:
            break
    return replace(mesh, error=mesh.level.stated(worst) if count else 0.0, samples=count)


def _with_samples(
    mesh: TileMesh, samples: Samples, source: Source, allowed: float
) -> tuple[TileMesh, Floats]:
    """Put the worst sample of each triangle into it, and so on until none is missed.

    Returns
    -------
    mesh : TileMesh
    residuals : (S,) float64
        How far each sample over the tile is from it.
    """
    owners = mesh.surface.owners(samples, source)
    # one on the tile's border may fall to the next tile, by rounding
    over = owners >= 0
    samples, owners, level = samples.chosen(over), owners[over], mesh.level
    seen = mesh.surface.seen(samples)
    residuals = mesh.surface.residuals(seen, owners)
    points = _on_grid(samples, mesh.bounds, level.size)
    tried = np.zeros(len(owners), bool)
    while (over := (residuals > allowed) & ~tried).any():
        chosen = _worst_of_each(owners, residuals, over)
        on_grid = np.rint(points[chosen]).astype(np.int64)
        cut = insert(mesh.places, mesh.triangles, owners[chosen], on_grid, level.size)
        tried[chosen[cut.put]] = tried[chosen[cut.hopeless]] = True
        new = np.rint(samples.height[chosen[cut.put]] / level.quantum).astype(np.int64)
        changed = np.zeros(len(mesh.triangles), bool)
        changed[cut.parents] = True
        mesh = replace(
            mesh,
            places=np.concatenate([mesh.places, on_grid[cut.put]]),
            quanta=np.concatenate([mesh.quanta, new]),
            triangles=cut.triangles,
        )
        moved = np.flatnonzero(changed[owners])
        owners[moved] = _part_of(points[moved], owners[moved], mesh, cut.parents)
        residuals[moved] = mesh.surface.residuals(seen.chosen(moved), owners[moved])
    return mesh, residuals


def _on_grid(samples: Samples, bounds: Bounds, size: int) -> Floats:
    """Return where samples stand on the tile's grid, with fractions; (S, 2)."""
    west, south, east, north = bounds
    across = (samples.longitude - west) / (east - west)
    return size * np.stack([across, (samples.latitude - south) / (north - south)], axis=1)


def _worst_of_each(owners: Numbers, residuals: Floats, among: npt.NDArray[np.bool_]) -> Numbers:
    """Return the sample of each triangle that it misses most."""
    numbers = np.flatnonzero(among)
    order = numbers[np.lexsort([residuals[numbers], owners[numbers]])]
    last = np.append(owners[order][1:] != owners[order][:-1], True)
    return np.asarray(order[last])


def _part_of(points: Floats, owners: Numbers, mesh: TileMesh, parents: Numbers) -> Numbers:
    """Return which part of its former triangle each sample stands over."""
    places, triangles = mesh.places, mesh.triangles
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
