"""The error ladder: how far each tile is from the ground at every pair of factors."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from ..device.device import Device
from ..ground.grid import TileGrid
from .buffers import DeviceAnalysis, DeviceGround, DeviceLadder

_GROUP: Final = 64


def tile_groups(grid: TileGrid, tiles: npt.NDArray[np.int32], lanes: int) -> npt.NDArray[np.int32]:
    """Return `tiles` in groups of `lanes` of equal size; the last of a size repeats a tile.

    Returns
    -------
    (G, lanes) int32
    """
    down, across = np.diff(grid.corner_rows), np.diff(grid.corner_columns)
    size = (down[:, None] * (grid.tile + 1) + across).ravel()
    order = tiles[np.argsort(size[tiles], kind="stable")]
    groups = []
    for equal in np.split(order, np.flatnonzero(np.diff(size[order])) + 1):
        padded = np.pad(equal, (0, -len(equal) % lanes), mode="edge")
        groups.append(padded.reshape(-1, lanes))
    return np.concatenate(groups)


def cheapest_first(levels: int) -> npt.NDArray[np.int32]:
    """Return the level pairs, L v + u, in the order of the triangles of an inside; (L * L,).

    Beside edges of any factors, fu x fv segments make 2 (fu - 1) (fv - 1) - 2 triangles; of pairs
    with equally many, the most even is first.
    """
    v, u = np.divmod(np.arange(levels**2, dtype=np.int32), levels)
    # a level of 0 becomes 3 segments, as 1 does
    return np.lexsort([u + v, np.maximum(u, 1) * np.maximum(v, 1)]).astype(np.int32)


def empty_ladder(device: Device, grid: TileGrid) -> DeviceLadder:
    """Return room for a ladder.

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold it.
    """
    levels, (rows, columns) = grid.levels, grid.shape
    edges_across, edges_down = (rows + 1) * columns, rows * (columns + 1)
    tiles = grid.count * levels**2 * 4
    sizes = [tiles, tiles, edges_across * levels * 4, edges_down * levels * 4]
    device.require(f"the error ladder of {grid.count} tiles", *sizes)
    return DeviceLadder(
        device.empty((grid.count, levels, levels), np.float32),
        device.empty((grid.count, levels, levels), np.float32),
        device.empty((edges_across, levels), np.float32),
        device.empty((edges_down, levels), np.float32),
        device.array(cheapest_first(levels)),
    )


def ladder_on_device(ground: DeviceGround, analysis: DeviceAnalysis) -> DeviceLadder:
    """Measure every tile and every edge at every level; one pass over the raster.

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold the ladder.
    """
    ladder = empty_ladder(ground.device, ground.grid)
    measure_tiles(ground, analysis, ladder, np.arange(ground.grid.count, dtype=np.int32))
    return ladder


def edges_of(grid: TileGrid, tiles: npt.NDArray[np.int32]) -> tuple[npt.NDArray[np.int32], ...]:
    """Return the edges of `tiles` that run across, and those that run down."""
    rows, columns = grid.shape
    row, column = np.divmod(tiles, columns)
    across = np.zeros((rows + 1, columns), bool)
    down = np.zeros((rows, columns + 1), bool)
    across[row, column] = across[row + 1, column] = True
    down[row, column] = down[row, column + 1] = True
    return tuple(np.flatnonzero(edges).astype(np.int32) for edges in (across, down))


def measure_tiles(
    ground: DeviceGround,
    analysis: DeviceAnalysis,
    ladder: DeviceLadder,
    numbers: npt.NDArray[np.int32],
) -> None:
    """Measure some tiles, by their numbers, and their edges into what is known of all."""
    device, grid = ground.device, ground.grid
    levels = grid.levels
    lanes = device.lanes
    defines = {"TILE": grid.tile, "LEVELS": levels, "LANES": lanes, **ground.defines}
    groups = tile_groups(grid, numbers, lanes)
    local = _GROUP if device.is_gpu else 1
    device.kernel("terrain/ladder.cl", "ladder", **defines)(
        # a GPU has an item for every factor along u
        (len(groups), levels if device.is_gpu else 1),
        (local, 1),
        **ground.arguments,
        details=analysis.details,
        groups=device.array(groups),
        group_count=len(groups),
        errors=ladder.tiles,
        inner_errors=ladder.inner,
    )
    edges = edges_of(grid, numbers)
    for vertical, errors in enumerate((ladder.across, ladder.down)):
        device.kernel("terrain/ladder.cl", "edge_ladder", **defines)(
            (len(edges[vertical]),),
            (local,),
            vertical=vertical,
            count=len(edges[vertical]),
            edges=device.array(edges[vertical]),
            **ground.arguments,
            errors=errors,
        )
