"""Factors that keep a promise, in float64: what ``kernels/selection.cl`` chooses and tightens."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..camera import Camera
from ..grid import TileGrid
from .analysis import TileFit

Array = npt.NDArray[np.float64]


def metres_for_pixels(camera: Camera, low: Array, high: Array, pixels: float) -> float:
    """Return the vertical error that moves nothing in a world box by more than `pixels`.

    ``kernels/screen.h`` has the derivation.
    """
    right, upward, forward = camera.axes
    across, along = np.hypot(right[2], upward[2]), abs(forward[2])
    if camera.height:
        return pixels / (camera.focal * max(float(across), 1e-6))
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
    corners = corners - camera.eye
    depth = max(float((corners @ forward).min()) * (1 - 1e-6), camera.near)
    widest = np.hypot(*camera.half_extents)
    lateral = np.hypot(np.abs(corners @ right).max(), np.abs(corners @ upward).max())
    moved = camera.focal * (across + min(lateral / depth, widest) * along)
    return float(pixels * depth / (moved + pixels * along))


def cheapest_levels(
    errors: Array, costs: npt.NDArray[np.int32], error: float, cells: tuple[int, int]
) -> tuple[int, int]:
    """Return the cheapest level pair (v, u) within `error`; full resolution is right anyway."""
    full = cells[0] // 2, cells[1] // 2
    best = full
    for v, u in np.ndindex(full[0] + 1, full[1] + 1):
        if errors[v, u] <= error and costs[v, u] < costs[best]:
            best = v, u
    return best


def tile_error(
    heights: Array,
    known: npt.NDArray[np.bool_],
    corners: Array,
) -> float:
    """Return the largest distance of triangles to the samples of one tile.

    Parameters
    ----------
    heights : (rows, columns)
    known : (rows, columns) bool
    corners : (T, 3, 3)
        x in cells east, y in cells south, z; of each triangle's corners.
    """
    rows, columns = np.nonzero(known)
    worst = 0.0
    for (x0, y0, z0), (x1, y1, z1), (x2, y2, z2) in corners:
        area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        if area == 0:
            continue
        weight1 = ((columns - x0) * (y2 - y0) - (x2 - x0) * (rows - y0)) / area
        weight2 = ((x1 - x0) * (rows - y0) - (columns - x0) * (y1 - y0)) / area
        inside = (weight1 >= 0) & (weight2 >= 0) & (weight1 + weight2 <= 1)
        surface = z0 + weight1 * (z1 - z0) + weight2 * (z2 - z0)
        worst = max(worst, float(np.abs(surface - heights[rows, columns])[inside].max(initial=0)))
    return worst


def bounding_box(grid: TileGrid, fit: TileFit, index: int) -> tuple[Array, Array]:
    """Return the box of a tile, relative to the terrain's origin."""
    row, column = divmod(index, grid.shape[1])
    dx, dy = grid.spacing
    west, east = grid.corner_columns[column : column + 2] * dx
    north, south = -grid.corner_rows[row : row + 2] * dy
    return np.array([west, south, fit.minimum]), np.array([east, north, fit.maximum])
