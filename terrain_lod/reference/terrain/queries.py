"""Heights and rays against bilinear ground in float64: ``terrain/queries.cl``.

Rays are tried against every cell, whereas the kernel walks.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...ground.heightmap import Heightmap

Array = npt.NDArray[np.float64]

# cells by which a root may lie outside its cell: the cells beside it find it as well
_SLACK = 1e-9


def _put_back(cells: Array) -> Array:
    """Return coordinates with what rounding moved off a sample put back on it."""
    return np.where(np.abs(cells - np.rint(cells)) <= 1e-7, np.rint(cells), cells)


def heights(ground: Heightmap, points: Array) -> Array:
    """Return elevations at world points (N, 2); NaN outside and where a sample is missing."""
    (x0, y0), (dx, dy) = ground.origin, ground.spacing
    x, y = (points[:, 0] - x0) / dx, (y0 - points[:, 1]) / dy
    x, y = _put_back(x), _put_back(y)
    rows, columns = ground.shape
    inside = (x >= 0) & (x <= columns - 1) & (y >= 0) & (y <= rows - 1)
    x, y = np.where(inside, x, 0), np.where(inside, y, 0)
    column, row = x.astype(int), y.astype(int)
    total = np.zeros(len(points))
    for down in (0, 1):
        for across in (0, 1):
            weight = (1 - np.abs(x - column - across)) * (1 - np.abs(y - row - down))
            # a sample without weight need not be there
            r, c = np.minimum(row + down, rows - 1), np.minimum(column + across, columns - 1)
            total += np.where(weight > 0, weight * ground.elevation[r, c], 0)
    return np.where(inside, total, np.nan)


def distances(ground: Heightmap, origins: Array, directions: Array) -> Array:
    """Return how far along unit `directions` each ray first meets a cell; NaN where none."""
    z = np.where(ground.valid, ground.heights.astype(np.float64), np.nan)
    corner, east, south = z[:-1, :-1], np.diff(z, axis=1)[:-1], np.diff(z, axis=0)[:, :-1]
    twist = z[1:, 1:] - z[1:, :-1] - east
    row, column = np.indices(corner.shape)
    scale = np.array([ground.spacing[0], -ground.spacing[1], 1.0])
    at = (origins - (*ground.origin, ground.base)) / scale
    at[:, :2] = _put_back(at[:, :2])
    along = directions / scale
    found = np.full(len(origins), np.nan)
    for i, ((x, y, height), (u, v, rise)) in enumerate(zip(at, along, strict=True)):
        a, b = x - column, y - row
        # height of the ray above the cell's surface, extended: p + q t + r t^2
        p = height - (corner + east * a + south * b + twist * a * b)
        q = rise - (east * u + south * v + twist * (a * v + b * u))
        candidates = _roots(p, q, -twist * u * v)
        for t in candidates:
            inside = (t >= 0) & (np.abs(a + u * t - 0.5) <= 0.5 + _SLACK)
            inside &= np.abs(b + v * t - 0.5) <= 0.5 + _SLACK
            found[i] = np.fmin(found[i], np.nanmin(np.where(inside, t, np.inf)))
    return np.where(np.isinf(found), np.nan, found)


def _roots(p: Array, q: Array, r: Array) -> tuple[Array, Array]:
    """Return both roots of p + q t + r t^2, NaN where there are none."""
    with np.errstate(invalid="ignore", divide="ignore"):
        sum_ = -(q + np.copysign(np.sqrt(q * q - 4 * p * r), q)) / 2
        roots = p / sum_, sum_ / r
    return np.where(sum_ == 0, np.nan, roots[0]), np.where(r == 0, np.nan, roots[1])
