"""Chunks of any levels joined without a crack.

Where two chunks meet, both show one line: the points of both, on the lattice of the finer one. The
coarser one's points move onto it, up or down, and each side takes the other's points in, by
splitting the triangles at its border. What was changed so is measured anew.

::

     finer    a-------b-------c        a---x---b---y---c     all of them on the finer lattice
     coarser      x       y            a---x---b---y---c
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from .piece import AXES, EAST, NORTH, SOUTH, WEST, Array, Numbers, Piece, grown, unit

OPPOSITE: Final = {WEST: EAST, NORTH: SOUTH, EAST: WEST, SOUTH: NORTH}


@dataclass(frozen=True, eq=False)
class Edges:
    """The E edges of triangles on a side of a piece.

    Attributes
    ----------
    triangles : (E,) int32
    corners : (E,) int64
        Which corner of its triangle an edge starts at.
    starts, ends : (E,) int32
        Vertices.
    low, high : (E,) float64
        Between which places along the side it lies.
    """

    triangles: Numbers
    corners: npt.NDArray[np.int64]
    starts: Numbers
    ends: Numbers
    low: Array
    high: Array

    @classmethod
    def of(cls, piece: Piece, side: int) -> Edges:
        on = piece.on(side)[piece.triangles]
        triangles, corners = np.nonzero(on & on[:, [1, 2, 0]])
        starts = piece.triangles[triangles, corners]
        ends = piece.triangles[triangles, (corners + 1) % 3]
        along = piece.places[:, 1 - AXES[side]]
        low, high = np.minimum(along[starts], along[ends]), np.maximum(along[starts], along[ends])
        return cls(triangles.astype(np.int32), corners, starts, ends, low, high)

    def within(self, low: float, high: float) -> Edges:
        """Return those that lie at least in part between two places."""
        kept = (self.high > low) & (self.low < high)
        return Edges(*(values[kept] for values in vars(self).values()))

    def covers(self, places: Array, near: float) -> npt.NDArray[np.bool_]:
        """Return which places are on one of the edges."""
        if not len(self.low):
            return np.zeros(len(places), bool)
        order = np.argsort(self.low)
        last = np.searchsorted(self.low[order], places + near, side="right") - 1
        found: npt.NDArray[np.bool_] = (last >= 0) & (
            self.high[order][np.maximum(last, 0)] >= places - near
        )
        return found


@dataclass(frozen=True, eq=False)
class Points:
    """N points of the line between two pieces.

    Attributes
    ----------
    along : (N,) float64
        Places along it.
    heights : (N,) float64
    normals : (N, 3) float32
        Means of those that the pieces have there.
    """

    along: Array
    heights: Array
    normals: npt.NDArray[np.float32]

    def at(self, numbers: npt.NDArray[Any]) -> Points:
        """Return some of them."""
        return Points(self.along[numbers], self.heights[numbers], self.normals[numbers])


@dataclass(frozen=True, eq=False)
class Inserted:
    """N points that come into edges of a piece.

    Attributes
    ----------
    triangles, corners : (N,)
        As those of the edges.
    places : (N, 2) float64
    heights : (N,) float64
    normals : (N, 3) float32
    """

    triangles: Numbers
    corners: npt.NDArray[np.int64]
    places: Array
    heights: Array
    normals: npt.NDArray[np.float32]


def join(pieces: list[Piece]) -> list[Piece]:
    """Return pieces whose borders are the same from both sides, to the bit."""
    pieces = list(pieces)
    inserted: list[list[Inserted]] = [[] for _ in pieces]
    known: dict[tuple[int, int], Edges] = {}

    def edges(number: int, side: int) -> Edges:
        # triangles stay as they are until all points to come are known
        if (number, side) not in known:
            known[number, side] = Edges.of(pieces[number], side)
        return known[number, side]

    for leader, side, follower in _meetings(pieces):
        one, other = pieces[leader], pieces[follower]
        low, high = (one.sides[number] for number in ((1, 3) if AXES[side] == 0 else (0, 2)))
        pieces[leader], pieces[follower], new_one, new_other = _meet(
            one, edges(leader, side), other, edges(follower, OPPOSITE[side]), side, low, high
        )
        inserted[leader].append(new_one)
        inserted[follower].append(new_other)
    return [_split(piece, points) for piece, points in zip(pieces, inserted, strict=True)]


def _meetings(pieces: list[Piece]) -> list[tuple[int, int, int]]:
    """Return each side of a piece that another one leads along or follows: leader, side, follower.

    The side is the leader's, and all of it is a part of the follower's.
    """
    found = []
    for side in (WEST, NORTH, EAST, SOUTH):
        facing: dict[float, list[int]] = {}
        for number, piece in enumerate(pieces):
            facing.setdefault(piece.sides[OPPOSITE[side]], []).append(number)
        first, last = (1, 3) if AXES[side] == 0 else (0, 2)
        for leader, piece in enumerate(pieces):
            for follower in facing.get(piece.sides[side], ()):
                other = pieces[follower]
                leads = piece.level < other.level or (
                    piece.level == other.level and side in (EAST, SOUTH)
                )
                inside = (
                    other.sides[first] <= piece.sides[first]
                    and piece.sides[last] <= other.sides[last]
                )
                if leads and inside:
                    found.append((leader, side, follower))
    # the finest lead first: a corner of theirs stands before coarser ones follow it
    return sorted(found, key=lambda meeting: pieces[meeting[0]].level)


def _meet(
    one: Piece, edges: Edges, other: Piece, facing: Edges, side: int, low: float, high: float
) -> tuple[Piece, Piece, Inserted, Inserted]:
    """Put a leader and a follower on one line; return them, and the points that come into both."""
    near, axis = one.near, AXES[side]
    facing = facing.within(low, high)
    led, following = (np.unique([part.starts, part.ends]) for part in (edges, facing))
    along = other.places[following, 1 - axis]
    following = following[(along > low - near) & (along < high + near)]
    places = np.concatenate([one.places[led, 1 - axis], other.places[following, 1 - axis]])
    order = np.argsort(places, kind="stable")
    group = np.empty(len(places), np.int64)
    group[order] = np.cumsum(np.diff(places[order], prepend=-np.inf) > near) - 1
    # where both have a point it is the leader's
    line = np.full(int(group.max(initial=-1)) + 1, np.nan)
    for part in (slice(len(led), None), slice(len(led))):
        line[group[part]] = places[part]
    heights = one.heights_along(side, line)
    normals = np.zeros((len(line), 3))
    np.add.at(normals, group, np.concatenate([one.normals[led], other.normals[following]]))
    points = Points(line, heights, unit(normals))
    one = _onto(one, led, points.at(group[: len(led)]), axis)
    # where the leader shows nothing, nobody is to be met
    held = edges.covers(line, near)
    met = held[group[len(led) :]]
    other = _onto(other, following[met], points.at(group[len(led) :][met]), axis)
    new_one = _inserted(edges, points.at(held), axis, one.sides[side], near)
    new_other = _inserted(facing, points.at(held), axis, one.sides[side], near)
    one = one.with_moved(one.patch_of_triangle[new_one.triangles])
    return one, other.with_moved(other.patch_of_triangle[new_other.triangles]), new_one, new_other


def _onto(piece: Piece, vertices: Numbers, points: Points, axis: int) -> Piece:
    """Return a piece with vertices moved to points of a line."""
    places, heights, normals = piece.places.copy(), piece.heights.copy(), piece.normals.copy()
    places[vertices, 1 - axis] = points.along
    heights[vertices], normals[vertices] = points.heights, points.normals
    changed = vertices[heights[vertices] != piece.heights[vertices]]
    piece = replace(piece, places=places, heights=heights, normals=normals)
    return piece.with_moved(piece.patch_of_vertex[changed])


def _inserted(edges: Edges, points: Points, axis: int, across: float, near: float) -> Inserted:
    """Return the points of a line that lie within edges."""
    line = points.along
    first = np.searchsorted(line, edges.low + near)
    counts = np.maximum(np.searchsorted(line, edges.high - near) - first, 0)
    edge = np.repeat(np.arange(len(counts)), counts)
    number = first[edge] + np.arange(len(edge)) - np.repeat(np.cumsum(counts) - counts, counts)
    places = np.empty((len(number), 2))
    places[:, axis], places[:, 1 - axis] = across, line[number]
    points = points.at(number)
    return Inserted(
        edges.triangles[edge], edges.corners[edge], places, points.heights, points.normals
    )


def _split(piece: Piece, inserted: list[Inserted]) -> Piece:
    """Return a piece whose triangles have taken points into their edges."""
    triangles, corners, places, heights, normals = (
        np.concatenate([getattr(points, name) for points in inserted]) if inserted else np.zeros(0)
        for name in ("triangles", "corners", "places", "heights", "normals")
    )
    if not len(triangles):
        return piece
    starts = piece.triangles[triangles, corners]
    # in the order in which each edge meets them, and each once, where two leaders end at it
    way = np.hypot(*(places - piece.places[starts]).T)
    order = np.lexsort([way, corners, triangles])
    again = (np.diff(way[order]) < piece.near / 100) & (np.diff(triangles[order]) == 0)
    order = order[np.append(True, ~(again & (np.diff(corners[order]) == 0)))]
    first = len(piece.heights)
    by_triangle: dict[int, list[list[int]]] = {}
    for number, point in enumerate(order.tolist()):
        runs = by_triangle.setdefault(int(triangles[point]), [[], [], []])
        runs[corners[point]].append(first + number)
    split: list[tuple[int, int, int]] = []
    patches: list[int] = []
    for triangle, runs in by_triangle.items():
        fan = _fan(piece.triangles[triangle].tolist(), runs)
        split += fan
        patches += [int(piece.patch_of_triangle[triangle])] * len(fan)
    whole = np.ones(len(piece.triangles), bool)
    whole[list(by_triangle)] = False
    return grown(
        piece,
        np.concatenate([piece.triangles[whole], np.array(split, np.int32)]),
        np.concatenate([piece.patch_of_triangle[whole], np.array(patches, np.int32)]),
        places[order],
        heights[order],
        normals[order],
        piece.patch_of_triangle[triangles[order]],
    )


def _fan(corners: list[int], runs: list[list[int]]) -> list[tuple[int, int, int]]:
    """Return the triangles of one that has points on its edges."""
    fullest = max(range(3), key=lambda edge: len(runs[edge]))
    a, b, c = (corners[(fullest + step) % 3] for step in range(3))
    on_ab, on_bc, on_ca = (runs[(fullest + step) % 3] for step in range(3))
    fan = [(p, q, c) for p, q in pairwise([a, *on_ab, b])]
    for edge, others in (((b, c), on_bc), ((c, a), on_ca)):
        if others:
            number = len(fan) - 1 if edge == (b, c) else 0
            p, q, _ = fan[number]
            chain = [edge[0], *others, edge[1]]
            apex = p if edge == (b, c) else q
            fan[number : number + 1] = [(s, t, apex) for s, t in pairwise(chain)]
    return fan
