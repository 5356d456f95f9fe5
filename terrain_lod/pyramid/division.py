"""How a raster is divided: levels, chunks, nodes, and the regions that are built at a time.

A level-k lattice has every 2^k-th sample, so that level k + 1 is every second one of level k. A
**chunk** is a square of cells of one level, its two shared borders included; a **node** is a square
of `NODE` cells of one level. A **region** is as many samples as `REGION` x `REGION` chunks of level
0 have: what a worker reads at a time, and enough to know the lattices of all levels within.

Where the last sample of a row or column is not on a lattice, the lattice has one more point beyond
it, on the line through the last two places that are known: see :func:`lattice_of`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np
import numpy.typing as npt

from ..errors import InputError

NODE: Final = 8
"""Cells along a node."""
REGION: Final = 8
"""Chunks of level 0 along a region."""
CHUNK: Final = 512
"""Cells along a chunk, unless said otherwise."""
LADDER: Final = 4
"""Errors that are known of a node: those of its level's lattice, and of the next three."""

Samples = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Division:
    """The division of a raster of R x C samples into chunks.

    Parameters
    ----------
    rows, columns : int
        R and C, at least 2.
    chunk : int
        Cells along a chunk, a power of two from 16 to 4096.

    Raises
    ------
    InputError
        If `chunk` is none of these, or too small for so large a raster.
    """

    rows: int
    columns: int
    chunk: int = CHUNK

    def __post_init__(self) -> None:
        if self.chunk not in (2**power for power in range(4, 13)):
            raise InputError(
                f"expected a power of two from 16 to 4096 for chunk, got {self.chunk!r}"
            )
        if 1 << self.top > self.region:
            raise InputError(
                f"expected at most {self.chunk * self.region + 1:,} samples along a side in chunks "
                f"of {self.chunk} cells, got {self.rows:,} x {self.columns:,}: use larger chunks"
            )

    @property
    def region(self) -> int:
        """Cells along a region."""
        return REGION * self.chunk

    @property
    def cells(self) -> tuple[int, int]:
        return self.rows - 1, self.columns - 1

    @cached_property
    def top(self) -> int:
        """The coarsest level: all of the raster is one chunk of it."""
        level = 0
        while max(self.cells) > self.chunk << level:
            level += 1
        return level

    @property
    def levels(self) -> range:
        return range(self.top + 1)

    @property
    def fine(self) -> range:
        """Levels whose chunks lie within a region."""
        return range(min(self.top, REGION.bit_length() - 1) + 1)

    @property
    def coarse(self) -> range:
        """Levels whose chunks are made of several regions."""
        return range(len(self.fine), self.top + 1)

    @property
    def nodes(self) -> int:
        """Nodes along a chunk."""
        return self.chunk // NODE

    @property
    def regions(self) -> tuple[int, int]:
        """Rows and columns of regions."""
        return _parts(self.cells[0], self.region), _parts(self.cells[1], self.region)

    def chunks(self, level: int) -> tuple[int, int]:
        """Return rows and columns of the chunks of a level."""
        size = self.chunk << level
        return _parts(self.cells[0], size), _parts(self.cells[1], size)

    def region_slices(self, row: int, column: int) -> tuple[slice, slice]:
        """Return the samples of a region, its shared borders included."""
        down, across = (
            slice(place * self.region, min((place + 1) * self.region, cells) + 1)
            for place, cells in ((row, self.cells[0]), (column, self.cells[1]))
        )
        return down, across

    def chunk_cells(self, level: int, row: int, column: int) -> tuple[int, int]:
        """Return the cells of a level that a chunk has, one that is only begun included."""
        down, across = (
            min(_parts(cells, 1 << level) - place * self.chunk, self.chunk)
            for place, cells in ((row, self.cells[0]), (column, self.cells[1]))
        )
        return down, across


def _parts(whole: int, part: int) -> int:
    return -(-whole // part)


def lattice_of(heights: Samples, stride: int) -> Samples:
    """Return every `stride`-th sample along both axes, and one beyond where the last is none.

    What lies beyond is so high that the line to it from the lattice's last point meets the last
    sample there is.

    Parameters
    ----------
    heights : (R, C) float32

    Returns
    -------
    (ceil((R - 1) / stride) + 1, ceil((C - 1) / stride) + 1) float32
    """
    return _along_rows(_along_rows(heights, stride).T, stride).T


def _along_rows(heights: Samples, stride: int) -> Samples:
    kept, beyond = heights[::stride], (len(heights) - 1) % stride
    if not beyond:
        return kept
    last, end = kept[-1].astype(np.float64), heights[-1].astype(np.float64)
    added = last + (end - last) * (stride / beyond)
    return np.concatenate([kept, added[None].astype(np.float32)])
