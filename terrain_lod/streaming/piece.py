"""The triangles of one chunk on their way into a mesh, in places of the whole raster."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Final

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Numbers = npt.NDArray[np.int32]

# a side's line, and its axis: 0 across (a vertical line), 1 down (a horizontal one)
WEST, NORTH, EAST, SOUTH = range(4)
AXES: Final = (0, 1, 0, 1)


@dataclass(frozen=True, eq=False)
class Piece:
    """V vertices and T triangles of a chunk's P patches.

    Attributes
    ----------
    level : int
    sides : (float, float, float, float)
        Where the chunk ends in the west, north, east and south, in samples of the raster.
    lines : four of (N,) float32
        Heights of the lattice along these sides, every 2^level samples.
    places : (V, 2) float64
        Column and row of each vertex, in samples of the raster.
    heights : (V,) float64
        Relative to the store's base.
    normals : (V, 3) float32
    triangles : (T, 3) int32
        Counter-clockwise seen from above.
    patch_of_vertex, patch_of_triangle : (V,), (T,) int32
    errors : (P,) float64
        Bounds of the distance from all samples.
    moved : (P,) bool
        Whether triangles of a patch have other points since these were found.
    allowed : (P,) float64
    """

    level: int
    sides: tuple[float, float, float, float]
    lines: tuple[npt.NDArray[np.float32], ...]
    places: Array
    heights: Array
    normals: npt.NDArray[np.float32]
    triangles: Numbers
    patch_of_vertex: Numbers
    patch_of_triangle: Numbers
    errors: Array
    moved: npt.NDArray[np.bool_]
    allowed: Array

    @property
    def near(self) -> float:
        """Samples within which two places are the same one."""
        return 0.01 * (1 << self.level)

    def on(self, side: int) -> npt.NDArray[np.bool_]:
        """Return which vertices are on a side; (V,)."""
        return np.abs(self.places[:, AXES[side]] - self.sides[side]) < self.near

    def heights_along(self, side: int, along: Array) -> Array:
        """Return the heights of the lattice at places along a side."""
        line = self.lines[side]
        first = self.sides[1 - AXES[side]]
        found: Array = np.interp(along, first + np.arange(len(line)) * (1 << self.level), line)
        return found

    def with_moved(self, patches: Numbers) -> Piece:
        """Return the piece with some patches' points moved."""
        moved = self.moved.copy()
        moved[patches] = True
        return replace(self, moved=moved)


def clipped(piece: Piece, axis: int, end: float) -> Piece:
    """Return what of a piece is not beyond `end` along an axis: levels may reach beyond the raster.

    New vertices on the line depend on the ends of the cut edges alone, so patches go on agreeing.
    """
    beyond = piece.places[:, axis] - end
    beyond[np.abs(beyond) < 1e-6 * (1 << piece.level)] = 0.0
    piece.places[beyond == 0, axis] = end
    if (beyond <= 0).all():
        return piece
    corners = beyond[piece.triangles]
    whole = (corners <= 0).all(axis=1)
    cut = np.flatnonzero(~whole & (corners < 0).any(axis=1))
    triangles, patches = [piece.triangles[whole]], [piece.patch_of_triangle[whole]]
    made: dict[tuple[int, int], int] = {}
    ends: list[tuple[int, int]] = []

    def crossing(a: int, b: int) -> int:
        key = (min(a, b), max(a, b))
        if key not in made:
            made[key] = len(piece.heights) + len(ends)
            ends.append(key)
        return made[key]

    for number in cut:
        polygon: list[int] = []
        own = piece.triangles[number].tolist()
        for a, b in zip(own, own[1:] + own[:1], strict=True):
            if beyond[a] <= 0:
                polygon.append(a)
            if beyond[a] * beyond[b] < 0:
                polygon.append(crossing(a, b))
        fan = [(polygon[0], b, c) for b, c in pairwise(polygon[1:])]
        triangles.append(np.array(fan, np.int32).reshape(-1, 3))
        patches.append(np.full(len(fan), piece.patch_of_triangle[number], np.int32))
    a, b = np.array(ends, np.int32).reshape(-1, 2).T
    # from the end that comes first as seen from anywhere, whatever its number
    turned = (piece.places[a] > piece.places[b])[:, axis]
    a, b = np.where(turned, b, a), np.where(turned, a, b)
    share = (beyond[a] / (beyond[a] - beyond[b]))[:, None]
    places = piece.places[a] + (piece.places[b] - piece.places[a]) * share
    places[:, axis] = end
    heights = piece.heights[a] + (piece.heights[b] - piece.heights[a]) * share[:, 0]
    sides = list(piece.sides)
    sides[EAST if axis == 0 else SOUTH] = end
    return grown(
        replace(piece, sides=(sides[0], sides[1], sides[2], sides[3])),
        np.concatenate(triangles),
        np.concatenate(patches),
        places,
        heights,
        unit(piece.normals[a] * (1 - share) + piece.normals[b] * share),
        piece.patch_of_vertex[a],
    )


def grown(
    piece: Piece,
    triangles: Numbers,
    patch_of_triangle: Numbers,
    places: Array,
    heights: Array,
    normals: npt.NDArray[np.float32],
    patch_of_vertex: Numbers,
) -> Piece:
    """Return a piece with other triangles, and more vertices behind its own."""
    return replace(
        piece,
        places=np.concatenate([piece.places, places]),
        heights=np.concatenate([piece.heights, heights]),
        normals=np.concatenate([piece.normals, normals]),
        patch_of_vertex=np.concatenate([piece.patch_of_vertex, patch_of_vertex]),
        triangles=triangles,
        patch_of_triangle=patch_of_triangle,
    )


def unit(vectors: npt.NDArray[np.floating[Any]]) -> npt.NDArray[np.float32]:
    """Return vectors at unit length; (N, 3)."""
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True), np.float32)
