"""What a region hands up to the levels whose chunks are larger than it, in three flat arrays."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from .codes import Codes
from .division import NODE, Division, Samples
from .region import Nodes


@dataclass(frozen=True, eq=False)
class Handed:
    """Squares of values of one level after the other, row by row.

    Where the raster ends within a square, heights and ranges are NaN and errors 0.

    Attributes
    ----------
    division : Division
    heights : (H,) float32
        Lattices of the coarse levels; one NaN where there are none.
    errors : (K, LADDER) uint8
    ranges : (K, 2) float32
        Of the chunks of fine levels, then of the nodes of coarse ones.
    """

    division: Division
    heights: Samples
    errors: Codes
    ranges: Samples

    @classmethod
    def of(cls, division: Division, lattices: list[Samples], nodes: list[Nodes]) -> Handed:
        """Pack the lattices of the coarse levels, and chunks or nodes of all levels."""
        heights = [
            _square(lattice, _lattice_side(division, level), np.nan).ravel()
            for level, lattice in zip(division.coarse, lattices, strict=True)
        ]
        sides = [_node_side(division, level) for level in division.levels]
        known = list(zip(sides, nodes, strict=True))
        return cls(
            division,
            np.concatenate(heights or [np.full(1, np.nan, np.float32)]),
            np.concatenate([_rows(_square(part.errors, side, 0)) for side, part in known]),
            np.concatenate([_rows(_square(part.ranges, side, np.nan)) for side, part in known]),
        )

    def lattice(self, level: int) -> Samples:
        """Return a coarse level's lattice in the region, NaN beyond the raster."""
        part, side = _part(_lattice_sides(self.division), level)
        return self.heights[part].reshape(side, side)

    def nodes(self, level: int) -> Nodes:
        """Return the chunks of a fine level in the region, or the nodes of a coarse one."""
        part, side = _part(_node_sides(self.division), level)
        return Nodes(
            self.errors[part].reshape(side, side, -1), self.ranges[part].reshape(side, side, 2)
        )


def handed_sizes(division: Division) -> tuple[int, int]:
    """Return H and K."""
    heights = sum(side**2 for _, side in _lattice_sides(division))
    return max(heights, 1), sum(side**2 for _, side in _node_sides(division))


def _lattice_sides(division: Division) -> Iterator[tuple[int, int]]:
    return ((level, _lattice_side(division, level)) for level in division.coarse)


def _node_sides(division: Division) -> Iterator[tuple[int, int]]:
    return ((level, _node_side(division, level)) for level in division.levels)


def _lattice_side(division: Division, level: int) -> int:
    return (division.region >> level) + 1


def _node_side(division: Division, level: int) -> int:
    """Return the chunks along a region, or on coarse levels the nodes, at least one."""
    cells = division.chunk if level in division.fine else NODE
    return max(division.region // cells >> level, 1)


def _part(sides: Iterator[tuple[int, int]], level: int) -> tuple[slice, int]:
    """Return where in a flat array a level's square is, and its side."""
    first = 0
    for below, side in sides:
        if below == level:
            return slice(first, first + side**2), side
        first += side**2
    raise AssertionError(level)


def _square(values: Any, side: int, fill: float) -> Any:
    """Return values in the north-western corner of a square, `fill` elsewhere."""
    square = np.full((side, side, *values.shape[2:]), fill, values.dtype)
    square[: values.shape[0], : values.shape[1]] = values
    return square


def _rows(values: Any) -> Any:
    return values.reshape(-1, values.shape[-1])
