"""Weights of tiles in float64: what ``terrain/weights.cl`` computes."""

from __future__ import annotations

from itertools import product

import numpy as np
import numpy.typing as npt

from ...camera.camera import Camera
from ...ground.grid import TileGrid
from .analysis import TileFit
from .selection import bounding_box

Array = npt.NDArray[np.float64]


def weights(
    grid: TileGrid,
    fits: list[TileFit],
    camera: Camera,
    origin: tuple[float, float, float],
    columns: int,
    *,
    horizon: float,
    silhouette: float,
) -> Array:
    """Return the weight of every tile, (P,)."""
    reach = camera.half_extents[0] if camera.height else float(np.hypot(*camera.half_extents))
    seen = [
        _look_at(grid, fit, index, camera, origin, reach, columns) for index, fit in enumerate(fits)
    ]
    skyline = np.full(columns, -np.inf)
    for first, last, centre, _ in seen:
        skyline[first : last + 1] = np.maximum(skyline[first : last + 1], centre)
    found = np.ones(grid.count)
    for index, (fit, (first, last, centre, top)) in enumerate(zip(fits, seen, strict=True)):
        if np.isnan(fit.minimum):
            continue
        if first <= last:
            sky = (top - skyline[first : last + 1].min()) / max(top - centre, 1e-9)
            found[index] += (horizon - 1) * np.clip(sky, 0, 1)
        low, high = bounding_box(grid, fit, index)
        middle = np.append((low + high)[:2] / 2, fit.height) + origin
        way = camera.axes[2] if camera.height else middle - camera.eye
        along = abs(way @ fit.normal) / np.linalg.norm(way)
        found[index] *= 1 + (silhouette - 1) * (1 - min(along, 1.0))
    return found


def _look_at(
    grid: TileGrid,
    fit: TileFit,
    index: int,
    camera: Camera,
    origin: tuple[float, float, float],
    reach: float,
    columns: int,
) -> tuple[int, int, float, float]:
    """Return a tile's first and last column, and how far up its centre and its top are."""
    nothing = 0, -1, 0.0, 0.0
    if np.isnan(fit.minimum):
        return nothing
    low, high = bounding_box(grid, fit, index)
    corners = [(x, y, high[2]) for x, y in product((low[0], high[0]), (low[1], high[1]))]
    points = np.array([*corners, (*(low + high)[:2] / 2, fit.height)]) + origin - camera.eye
    right, upward, depth = camera.axes @ points.T
    if depth.min() <= camera.near:
        return nothing
    scale = np.ones(5) if camera.height else depth
    x, y = right / scale, upward / scale
    left, end = x[:4].min(), x[:4].max()
    if end < -reach or left > reach:
        return nothing
    first, last = (
        int(np.clip((np.clip(at, -reach, reach) + reach) * columns / (2 * reach), 0, columns - 1))
        for at in (left, end)
    )
    return first, last, float(y[4]), float(y[:4].max())
