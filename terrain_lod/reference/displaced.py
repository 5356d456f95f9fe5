"""Displacement by a map and by decals in float64: ``kernels/displaced.cl`` and ``decals.cl``."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_EDGES = ((1, 2), (2, 0), (0, 1))


def bilinear(raster: npt.NDArray[Any], x: float, y: float, *, repeats: bool) -> float:
    """Return a map's value at x to the right and y up, both 0 to 1 across it."""
    rows, columns = raster.shape
    column, row = x * columns - 0.5, (1 - y) * rows - 0.5
    if not repeats:
        column, row = np.clip(column, 0, columns - 1), np.clip(row, 0, rows - 1)
    left, above = int(np.floor(column)), int(np.floor(row))
    value = 0.0
    for i, down in ((above, 1 - (row - above)), (above + 1, row - above)):
        for j, across in ((left, 1 - (column - left)), (left + 1, column - left)):
            place = (i % rows, j % columns) if repeats else (min(i, rows - 1), min(j, columns - 1))
            value += down * across * float(raster[place])
    return value


def displacement(
    patch: npt.NDArray[np.int32],
    dominant: npt.NDArray[np.int32],
    normals: Array,
    shared: Array,
    textures: Array,
    weights: Array,
) -> tuple[Array, Array]:
    """Return the unit direction and the texture coordinates at (3,) weights of one patch.

    Parameters
    ----------
    patch : (12,) int32
    dominant : (6,) int32
        Vertices that speak for the ends of edges 0, 1, 2.
    normals, shared : (V, 3)
        Of the vertices, and the means at their positions.
    textures : (V, 2)
    """
    on_edges = np.flatnonzero(weights == 0)
    if len(on_edges) == 2:  # a corner
        vertex = patch[9 + int(np.argmax(weights))]
        return _unit(shared[vertex]), textures[vertex]
    if len(on_edges) == 0:
        return _unit(weights @ normals[patch[:3]]), weights @ textures[patch[:3]]
    side = int(on_edges[0])
    direction, texture = np.zeros(3), np.zeros(2)
    for end, corner in enumerate(_EDGES[side]):
        place = 2 * side + end
        own, other = patch[corner], patch[3 + place]
        both = shared[own] if other < 0 else _unit(normals[own] + normals[other])
        direction += weights[corner] * both
        texture += weights[corner] * textures[dominant[place]]
    return _unit(direction), texture


def dented(position: Array, decals: npt.NDArray[np.void], depths: npt.NDArray[Any]) -> Array:
    """Return where all decals move a position to, each from where it was at first."""
    moved = position.copy()
    for decal in decals:
        normal, tangent = (decal[name].astype(np.float64) for name in ("normal", "tangent"))
        off = position - decal["point"]
        radius = float(decal["radius"])
        if np.linalg.norm(off) <= radius:
            x, y = off @ tangent, off @ np.cross(normal, tangent)
            depth = bilinear(depths, x / radius / 2 + 0.5, y / radius / 2 + 0.5, repeats=False)
            moved -= normal * (float(decal["bias"]) + float(decal["scale"]) * depth)
    return moved


def _unit(vector: Array) -> Array:
    return np.asarray(vector / (np.linalg.norm(vector) or 1.0))
