"""Joined pieces put into one mesh, patch by patch."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..device import layout
from ..errors import InputError
from ..ground.grid import TileGrid
from ..mesh.mesh import Achieved, Mesh, Patches
from ..pyramid.division import NODE
from ..pyramid.store import Store
from .cut import Place
from .keeping import Joined
from .piece import Array, Piece
from .view import Asked


def whole(store: Store, asked: Asked, joined: Joined) -> Mesh:
    """Return joined pieces as one mesh, with what is known of its error."""
    own = store.description
    (dx, dy), (x, y) = own.spacing, own.origin
    first = np.zeros(2)
    if asked.camera is not None:
        # floats are finest near zero: there the eye is
        eye = (np.array(asked.camera.eye[:2]) - [x, y]) / [dx, -dy]
        first = np.clip(np.round(eye), 0, [own.columns - 1, own.rows - 1])
    gathered = Gathered()
    for piece, mesh, place in zip(joined.pieces, joined.meshes, joined.cut.places, strict=True):
        gathered.add(piece, mesh, place, store.division.chunk)
    places, heights, normals, triangles = gathered.arrays()
    vertices = np.empty((len(places), 3), np.float32)
    vertices[:, :2] = (places - first) * [dx, -dy]
    vertices[:, 2] = heights
    column, row = first
    used = joined.used
    return Mesh(
        vertices,
        normals,
        triangles,
        origin=np.array([x + column * dx, y - row * dy, own.base]),
        crs=own.crs,
        patches=gathered.patches(_grid_of(own.rows, own.columns, own.spacing)),
        achieved=Achieved(
            joined.metres,
            None if np.isinf(asked.pixels) else asked.pixels * used,
            used <= 1.0,
            joined.rounds,
        ),
    )


class Gathered:
    """Pieces one after the other, what came into them in the order of their patches."""

    def __init__(self) -> None:
        self._parts: list[tuple[npt.NDArray[np.generic], ...]] = []
        self._patches: list[tuple[npt.NDArray[np.generic], ...]] = []
        self._vertices = 0

    def add(self, piece: Piece, mesh: Mesh, place: Place, chunk: int) -> None:
        assert mesh.patches is not None
        level, row, column = place
        used = np.zeros(len(piece.heights), bool)
        used[piece.triangles] = True
        kept = np.flatnonzero(used)
        kept = kept[np.argsort(piece.patch_of_vertex[kept], kind="stable")]
        number = np.empty(len(used), np.int32)
        number[kept] = np.arange(len(kept)) + self._vertices
        order = np.argsort(piece.patch_of_triangle, kind="stable")
        self._vertices += len(kept)
        self._parts.append(
            (piece.places[kept], piece.heights[kept], piece.normals[kept],
             number[piece.triangles[order]])
        )  # fmt: skip
        patches = mesh.patches
        first = np.array([row, column, 0, 0]) * chunk + patches.areas
        counts = [
            np.bincount(part, minlength=patches.count)
            for part in (piece.patch_of_vertex[kept], piece.patch_of_triangle)
        ]
        self._patches.append(
            (first << level, patches.edge_factors, patches.inside_factors, *counts,
             patches.deviation)
        )  # fmt: skip

    def arrays(self) -> tuple[Array, Array, npt.NDArray[np.float32], npt.NDArray[np.int32]]:
        empty = np.zeros((0, 2)), np.zeros(0), np.zeros((0, 3), "f4"), np.zeros((0, 3), "i4")
        places, heights, normals, triangles = (
            np.concatenate(parts) for parts in zip(empty, *self._parts, strict=True)
        )
        return places, heights, normals, triangles

    def patches(self, grid: TileGrid) -> Patches:
        empty = (
            np.zeros((0, 4), "i4"), np.zeros((0, 4), "f4"), np.zeros((0, 2), "f4"),
            np.zeros(0, "i8"), np.zeros(0, "i8"), np.zeros(0, "f4"),
        )  # fmt: skip
        areas, edges, insides, points, triangles, deviation = (
            np.concatenate(parts) for parts in zip(empty, *self._patches, strict=True)
        )
        # a level may reach beyond the raster
        areas[:, 2] = np.minimum(areas[:, 2], grid.rows - 1 - areas[:, 0])
        areas[:, 3] = np.minimum(areas[:, 3], grid.columns - 1 - areas[:, 1])
        offsets = [
            np.append(0, np.cumsum(counts)).astype(np.int64) for counts in (points, triangles)
        ]
        return Patches(
            grid, areas.astype(np.int32), edges, insides, offsets[0], offsets[1], deviation
        )


def _grid_of(rows: int, columns: int, spacing: tuple[float, float]) -> TileGrid:
    """Return tiles of a raster of any size, as small as can be numbered."""
    try:
        return TileGrid(rows, columns, NODE, spacing)
    except InputError:
        return TileGrid(rows, columns, layout.MAX_TILE, spacing)
