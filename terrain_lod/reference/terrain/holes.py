"""Which triangles stay where samples lack data, in integers: what ``terrain/holes.cl`` computes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...device.layout import FIXED_ONE
from ...ground.grid import TileGrid
from ...ground.heightmap import Heightmap
from .domain import global_coordinates

Integers = npt.NDArray[np.int64]


def kept(
    ground: Heightmap,
    grid: TileGrid,
    points: npt.NDArray[np.uint32],
    triangles: npt.NDArray[np.int32],
    patch_of_triangle: Integers,
) -> npt.NDArray[np.bool_]:
    """Return True where no cell without data shares an area with the triangle; (M,).

    A tile whose samples all have data keeps all of its triangles, those without an area too.

    Parameters
    ----------
    ground : Heightmap
    grid : TileGrid
    points : (N, 2) uint32
        u, v in 16.16 fixed point.
    triangles : (M, 3) int32
    patch_of_triangle : (M,) int64
    """
    lacking = ~cells_with_data(ground)
    patches = np.repeat(patch_of_triangle, 3)
    columns, rows = global_coordinates(grid, points[triangles.ravel()], patches)
    corners = np.stack([columns, rows], axis=-1).reshape(-1, 3, 2)
    stays = _area(corners) != 0
    for index, triangle in enumerate(corners):
        west, north = triangle.min(axis=0) // FIXED_ONE
        east, south = -(-triangle.max(axis=0) // FIXED_ONE)
        for row, column in np.argwhere(lacking[north:south, west:east]):
            stays[index] &= not _overlap(triangle, int(west + column), int(north + row))
    result: npt.NDArray[np.bool_] = stays | _whole_tiles(ground, grid)[patch_of_triangle]
    return result


def with_used_points(
    points: npt.NDArray[np.uint32], triangles: npt.NDArray[np.int32]
) -> tuple[npt.NDArray[np.uint32], npt.NDArray[np.int32]]:
    """Return the points that triangles use, in their order, and the triangles among these."""
    used, corners = np.unique(triangles, return_inverse=True)
    return points[used], corners.reshape(-1, 3).astype(np.int32)


def cells_with_data(ground: Heightmap) -> npt.NDArray[np.bool_]:
    """Return True where all four samples of a cell have data; (R - 1, C - 1)."""
    valid = ground.valid
    cells: npt.NDArray[np.bool_] = valid[:-1, :-1] & valid[:-1, 1:] & valid[1:, :-1] & valid[1:, 1:]
    return cells


def _whole_tiles(ground: Heightmap, grid: TileGrid) -> npt.NDArray[np.bool_]:
    """Return True where all samples of a tile, borders included, have data; (P,)."""
    bottoms, rights = grid.corner_rows[1:] + 1, grid.corner_columns[1:] + 1
    return np.array(
        [
            ground.valid[top:bottom, left:right].all()
            for top, bottom in zip(grid.corner_rows[:-1], bottoms, strict=True)
            for left, right in zip(grid.corner_columns[:-1], rights, strict=True)
        ]
    )


def _area(corners: Integers) -> Integers:
    """Return twice the signed area of triangles (M, 3, 2)."""
    (ax, ay), (bx, by) = np.moveaxis(corners[:, 1:] - corners[:, :1], 0, -1)
    area: Integers = ax * by - ay * bx
    return area


def _overlap(triangle: Integers, column: int, row: int) -> bool:
    """Return whether a triangle (3, 2) shares an area with a cell whose box it meets.

    Two convex shapes do unless some side of one has the whole other on its outer side.
    """
    square = FIXED_ONE * np.array(
        [(column, row), (column + 1, row), (column + 1, row + 1), (column, row + 1)]
    )
    turn = np.sign(_area(triangle[None]))[0]
    for start, end in zip(triangle, np.roll(triangle, -1, axis=0), strict=True):
        along, towards = end - start, square - start
        if (turn * (along[0] * towards[:, 1] - along[1] * towards[:, 0]) <= 0).all():
            return False
    return True
