"""Positions and normals of a pattern's points, in float64: what ``terrain/domain.cl`` computes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...device.layout import FIXED_ONE
from ...ground.grid import TileGrid
from ...ground.heightmap import Heightmap

Array = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]


def cell_offsets(cells: int, u: npt.NDArray[np.uint32]) -> Integers:
    """Return where points of an edge of so many cells lie, in 1/65536 of a cell.

    The points of as many segments, which the tessellator counts in rounded steps from both ends,
    lie on the samples; between them the ruler is linear.
    """
    step = (FIXED_ONE + cells // 2) // cells
    inner = (cells - 1) // 2
    from_end = np.minimum(u, FIXED_ONE - u.astype(np.int64))
    mark = np.minimum(from_end // step, inner)
    middle = FIXED_ONE - 2 * inner * step if cells % 2 else FIXED_ONE // 2 - inner * step
    # the last digit is a matter of rounding, and float32 is where it is rounded
    stretch = np.where(mark < inner, np.float32(FIXED_ONE / step), np.float32(FIXED_ONE / middle))
    fraction = ((from_end - mark * step).astype(np.float32) * stretch + np.float32(0.5)).astype(int)
    offset = mark * FIXED_ONE + fraction
    offsets: Integers = np.where(u > FIXED_ONE // 2, cells * FIXED_ONE - offset, offset)
    return offsets


def global_coordinates(
    grid: TileGrid, points: npt.NDArray[np.uint32], patch_of_point: Integers
) -> tuple[Integers, Integers]:
    """Return columns and rows in 1/65536 of a cell."""
    tile_row, tile_column = np.divmod(patch_of_point, grid.shape[1])

    def along(corners: Integers, tile: Integers, u: npt.NDArray[np.uint32]) -> Integers:
        cells = np.diff(corners)[tile]
        result = corners[tile] * FIXED_ONE
        for count in np.unique(cells):
            result[cells == count] += cell_offsets(int(count), u[cells == count])
        return result

    columns = along(grid.corner_columns, tile_column, points[:, 0])
    rows = along(grid.corner_rows, tile_row, points[:, 1])
    return columns, rows


def sample_gradients(ground: Heightmap) -> Array:
    """Return rise a unit to the east and to the north at every sample; (R, C, 2).

    A Sobel operator; beside the border and holes its differences are one-sided.
    """
    return np.stack(
        [
            _sobel(ground, axis=1) / ground.spacing[0],
            -_sobel(ground, axis=0) / ground.spacing[1],
        ],
        axis=-1,
    )


def _sobel(ground: Heightmap, axis: int) -> Array:
    """Return the rise a cell along `axis`, smoothed 1 2 1 across it."""
    heights = np.where(ground.valid, ground.heights.astype(np.float64), np.nan)
    padded = np.pad(heights, 1, constant_values=np.nan)
    if axis == 0:
        padded = padded.T
    behind, here, ahead = padded[1:-1, :-2], padded[1:-1, 1:-1], padded[1:-1, 2:]
    central = (ahead - behind) / 2
    one_sided = np.where(np.isnan(ahead), here - behind, ahead - here)
    difference = np.where(np.isnan(central), one_sided, central)
    around = np.pad(difference, ((1, 1), (0, 0)), constant_values=np.nan)
    rows = np.stack([around[:-2], around[1:-1], around[2:]])
    weights = np.array([1.0, 2.0, 1.0])[:, None, None] * ~np.isnan(rows)
    total = weights.sum(axis=0)
    rise = (weights * np.nan_to_num(rows)).sum(axis=0) / np.where(total > 0, total, 1)
    result: Array = rise.T if axis == 0 else rise
    return result


def _between(values: Array, columns: Integers, rows: Integers) -> Array:
    """Return `values` (R, C, ...) bilinear at global coordinates."""
    column, row = columns // FIXED_ONE, rows // FIXED_ONE
    extra = (1,) * (values.ndim - 2)
    x = ((columns % FIXED_ONE) / FIXED_ONE).reshape(-1, *extra)
    y = ((rows % FIXED_ONE) / FIXED_ONE).reshape(-1, *extra)
    right, below = column + (columns % FIXED_ONE > 0), row + (rows % FIXED_ONE > 0)
    upper = values[row, column] * (1 - x) + values[row, right] * x
    lower = values[below, column] * (1 - x) + values[below, right] * x
    result: Array = upper * (1 - y) + lower * y
    return result


def displace(
    ground: Heightmap,
    grid: TileGrid,
    points: npt.NDArray[np.uint32],
    patch_of_point: Integers,
) -> tuple[Array, Array]:
    """Return positions (N, 3), relative to the terrain's origin and base, and normals (N, 3)."""
    columns, rows = global_coordinates(grid, points, patch_of_point)
    heights = _between(ground.heights.astype(np.float64), columns, rows)
    x = columns / FIXED_ONE * ground.spacing[0]
    y = -rows / FIXED_ONE * ground.spacing[1]
    gradients = _between(sample_gradients(ground), columns, rows)
    normals = np.column_stack([-gradients, np.ones(len(gradients))])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return np.column_stack([x, y, heights]), normals
