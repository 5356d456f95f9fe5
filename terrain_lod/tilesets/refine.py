"""Points put into triangles, which give way to parts of themselves.

A triangle is cut in three around a point; where the point stands on a side, the triangle beyond is
cut in two as well, and so is this one. Borders of the tile are left alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from .residuals import Triangles
from .weld import Places

Numbers = npt.NDArray[np.int64]

# steps of the grid: no point is put so close to a side, but into the side
_NEAR: Final = 2


@dataclass(frozen=True, eq=False)
class Cut:
    """What became of T triangles, V vertices and P points.

    Attributes
    ----------
    triangles : (T', 3) int32
        The first T in their places, cut or not.
    parents : (T' - T,) int64
        The triangle that each new one was a part of: at most two of one.
    put : (P',) int64
        Points that are vertices V, V + 1, ... now, in this order.
    hopeless : (P'',) int64
        Points that stand on the border, or on a vertex; others may be put in later.
    """

    triangles: Triangles
    parents: Numbers
    put: Numbers
    hopeless: Numbers


def insert(places: Places, triangles: Triangles, owners: Numbers, points: Places, size: int) -> Cut:
    """Make points vertices, each of the triangle that owns it.

    Of points in triangles that share what is to be cut, the first ones are put in.

    Parameters
    ----------
    places : (V, 2) int64
    triangles : (T, 3) int32
    owners : (P,) int64
    points : (P, 2) int64
    size : int
        The square is 0..size along both axes.
    """
    corners = places[triangles[owners]]
    areas = _areas(corners, points)
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - np.roll(corners, 1, axis=1), axis=2)
    # a sample was rounded to the grid: so close to a side it stands on it, or leaves a sliver
    opposite = (areas / lengths).argmin(axis=1)
    row = np.arange(len(points))
    near = areas[row, opposite] <= _NEAR * lengths[row, opposite]
    others = np.full(len(points), -1)
    others[near] = _beyond(triangles, len(places), triangles[owners[near]], opposite[near])
    apex, first, second = (triangles[owners, (opposite + i) % 3] for i in range(3))
    far = np.where(others < 0, apex, triangles[others].sum(axis=1) - first - second)
    quarters = [(apex, first), (second, apex), (first, far), (far, second)]
    cuts = np.stack([_area(points, places[a], places[b]) for a, b in quarters])
    on_side = near & (others >= 0) & (cuts > 0).all(axis=0)
    on_border = ((points == 0) | (points == size)).any(axis=1)
    hopeless = on_border | ~(on_side | (areas > 0).all(axis=1))

    # who is first with the triangles that it cuts
    taken: set[int] = set()
    chosen = []
    for point in np.flatnonzero(~hopeless).tolist():
        cut = {int(owners[point])} | ({int(others[point])} if on_side[point] else set())
        if not cut & taken:
            taken |= cut
            chosen.append(point)
    put = np.array(chosen, np.int64)
    vertices = len(places) + np.arange(len(put))

    result = triangles.copy()
    inner, outer = ~on_side[put], on_side[put]
    owner, vertex = owners[put[inner]], vertices[inner]
    a, b, c = triangles[owner].T
    result[owner] = np.stack([a, b, vertex], axis=1)
    made = [np.stack([b, c, vertex], axis=1), np.stack([c, a, vertex], axis=1)]
    parents = [owner, owner]
    owner, other, vertex = owners[put[outer]], others[put[outer]], vertices[outer]
    apex, first, second, far = (ends[put[outer]] for ends in (apex, first, second, far))
    result[owner] = np.stack([apex, first, vertex], axis=1)
    result[other] = np.stack([far, vertex, first], axis=1)
    made += [np.stack([apex, vertex, second], axis=1), np.stack([far, second, vertex], axis=1)]
    parents += [owner, other]
    return Cut(
        np.concatenate([result, *made]).astype(np.int32),
        np.concatenate(parents),
        put,
        np.flatnonzero(hopeless),
    )


def _beyond(
    all_triangles: Triangles, vertices: int, triangles: Triangles, corners: Numbers
) -> Numbers:
    """Return the triangle beyond the side opposite to a corner of each, -1 where there is none."""
    row = np.arange(len(triangles))
    first, second = (triangles[row, (corners + i) % 3].astype(np.int64) for i in (1, 2))
    # few sides are asked for: those of all triangles that begin and end like one of them
    begins, ends = np.zeros((2, vertices), bool)
    begins[second] = ends[first] = True
    starts, stops = all_triangles.ravel(), np.roll(all_triangles, -1, axis=1).ravel()
    sides = np.flatnonzero(begins[starts] & ends[stops])
    keys = starts[sides].astype(np.int64) * vertices + stops[sides]
    order = np.argsort(keys)
    wanted = second * vertices + first
    at = np.searchsorted(keys, wanted, sorter=order)
    there = at < len(keys)
    found = order[at[there]]
    there[there] = keys[found] == wanted[there]
    result = np.full(len(triangles), -1)
    result[there] = sides[order[at[there]]] // 3
    return result


def _areas(corners: Places, points: Places) -> Numbers:
    """Return twice the area that each point has with the side opposite to each corner; (P, 3)."""
    sides = [(corners[:, (i + 1) % 3], corners[:, (i + 2) % 3]) for i in range(3)]
    return np.stack([_area(points, a, b) for a, b in sides], axis=1)


def _area(a: Places, b: Places, c: Places) -> Numbers:
    """Return twice the areas of triangles, positive where they run counter-clockwise."""
    u, v = b - a, c - a
    return np.asarray(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
