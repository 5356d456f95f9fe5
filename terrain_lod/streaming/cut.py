"""Which chunks of which levels a view is made of: a cut through the pyramid."""

from __future__ import annotations

import heapq
from collections.abc import Container, Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Final

import numpy as np
import numpy.typing as npt

from ..device import layout
from ..pyramid.codes import decode
from ..pyramid.region import Nodes
from ..pyramid.store import Store
from .view import Asked, Boxes

SHARE: Final = 0.25
"""The part of what is allowed that a level's own distance from the samples may take."""

Place = tuple[int, int, int]
"""Level, row and column of a chunk."""


@dataclass(frozen=True, eq=False)
class Cut:
    """Chunks that cover all that is in view, once.

    Attributes
    ----------
    places : tuple of Place
    missing : tuple of Place
        Those that are not at hand and would be better, the coarsest first.
    is_enough : bool
        Whether all of them are fine enough.
    """

    places: tuple[Place, ...]
    missing: tuple[Place, ...]
    is_enough: bool


def with_above(place: Place) -> Iterator[Place]:
    """Yield a chunk, its ancestors, and more beyond the root."""
    level, row, column = place
    for more in range(layout.MAX_LEVELS):
        yield level + more, row >> more, column >> more


class Chunks:
    """What is known of all chunks of a store before any is read.

    Parameters
    ----------
    store : Store
    """

    def __init__(self, store: Store) -> None:
        self.store, self.division = store, store.division
        self._known: dict[int, Nodes] = {}

    def known(self, level: int) -> Nodes:
        """Return the errors and ranges of a level's chunks."""
        if level not in self._known:
            self._known[level] = self.store.chunk_nodes(level)
        return self._known[level]

    @property
    def root(self) -> Place:
        return self.division.top, 0, 0

    def at(self, cells: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
        """Return column and row of the chunks of level 0 that columns and rows of samples are in.

        Where they are in none, it is the nearest; (N, 2).
        """
        last = np.array(self.division.chunks(0))[::-1] - 1
        return np.clip(cells // self.division.chunk, 0, last).astype(np.int64)

    def children(self, place: Place) -> list[Place]:
        level, row, column = place
        rows, columns = self.division.chunks(level - 1)
        return [
            (level - 1, down, across)
            for down in range(2 * row, min(2 * row + 2, rows))
            for across in range(2 * column, min(2 * column + 2, columns))
        ]

    def boxes(self, places: list[Place]) -> Boxes:
        """Return the world boxes of chunks of one level; NaN in height where there is no data."""
        own, level = self.store.description, places[0][0]
        rows, columns = np.array(places)[:, 1:].T
        size, (dx, dy), (x0, y0) = self.division.chunk << level, own.spacing, own.origin
        ranges = self.known(level).ranges[rows, columns].astype(np.float64) + own.base
        east = np.minimum((columns + 1) * size, own.columns - 1)
        south = np.minimum((rows + 1) * size, own.rows - 1)
        low = np.stack([x0 + columns * size * dx, y0 - south * dy, ranges[:, 0]], axis=-1)
        high = np.stack([x0 + east * dx, y0 - rows * size * dy, ranges[:, 1]], axis=-1)
        return Boxes(low, high)

    def drift(self, places: list[Place]) -> np.ndarray[tuple[int], np.dtype[np.float32]]:
        """Return how far all samples are from the lattices of chunks of one level."""
        rows, columns = np.array(places)[:, 1:].T
        return decode(self.known(places[0][0]).errors[rows, columns, 0])

    def at_hand(self, cut: Cut, held: Container[Place]) -> Cut:
        """Return a cut with the nearest ancestors that are held in place of what is not.

        The root has to be.
        """
        missing: set[Place] = set()
        instead: set[Place] = set()
        for place in cut.places:
            found = place
            while found not in held:
                missing.add(found)
                level, row, column = found
                found = level + 1, row // 2, column // 2
            instead.add(found)
        # what lies below another one is covered by it
        kept = [
            place
            for place in instead
            if not any(above in instead for above in islice(with_above(place), 1, None))
        ]
        ordered = sorted(missing, key=lambda place: (-place[0], place))
        return Cut(tuple(sorted(kept)), tuple(ordered), cut.is_enough and not missing)

    def cut(self, asked: Asked, most: int, *, finer: frozenset[Place] = frozenset()) -> Cut:
        """Choose chunks, splitting the one first that is farthest from what it may be.

        Parameters
        ----------
        asked : Asked
        most : int
            Chunks at most; then what is chosen may not be enough.
        finer : frozenset of Place
            Chunks that are split whatever they promise.
        """
        heap: list[tuple[float, Place]] = []
        is_enough = True
        for ratio, place in self._judged(asked, [self.root], finer):
            heapq.heappush(heap, (-ratio, place))
        chosen: list[Place] = []
        while heap:
            ratio, place = heapq.heappop(heap)
            if -ratio <= SHARE or place[0] == 0:
                chosen.append(place)
                continue
            children = list(self._judged(asked, self.children(place), finer))
            if len(heap) + len(chosen) + len(children) > most:
                is_enough = False
                chosen.append(place)
                continue
            for worse, child in children:
                heapq.heappush(heap, (-worse, child))
        return Cut(tuple(sorted(chosen)), (), is_enough)

    def _judged(
        self, asked: Asked, places: list[Place], finer: frozenset[Place]
    ) -> Iterator[tuple[float, Place]]:
        """Yield the chunks in view, and their drifts as parts of what they may be off."""
        boxes = self.boxes(places)
        there = ~np.isnan(boxes.low[:, 2])
        boxes = Boxes(np.nan_to_num(boxes.low), np.nan_to_num(boxes.high))
        shown, allowed, drift = asked.shows(boxes) & there, asked.allowed(boxes), self.drift(places)
        for number in np.flatnonzero(shown):
            place = places[number]
            ratio = float(drift[number] / allowed[number]) if drift[number] else 0.0
            yield (np.inf if place in finer else ratio), place
