"""How far triangles are from a lattice, in float64: what ``streaming/between.cl`` bounds."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

# parts of a cell that a triangle is looked at in, between the points of the lattice
_PARTS = 8


def triangle_error(
    heights: Array, known: npt.NDArray[np.bool_], corners: Array, *, is_full: bool
) -> float:
    """Return the largest difference of a triangle from a lattice.

    Parameters
    ----------
    heights : (R, C)
        Of the lattice.
    known : (R, C) bool
        Where it has data.
    corners : (3, 3)
        Columns, rows and heights.
    is_full : bool
        Look at the points of the lattice alone; else at its bilinear surface, closely.
    """
    parts = 1 if is_full else _PARTS
    (a, b, c), extent = corners, np.array(heights.shape)[::-1] - 1
    matrix = np.stack([b[:2] - a[:2], c[:2] - a[:2]], axis=1)
    if abs(np.linalg.det(matrix)) < 1e-12:
        return 0.0
    low = np.ceil(corners[:, :2].min(axis=0) * parts - 1e-9)
    high = np.floor(corners[:, :2].max(axis=0) * parts + 1e-9)
    low, high = np.clip(low, 0, extent * parts), np.clip(high, -1, extent * parts)
    x, y = (grid.ravel() / parts for grid in np.meshgrid(*map(_whole, low, high)))
    weights = np.linalg.solve(matrix, np.stack([x, y]) - a[:2, None])
    inside = (weights >= -1e-9).all(axis=0) & (weights.sum(axis=0) <= 1 + 1e-9)
    x, y, (one, other) = x[inside], y[inside], weights[:, inside]
    shown = a[2] + one * (b[2] - a[2]) + other * (c[2] - a[2])
    off = np.abs(shown - _at(heights, y, x))
    if is_full:
        off = off[known[y.astype(int), x.astype(int)]]
        return float(off.max(initial=0.0))
    sides = [_crossings(one, other) for one, other in ((a, b), (b, c), (c, a))]
    x, y, shown = np.concatenate([corners, *sides]).T
    return float(np.append(off, np.abs(shown - _at(heights, y, x))).max())


def _crossings(one: Array, other: Array) -> Array:
    """Return where a side crosses lines of the lattice; (N, 3)."""
    shares = [np.zeros(0)]
    for axis in (0, 1):
        low, high = sorted((one[axis], other[axis]))
        if low < high:
            lines = _whole(np.ceil(low), np.floor(high))
            shares.append((lines - one[axis]) / (other[axis] - one[axis]))
    crossings: Array = one + np.concatenate(shares)[:, None] * (other - one)
    return crossings


def _whole(low: float, high: float) -> npt.NDArray[np.int64]:
    return np.arange(int(low), int(high) + 1)


def _at(heights: Array, y: Array, x: Array) -> Array:
    """Return bilinear heights at points."""
    row, column = (
        np.minimum(place.astype(int), extent - 2)
        for place, extent in zip((y, x), heights.shape, strict=True)
    )
    north, south = (
        heights[line, column] + (heights[line, column + 1] - heights[line, column]) * (x - column)
        for line in (row, row + 1)
    )
    mixed: Array = north + (south - north) * (y - row)
    return mixed
