"""Factors that keep a promise, in float64: what ``terrain/selection.cl`` chooses and tightens."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...camera.camera import Camera
from ...device.layout import FIXED_ONE
from ...ground.grid import TileGrid
from ...ground.heightmap import Heightmap
from ..tessellation.tessellator import tessellate
from .analysis import TileFit
from .domain import displace, global_coordinates

Array = npt.NDArray[np.float64]


def metres_for_pixels(camera: Camera, low: Array, high: Array, pixels: float) -> float:
    """Return the vertical error that moves nothing in a world box by more than `pixels`.

    ``kernels/terrain/screen.h`` has the derivation.
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


def factors(
    ground: Heightmap,
    grid: TileGrid,
    fits: list[TileFit],
    allowed: Array,
    ladder: tuple[Array, Array, Array, Array],
    *,
    edge_share: float,
    order: npt.NDArray[np.int32],
) -> tuple[Array, Array]:
    """Return edge factors (P, 4), each by its own error, and the cheapest insides beside (P, 2).

    Parameters
    ----------
    ground : Heightmap
    grid : TileGrid
    fits : list of TileFit
    allowed : (P,)
        Error that each tile may have; NaN where it is culled.
    ladder : (P, L, L), (P, L, L), ((TR + 1) * TC, L), (TR * (TC + 1), L)
        As the ladder's reference returns them.
    edge_share : float
        How much of what tiles are allowed edges may use.
    order : (L * L,) int32
        Level pairs, cheapest first.
    """
    every, inner, across, down = ladder
    rows, columns = grid.shape
    across, down = across.reshape(rows + 1, columns, -1), down.reshape(rows, columns + 1, -1)
    holed = np.array([fit.nodata > 0 for fit in fits])
    edge, inside = np.zeros((grid.count, 4)), np.zeros((grid.count, 2))
    for index in np.flatnonzero(~np.isnan(allowed)):
        row, column = divmod(int(index), columns)
        cells_down = int(np.diff(grid.corner_rows)[row])
        cells_across = int(np.diff(grid.corner_columns)[column])
        for side, (other_row, other_column, errors, cells) in enumerate(
            (
                (row, column - 1, down[row, column], cells_down),
                (row - 1, column, across[row, column], cells_across),
                (row, column + 1, down[row, column + 1], cells_down),
                (row + 1, column, across[row + 1, column], cells_across),
            )
        ):
            outside = not (0 <= other_row < rows and 0 <= other_column < columns)
            other = index if outside else other_row * columns + other_column
            error = edge_share * np.fmin(allowed[index], allowed[other])
            enough = [2 * level + 1 for level in range(len(errors)) if errors[level] <= error]
            full = holed[index] or holed[other] or error == 0
            edge[index, side] = cells if full else min([*enough, cells])
        if edge[index].max() <= 1 and every[index, 0, 0] <= allowed[index]:
            inside[index] = 1
            continue
        full = cells_across // 2, cells_down // 2
        inside[index] = max(3, cells_across), max(3, cells_down)
        for v, u in (divmod(int(pair), grid.levels) for pair in order):
            # a level of 0 has three segments too
            possible = min(1, full[0]) <= u <= full[0] and min(1, full[1]) <= v <= full[1]
            if not possible or inner[index, v, u] > allowed[index]:
                continue
            cheaper = max(3, min(2 * u + 1, cells_across)), max(3, min(2 * v + 1, cells_down))
            if patch_error(ground, grid, int(index), edge[index], cheaper) <= allowed[index]:
                inside[index] = cheaper
                break
    return edge, inside


def patch_error(
    ground: Heightmap, grid: TileGrid, index: int, edge: Array, inside: tuple[int, int]
) -> float:
    """Return the largest distance of a tile's samples to its triangles, at factors like these."""
    pattern = tessellate("quad", [edge], [inside])
    patch = np.full(len(pattern.points), index)
    columns, rows = global_coordinates(grid, pattern.points, patch)
    positions, _ = displace(ground, grid, pattern.points, patch)
    (row, column), one = divmod(index, grid.shape[1]), FIXED_ONE
    top, bottom = grid.corner_rows[row : row + 2]
    left, right = grid.corner_columns[column : column + 2]
    window = slice(top, bottom + 1), slice(left, right + 1)
    placed = np.stack([columns / one - left, rows / one - top, positions[:, 2]], axis=1)
    heights = ground.heights[window].astype(np.float64)
    return tile_error(heights, ground.valid[window], placed[pattern.triangles])


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
