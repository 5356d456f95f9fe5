"""Polygons cut into triangles, concave ones and those around holes too.

A polygon of n corners becomes n - 2 triangles that have all of its corners, so that a neighbour's
edge meets an edge everywhere. Most are fans: seen along the polygon's normal, all triangles of some
corner turn the same way. The others are cut by clipping ears, and the area is compared.

Held: *FIST: Fast Industrial-Strength Triangulation of Polygons*, Algorithmica 30, 2001, which
mapbox's earcut simplifies. Newell's normal: Sutherland, Sproull, Schumacker: *A Characterization of
Ten Hidden-Surface Algorithms*, 1974.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Final

import mapbox_earcut
import numpy as np
import numpy.typing as npt

from .raw import Floats, Integers

_CHUNK: Final = 1 << 16  # polygons cut at a time
_FANS_TRIED: Final = 8
# areas are equal when they differ by less than this share
_SAME: Final = 1e-9

Doubles = npt.NDArray[np.float64]


def cut_polygons(points: Floats, corners: Integers, sizes: Integers) -> tuple[Integers, int]:
    """Cut polygons of three and more corners into triangles.

    Parameters
    ----------
    points : (V, 3) array of float
    corners : (K,) int64
    sizes : (F,) int64

    Returns
    -------
    triangles : (T, 3) int64
        Indices into `points`, in the order of the polygons, turned as they are.
    crossing : int
        How many polygons cross themselves, so that no cutting covers them: those are fans.
    """
    starts = np.cumsum(sizes) - sizes
    targets = np.cumsum(sizes - 2) - (sizes - 2)
    triangles = np.empty((int((sizes - 2).sum()), 3), np.int64)
    crossing = 0
    for size in np.unique(sizes):
        same = np.flatnonzero(sizes == size)
        for first in range(0, len(same), _CHUNK):
            chosen = same[first : first + _CHUNK]
            polygons = corners[starts[chosen, None] + np.arange(size)]
            local, crossed = _cut(points, polygons)
            rows = targets[chosen, None] + np.arange(size - 2)
            triangles[rows.ravel()] = np.take_along_axis(
                polygons, local.reshape(len(polygons), -1), axis=1
            ).reshape(-1, 3)
            crossing += crossed
    return triangles, crossing


def _cut(points: Floats, polygons: Integers) -> tuple[Integers, int]:
    """Return triangles (N, n - 2, 3) as places within polygons (N, n), and how many cross."""
    count, size = polygons.shape
    fan = np.stack([np.zeros(size - 2, int), np.arange(1, size - 1), np.arange(2, size)], axis=1)
    triangles = np.broadcast_to(fan, (count, size - 2, 3)).copy()
    if size == 3:
        return triangles, 0
    # relative to a corner, so that nothing is lost far from zero; scaled, so that nothing overflows
    positions = points[polygons].astype(np.float64)
    positions -= positions[:, :1]
    largest = abs(positions).max(axis=(1, 2), keepdims=True)
    positions /= np.where(largest > 0, largest, 1)
    normals = np.cross(positions[:, 1:-1], positions[:, 2:]).sum(axis=1)
    flat = np.linalg.norm(normals, axis=1) < _SAME
    undecided = ~flat
    for corner in range(min(size, _FANS_TRIED)):
        rest = np.flatnonzero(undecided)
        if not len(rest):
            break
        places = (fan + corner) % size
        a, b, c = (positions[rest][:, places[:, end]] for end in range(3))
        areas = np.einsum("ijk,ik->ij", np.cross(b - a, c - a), normals[rest])
        fits = (areas > 0).all(axis=1)
        triangles[rest[fits]] = places
        undecided[rest[fits]] = False
    crossing = 0
    for polygon in np.flatnonzero(undecided):
        ears = _clip(positions[polygon], normals[polygon])
        if ears is None:
            crossing += 1
        else:
            triangles[polygon] = ears
    return triangles, crossing


def _clip(positions: Doubles, normal: Doubles) -> Integers | None:
    """Return the triangles (n - 2, 3) of one polygon, (n, 3); None if it crosses itself."""
    # along the axis that the polygon faces most, so that what is in line stays in line
    axis = int(np.argmax(abs(normal)))
    plane = np.ascontiguousarray(np.delete(positions, axis, axis=1))
    whole = _twice_area(plane, np.arange(len(plane))[None])[0]
    ends = np.array([len(plane)], np.uint32)
    found = mapbox_earcut.triangulate_float64(plane, ends).astype(np.int64).reshape(-1, 3)
    areas = _twice_area(plane, found) * np.sign(whole)
    found[areas < 0] = found[areas < 0][:, ::-1]
    if abs(abs(areas).sum() - abs(whole)) > _SAME * abs(whole):
        return None
    return _with_all_corners([tuple(triangle) for triangle in found.tolist()], len(plane))


def _twice_area(plane: Doubles, polygons: Integers) -> Doubles:
    """Return twice the signed areas of polygons (N, n) of points (V, 2)."""
    x, y = np.moveaxis(plane[polygons], -1, 0)
    areas: Doubles = (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
    return areas


def _with_all_corners(triangles: list[tuple[int, ...]], count: int) -> Integers | None:
    """Return triangles that have all corners: earcut skips some that are in line with others.

    ::

              o               a triangle on the edge p-q, whose corners k were skipped,
            / | \\             becomes one for each piece of the edge
          p---k---q
    """
    used = sorted({corner for triangle in triangles for corner in triangle})
    for start, end in zip(used, [*used[1:], used[0] + count] if used else [], strict=True):
        chain = [place % count for place in range(start, end + 1)]
        if len(chain) == 2:
            continue
        edge = (chain[0], chain[-1])
        for index, (a, b, c) in enumerate(triangles):
            if edge in ((a, b), (b, c), (c, a)):
                (top,) = {a, b, c} - set(edge)
                pieces = pairwise(chain)
                triangles[index : index + 1] = [(p, q, top) for p, q in pieces]
                break
        else:
            return None
    return np.array(triangles, np.int64) if len(triangles) == count - 2 else None
