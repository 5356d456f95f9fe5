"""The error ladder: how far each tile is from the ground at every pair of factors."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from .buffers import DeviceAnalysis, DeviceGround, DeviceLadder
from .grid import TileGrid

_LANES: Final = 8  # tiles that a CPU measures side by side
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


def lattice_costs(levels: int) -> npt.NDArray[np.int32]:
    """Return the triangles of a tile whose edges match its inside; (L, L) [along v, along u].

    A factor of 1 beside a larger one becomes 3 inside, as Direct3D 11 has it.
    """
    factor = 2 * np.arange(levels) + 1
    along_v, along_u = np.meshgrid(factor, factor, indexing="ij")
    inner_u, inner_v = np.maximum(along_u, 3) - 2, np.maximum(along_v, 3) - 2
    # the middle, and strips of triangles between each edge and the middle's outline
    costs = 2 * inner_u * inner_v + 2 * (along_u + inner_u) + 2 * (along_v + inner_v)
    costs[0, 0] = 2
    return np.asarray(costs, np.int32)


def ladder_on_device(
    ground: DeviceGround, grid: TileGrid, analysis: DeviceAnalysis
) -> DeviceLadder:
    """Measure every tile and every edge at every level; one pass over the raster.

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold the ladder.
    """
    device = ground.device
    levels, (rows, columns) = grid.levels, grid.shape
    edges_across, edges_down = (rows + 1) * columns, rows * (columns + 1)
    sizes = [grid.count * levels**2 * 4, edges_across * levels * 4, edges_down * levels * 4]
    device.require(f"the error ladder of {grid.count} tiles", *sizes)
    ladder = DeviceLadder(
        device.empty((grid.count, levels, levels), np.float32),
        device.empty((edges_across, levels), np.float32),
        device.empty((edges_down, levels), np.float32),
        device.array(lattice_costs(levels)),
    )
    measure_tiles(ground, grid, analysis, ladder, np.arange(grid.count, dtype=np.int32))
    return ladder


def edges_of(grid: TileGrid, tiles: npt.NDArray[np.int32]) -> tuple[npt.NDArray[np.int32], ...]:
    """Return the edges of `tiles` that run across, and those that run down."""
    row, column = np.divmod(tiles, grid.shape[1])
    west = row * (grid.shape[1] + 1) + column
    across = np.unique([tiles, tiles + grid.shape[1]])
    return across.astype(np.int32), np.unique([west, west + 1]).astype(np.int32)


def measure_tiles(
    ground: DeviceGround,
    grid: TileGrid,
    analysis: DeviceAnalysis,
    ladder: DeviceLadder,
    tiles: npt.NDArray[np.int32],
) -> None:
    """Measure some tiles and their edges into what is known of all."""
    device, levels = ground.device, grid.levels
    lanes = 1 if device.is_gpu else _LANES
    defines = {"TILE": grid.tile, "LEVELS": levels, "LANES": lanes, **ground.defines}
    groups = tile_groups(grid, tiles, lanes)
    local = _GROUP if device.is_gpu else 1
    device.kernel("ladder.cl", "ladder", **defines)(
        # a GPU has an item for every factor along u
        (len(groups), levels if device.is_gpu else 1),
        (local, 1),
        grid=grid.record(),
        **ground.arguments,
        details=analysis.details,
        groups=device.array(groups),
        group_count=len(groups),
        errors=ladder.tiles,
    )
    edges = edges_of(grid, tiles)
    for vertical, errors in enumerate((ladder.across, ladder.down)):
        device.kernel("ladder.cl", "edge_ladder", **defines)(
            (len(edges[vertical]),),
            (local,),
            grid=grid.record(),
            vertical=vertical,
            count=len(edges[vertical]),
            edges=device.array(edges[vertical]),
            **ground.arguments,
            errors=errors,
        )
