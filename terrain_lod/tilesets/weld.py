"""A mesh's outline made that of the tile's borders: points put into it, points taken out of it.

Triangles that reach the border are all that changes. A point is put into the triangle behind its
place on the border, which it cuts in two. A point is taken out with the triangles around it; the
polygon that is left, all of which the point could see, is cut into triangles anew.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import numpy.typing as npt

Places = npt.NDArray[np.int64]
Triangles = npt.NDArray[np.int32]


class Outline:
    """The triangles along the border of a square, while they are changed.

    Parameters
    ----------
    places : (V, 2) int64
        On the tile's grid, x eastwards and y northwards.
    triangles : (T, 3) int32
        Counter-clockwise, without any of no area.
    size : int
        The square is 0..size along both axes.
    """

    def __init__(self, places: Places, triangles: Triangles, size: int) -> None:
        on_border = ((places == 0) | (places == size)).any(axis=1)
        near = on_border[triangles].any(axis=1)
        used = np.unique(triangles[near])
        self.places: dict[int, tuple[int, int]] = dict(
            zip(used.tolist(), map(tuple, places[used].tolist()), strict=True)
        )
        self._all = places.copy()
        self._new: list[tuple[int, int]] = []
        self._far = triangles[~near]
        self._near: dict[int, tuple[int, int, int]] = {}
        self._around: dict[int, set[int]] = {}
        self._next = 0
        for a, b, c in triangles[near].tolist():
            self._add(a, b, c)
        self._border = set(np.flatnonzero(on_border).tolist())

    def fit(self, axis: int, line: int, wanted: Sequence[int]) -> None:
        """Make a side's vertices those `wanted`.

        Parameters
        ----------
        axis : {0, 1}
            Which coordinate varies along the side; the other one is `line`.
        line : int
            0 or the size.
        wanted : ascending ints
            Places along it, from 0 to the size.
        """
        there = {
            self.places[vertex][axis]: vertex
            for vertex in self._border
            if self.places[vertex][1 - axis] == line
        }
        self._move(axis, line, there, wanted)
        new = sorted(set(wanted) - there.keys())
        for (low, a), (high, b) in pairwise(sorted(there.items())):
            inside = new[bisect_right(new, low) : bisect_left(new, high)]
            if inside:
                there.update(self._insert(axis, line, a, b, inside))
        ends = sorted(there)
        kept = set(wanted)
        previous = there[ends[0]]
        for place, following in pairwise(ends[1:]):
            if place in kept:
                previous = there[place]
            else:
                self._remove(there[place], previous, there[following])

    def _move(self, axis: int, line: int, there: dict[int, int], wanted: Sequence[int]) -> None:
        """Move vertices that are not wanted to wanted places nearby, where triangles allow it.

        What is moved need not be taken out and put in, which costs far more.
        """
        new = sorted(set(wanted) - there.keys())
        kept = set(wanted)
        before = 0
        for place, following in pairwise(sorted(there)[1:]):
            choices = new[bisect_right(new, before) : bisect_left(new, following)]
            if place in kept or not choices:
                before = place
                continue
            nearest = min(choices, key=lambda choice: abs(choice - place))
            if self._moved(there[place], (nearest, line) if axis == 0 else (line, nearest)):
                there[nearest] = there.pop(place)
                new.remove(nearest)
                place = nearest
            before = place

    def _moved(self, vertex: int, place: tuple[int, int]) -> bool:
        """Move a vertex unless that would turn, or nearly flatten, one of its triangles."""
        around = [self._near[number] for number in self._around[vertex]]
        areas = [self._area(*corners) for corners in around]
        was, self.places[vertex] = self.places[vertex], place
        if any(
            4 * self._area(*corners) < area for corners, area in zip(around, areas, strict=True)
        ):
            self.places[vertex] = was
            return False
        self._all[vertex] = place
        return True

    def result(self) -> tuple[Places, Triangles]:
        """Return the places of all vertices, some of which nobody uses, and all triangles."""
        near = np.array(list(self._near.values()), np.int32).reshape(-1, 3)
        new = np.array(self._new, np.int64).reshape(-1, 2)
        return np.concatenate([self._all, new]), np.concatenate([self._far, near])

    def _add(self, a: int, b: int, c: int) -> None:
        self._near[self._next] = (a, b, c)
        for vertex in (a, b, c):
            self._around.setdefault(vertex, set()).add(self._next)
        self._next += 1

    def _drop(self, number: int) -> tuple[int, int, int]:
        corners = self._near.pop(number)
        for vertex in corners:
            self._around[vertex].discard(number)
        return corners

    def _insert(
        self, axis: int, line: int, a: int, b: int, inside: Sequence[int]
    ) -> dict[int, int]:
        """Cut the triangle behind border edge a-b at places between."""
        (number,) = self._around[a] & self._around[b]
        corners = self._drop(number)
        (apex,) = set(corners) - {a, b}
        made = {}
        for place in inside:
            made[place] = vertex = len(self._all) + len(self._new)
            self._new.append((place, line) if axis == 0 else (line, place))
            self.places[vertex] = self._new[-1]
        chain = [a, *made.values(), b]
        # the triangle ran a, b, apex or b, a, apex
        turn = corners[(corners.index(a) + 1) % 3] == b
        for first, second in pairwise(chain):
            self._add(*((first, second, apex) if turn else (second, first, apex)))
        self._border.update(made.values())
        return made

    def _remove(self, vertex: int, previous: int, following: int) -> None:
        """Take a vertex out from between its neighbours on the border."""
        link = {}
        for number in list(self._around[vertex]):
            corners = self._drop(number)
            at = corners.index(vertex)
            link[corners[(at + 1) % 3]] = corners[(at + 2) % 3]
        (begin,) = link.keys() - set(link.values())
        ring = [begin]
        while ring[-1] in link:
            ring.append(link[ring[-1]])
        assert {ring[0], ring[-1]} == {previous, following}
        self._border.remove(vertex)
        made = self._cut(ring)
        assert made is not None, "a polygon with a base that sees all of it can be cut"
        for corners in made:
            self._add(*corners)

    def _cut(self, ring: list[int]) -> list[tuple[int, int, int]] | None:
        """Cut a counter-clockwise polygon; the triangle on its closing edge is the first choice."""
        if len(ring) < 3:
            return []
        first, last = ring[0], ring[-1]
        # the apex that sees the edge under the widest angle is Delaunay's choice
        choices = sorted(range(1, len(ring) - 1), key=lambda i: self._cosine(last, first, ring[i]))
        for index in choices:
            apex = ring[index]
            if self._area(last, first, apex) <= 0 or any(
                self._within(other, last, first, apex) for other in ring[1:-1] if other != apex
            ):
                continue
            left, right = self._cut(ring[: index + 1]), self._cut(ring[index:])
            if left is not None and right is not None:
                return [(last, first, apex), *left, *right]
        return None

    def _area(self, a: int, b: int, c: int) -> int:
        (ax, ay), (bx, by), (cx, cy) = self.places[a], self.places[b], self.places[c]
        return (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)

    def _within(self, point: int, a: int, b: int, c: int) -> bool:
        """Return whether a point is inside a triangle or on its sides."""
        return (
            self._area(a, b, point) >= 0
            and self._area(b, c, point) >= 0
            and self._area(c, a, point) >= 0
        )

    def _cosine(self, a: int, b: int, apex: int) -> float:
        (ax, ay), (bx, by), (cx, cy) = self.places[a], self.places[b], self.places[apex]
        along = (ax - cx) * (bx - cx) + (ay - cy) * (by - cy)
        lengths = ((ax - cx) ** 2 + (ay - cy) ** 2) * ((bx - cx) ** 2 + (by - cy) ** 2)
        return float(along / lengths**0.5)
