"""Patches of every size, in float64: what the quadtree's kernels find and choose."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ...device.layout import FIXED_ONE
from ...ground.grid import TileGrid
from ...ground.heightmap import Heightmap
from ..tessellation.tessellator import tessellate
from .selection import tile_error

Array = npt.NDArray[Any]

_WORTH_SPLITTING = 8  # triangles of four children, at least


class Node(NamedTuple):
    """Row and column among the nodes of a level, which cover 2^level x 2^level tiles."""

    level: int
    row: int
    column: int


@dataclass(frozen=True)
class Quadtree:
    """The nodes over the tiles of a ground.

    Attributes
    ----------
    ground : Heightmap
    grid : TileGrid
    shapes : tuple of (int, int)
        Rows and columns of the nodes of each level.
    finer : int
        A node's lattice is 2^finer times finer than its finest pattern.
    """

    ground: Heightmap
    grid: TileGrid
    shapes: tuple[tuple[int, int], ...]
    finer: int

    @cached_property
    def heights(self) -> Array:
        return self.ground.heights.astype(np.float64)

    def nodes(self) -> Iterator[Node]:
        """Yield all nodes, in the order of their numbers."""
        for level, (rows, columns) in enumerate(self.shapes):
            yield from (Node(level, row, column) for row, column in np.ndindex(rows, columns))

    def has(self, node: Node) -> bool:
        rows, columns = self.shapes[node.level]
        return 0 <= node.row < rows and 0 <= node.column < columns

    def children(self, node: Node) -> list[Node]:
        below = [
            Node(node.level - 1, 2 * node.row + down, 2 * node.column + across)
            for down in (0, 1)
            for across in (0, 1)
        ]
        return [child for child in below if self.has(child)]

    def area(self, node: Node) -> tuple[int, int, int, int]:
        """Return the first row, first column, rows and columns of cells."""
        spans = []
        for place, corners in (
            (node.row, self.grid.corner_rows),
            (node.column, self.grid.corner_columns),
        ):
            ends = np.minimum([place << node.level, (place + 1) << node.level], len(corners) - 1)
            begin, end = corners[ends]
            spans.append((int(begin), int(end - begin)))
        (top, down), (left, across) = spans
        return top, left, down, across

    def stride(self, node: Node) -> int:
        return 1 << max(node.level - self.finer, 0)

    def samples(self, node: Node) -> tuple[Array, npt.NDArray[np.bool_]]:
        """Return heights and validity of all samples of a node."""
        top, left, down, across = self.area(node)
        window = slice(top, top + down + 1), slice(left, left + across + 1)
        return self.heights[window], self.ground.valid[window]

    def lattice(self, node: Node) -> Array:
        """Return the heights of a node's lattice, which goes on beyond the raster as it came."""
        top, left, down, across = self.area(node)
        stride, heights = self.stride(node), self.heights
        for axis, first, cells in ((0, top, down), (1, left, across)):
            places = first + stride * np.arange(-(-cells // stride) + 2)
            last = heights.shape[axis] - 1
            there = heights.take(np.minimum(places, last), axis)
            opposite = heights.take(np.clip(2 * last - places, 0, last), axis)
            beyond = places > last
            heights = np.where(
                beyond[:, None] if axis == 0 else beyond, 2 * there - opposite, there
            )
        return heights

    def drift(self, node: Node) -> float:
        """Return how far a node's samples are from its lattice."""
        stride = self.stride(node)
        heights, _ = self.samples(node)
        y, x = (np.arange(extent) / stride for extent in heights.shape)
        return float(np.abs(bilinear(self.lattice(node), y, x) - heights).max())

    def pattern_errors(self, node: Node, fu: int, fv: int) -> tuple[float, float]:
        """Return a pattern's largest error at the lattice's samples, and of the inner ones."""
        _, _, down, across = self.area(node)
        stride, lattice = self.stride(node), self.lattice(node)
        vertices = bilinear(
            lattice,
            np.arange(fv + 1) * down / (fv * stride),
            np.arange(fu + 1) * across / (fu * stride),
        )
        rows, columns = (np.arange(cells // stride + 1) * stride for cells in (down, across))
        y, x = rows * fv / down, columns * fu / across
        j, i = (np.minimum(place.astype(int), f - 1) for place, f in ((y, fv), (x, fu)))
        b, a = (y - j)[:, None], x - i
        j = j[:, None]
        z00, z10 = vertices[j, i], vertices[j, i + 1]
        z01, z11 = vertices[j + 1, i], vertices[j + 1, i + 1]
        falls = ((2 * j + 1 < fv) & (2 * i + 1 <= fu)) | ((2 * j + 1 > fv) & (2 * i + 1 >= fu))
        falling = np.where(
            a >= b, z00 + (z10 - z00) * a + (z11 - z10) * b, z00 + (z01 - z00) * b + (z11 - z01) * a
        )
        rising = np.where(
            a + b <= 1,
            z00 + (z10 - z00) * a + (z01 - z00) * b,
            z11 + (z01 - z11) * (1 - a) + (z10 - z11) * (1 - b),
        )
        errors = np.abs(np.where(falls, falling, rising) - lattice[: len(rows), : len(columns)])
        inner = errors[np.ix_(_inside(rows, fv, down), _inside(columns, fu, across))]
        return float(errors.max()), float(inner.max(initial=0.0))

    def side_factor(self, node: Node, side: int, room: float) -> int:
        """Return the fewest segments along a side that stay within `room` of its samples."""
        top, left, down, across = self.area(node)
        cells, stride = (down, across)[side % 2], self.stride(node)
        line = (
            self.heights[top : top + down + 1, left + (across if side == 2 else 0)]
            if side % 2 == 0
            else self.heights[top + (down if side == 3 else 0), left : left + across + 1]
        )
        known = np.unique(np.append(np.arange(0, cells, stride), cells))
        for f in range(1, min(self.grid.tile, cells)):
            ends = np.arange(f + 1) * cells / f
            drawn = np.interp(known, ends, np.interp(ends, known, line[known]))
            if np.abs(drawn - line[known]).max() <= room:
                return f
        return min(self.grid.tile, cells)


def bilinear(heights: Array, y: Array, x: Array) -> Array:
    """Return heights at rows `y` and columns `x` of a lattice."""
    row, column = (
        np.minimum(place.astype(int), extent - 2)
        for place, extent in zip((y, x), heights.shape, strict=True)
    )
    down, across = (y - row)[:, None], x - column
    row = row[:, None]
    upper = heights[row, column] * (1 - across) + heights[row, column + 1] * across
    lower = heights[row + 1, column] * (1 - across) + heights[row + 1, column + 1] * across
    mixed: Array = upper * (1 - down) + lower * down
    return mixed


def _inside(places: Array, f: int, cells: int) -> Array:
    """Return which samples lie on a pattern's outermost inner lines or between them."""
    return np.flatnonzero((places * f >= cells) & (places * f <= cells * (f - 1)))


class Leaves:
    """The leaves of a mesh within an error in metres, nothing culled.

    Parameters
    ----------
    tree : Quadtree
    metres : float
    share : float
        Of that, what patterns may use.
    order : (T * T,) int32
        Pairs of factors, T (v - 1) + u - 1, the cheapest first.
    """

    def __init__(self, tree: Quadtree, metres: float, share: float, order: Array) -> None:
        self.tree, self.metres, self.share, self.order = tree, metres, share, order
        root = len(tree.shapes) - 1
        self.nodes = [
            leaf
            for row, column in np.ndindex(tree.shapes[root])
            for leaf in self._chosen(Node(root, row, column))[1]
        ]
        self._there = set(self.nodes)

    def _room(self, node: Node) -> float:
        """Return what a pattern may be off; NaN where there is no data."""
        heights, known = self.tree.samples(node)
        if not known.any():
            return np.nan
        allowed = max(self.metres - 1e-6 * float(np.ptp(heights[known])), 0.0)
        return allowed * self.share - (self.tree.drift(node) if self.tree.stride(node) > 1 else 0.0)

    def _holed(self, node: Node) -> bool:
        return not self.tree.samples(node)[1].all()

    def _pairs(self, node: Node) -> Iterator[tuple[int, int]]:
        _, _, down, across = self.tree.area(node)
        for v, u in (divmod(int(pair), self.tree.grid.tile) for pair in self.order):
            if u < max(across, 2) and v < max(down, 2):
                yield u + 1, v + 1

    def _chosen(self, node: Node) -> tuple[float, list[Node]]:
        """Return what a node costs, and the leaves that it is drawn with."""
        room = self._room(node)
        if np.isnan(room):
            return 0.0, []
        _, _, down, across = self.tree.area(node)
        cost = np.inf
        if not self._holed(node) and room > 0:
            for u, v in self._pairs(node):
                fits = u <= across and v <= down and ((u > 1 and v > 1) or u == v)
                if fits and self.tree.pattern_errors(node, u, v)[0] <= room:
                    cost = 2.0 * u * v
                    break
        if node.level == 0:
            return min(cost, 2.0 * down * across), [node]
        if cost <= _WORTH_SPLITTING:
            return cost, [node]
        below = [self._chosen(child) for child in self.tree.children(node)]
        split = sum(each for each, _ in below)
        return (
            (cost, [node])
            if cost <= split
            else (split, [leaf for _, part in below for leaf in part])
        )

    def _cover(self, node: Node) -> Node | None:
        """Return the leaf that covers a tile, if it is drawn."""
        while node not in self._there:
            if node.level + 1 == len(self.tree.shapes):
                return None
            node = Node(node.level + 1, node.row >> 1, node.column >> 1)
        return node

    def sides(self, leaf: Node) -> list[Array]:
        """Return where the points of each side lie, in 1/65536 of a cell, east or south."""
        return [self._side(leaf, side) for side in range(4)]

    def _side(self, leaf: Node, side: int) -> Array:
        row, column = (leaf.row << leaf.level), (leaf.column << leaf.level)
        rows, columns = self.tree.shapes[0]
        down, across = min(1 << leaf.level, rows - row), min(1 << leaf.level, columns - column)
        start = self.tree.area(leaf)[side % 2]
        pieces: dict[Node, None] = {}
        for step in range(down if side % 2 == 0 else across):
            tile = (
                Node(0, row + step, column - 1 if side == 0 else column + across)
                if side % 2 == 0
                else Node(0, row - 1 if side == 1 else row + down, column + step)
            )
            other = self._cover(tile) if self.tree.has(tile) else None
            # what is across and not drawn has no say
            finer = other is not None and other.level < leaf.level
            pieces[other if other is not None and finer else leaf] = None
        places = [np.zeros(1, int)]
        for piece in pieces:
            factor = self._factor(piece, (side + 2) % 4 if piece != leaf else side)
            cells = self.tree.area(piece)[2 + side % 2]
            first = (self.tree.area(piece)[side % 2] - start) * FIXED_ONE
            steps = np.arange(1, factor + 1)
            places.append(first + (steps * cells * FIXED_ONE + factor // 2) // factor)
        return np.concatenate(places)

    def _factor(self, piece: Node, side: int) -> int:
        step = [(0, -1), (-1, 0), (0, 1), (1, 0)][side]
        across = Node(piece.level, piece.row + step[0], piece.column + step[1])
        room, holed = self._room(piece), self._holed(piece)
        if self.tree.has(across):
            other = across
            while other not in self._there and other.level + 1 < len(self.tree.shapes):
                other = Node(other.level + 1, other.row >> 1, other.column >> 1)
            holed |= piece.level == 0 and self._holed(across)
            if other in self._there:
                room = min(room, self._room(other))
        if holed or room <= 0:
            return min(self.tree.grid.tile, self.tree.area(piece)[2 + side % 2])
        return self.tree.side_factor(piece, side, room)

    def inside(self, leaf: Node) -> tuple[int, int] | None:
        """Return the cheapest pair of factors that holds beside the leaf's sides, if any does."""
        _, _, down, across = self.tree.area(leaf)
        room, sides = self._room(leaf), self.sides(leaf)
        full = (max(across, 2), max(down, 2)) if leaf.level == 0 else None
        if self._holed(leaf) or room <= 0:
            return full
        single = all(len(side) == 2 for side in sides)
        if single and self.tree.pattern_errors(leaf, 1, 1)[0] <= room:
            return 1, 1
        for u, v in self._pairs(leaf):
            if u > 1 and v > 1 and self.error(leaf, sides, (u, v)) <= room:
                return u, v
        return full

    def error(self, leaf: Node, sides: list[Array], inside: tuple[int, int]) -> float:
        """Return the largest error of a leaf's triangles at its samples; its stride is 1."""
        heights, known = self.tree.samples(leaf)
        down, across = heights.shape[0] - 1, heights.shape[1] - 1
        counts = [len(side) - 1 for side in sides]
        pattern = tessellate("quad", [counts], [inside], partitioning="integer")
        number = np.rint(pattern.points.astype(np.int64)[:, :] * np.array(inside) / FIXED_ONE)
        x, y = number[:, 0] * across / inside[0], number[:, 1] * down / inside[1]
        u, v = pattern.points.astype(np.int64).T
        for side, (on, along) in enumerate(
            ((u == 0, v), (v == 0, u), (u == FIXED_ONE, v), (v == FIXED_ONE, u))
        ):
            places = (
                sides[side][np.rint(along * counts[side] / FIXED_ONE).astype(int)[on]] / FIXED_ONE
            )
            fixed = (0, 0, across, down)[side]
            x[on], y[on] = (fixed, places) if side % 2 == 0 else (places, fixed)
        z = _at(heights, y, x)
        return tile_error(heights, known, np.stack([x, y, z], axis=1)[pattern.triangles])


def _at(heights: Array, y: Array, x: Array) -> Array:
    """Return bilinear heights at points."""
    row, column = (
        np.minimum(place.astype(int), extent - 2)
        for place, extent in zip((y, x), heights.shape, strict=True)
    )
    down, across = y - row, x - column
    upper = heights[row, column] * (1 - across) + heights[row, column + 1] * across
    lower = heights[row + 1, column] * (1 - across) + heights[row + 1, column + 1] * across
    mixed: Array = upper * (1 - down) + lower * down
    return mixed
