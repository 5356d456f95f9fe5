"""What a region hands up: chunks of the fine levels, and what coarse ones are made of."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from .codes import Codes, encode
from .division import LADDER, Division, Samples, lattice_of
from .drift import Errors, drifts, gathered, ladders, ranges


@dataclass(frozen=True, eq=False)
class Nodes:
    """What is known of nodes, or of chunks: all samples of level 0 within are judged.

    Attributes
    ----------
    errors : (NR, NC, LADDER) uint8
        Codes of the errors of the lattices of their own level and of the next ones.
    ranges : (NR, NC, 2) float32
        Lowest and highest sample; NaN where there is no data.
    """

    errors: Codes
    ranges: Errors

    def gathered(self, count: int) -> Nodes:
        """Return the errors and the range of each square of `count` x `count` together."""
        if count < 2:
            return self
        level = count.bit_length() - 1
        low, high = self.ranges[..., 0], self.ranges[..., 1]
        ranges = np.stack([-gathered(-low, level), gathered(high, level)], axis=-1)
        return Nodes(gathered(self.errors, level), ranges)

    def largest(self) -> Nodes:
        """Return each chunk's errors and range, of nodes that are cut into chunks."""
        low, high = self.ranges[..., 0], self.ranges[..., 1]
        within = (2, 3)
        ranges = [np.fmin.reduce(low, axis=within), np.fmax.reduce(high, axis=within)]
        return Nodes(self.errors.max(axis=within), np.stack(ranges, axis=-1))


@dataclass(frozen=True, eq=False)
class Region:
    """A region, looked at once.

    Attributes
    ----------
    division : Division
    heights : (r, c) float32
        Relative to the base, NaN where there is no data.
    """

    division: Division
    heights: Samples

    def lattice(self, level: int) -> Samples:
        """Return the level's lattice within the region."""
        return lattice_of(self.heights, 1 << level)

    def nodes(self) -> list[Nodes]:
        """Return the nodes of all levels within the region; a part of one, where it is larger."""
        size, top = self.division.region, self.division.top
        strides = [1 << level for level in range(top + LADDER) if 1 << level <= size]
        extents = ranges(self.heights)
        finest = Nodes(np.zeros((*extents.shape[:2], LADDER), np.uint8), extents)
        by_stride = [np.zeros(extents.shape[:2], np.float32)]
        by_stride += [
            drifts(self.heights, lattice_of(self.heights, stride), stride) for stride in strides[1:]
        ]
        return [
            Nodes(encode(ladders(by_stride, level)), finest.gathered(1 << level).ranges)
            for level in self.division.levels
        ]


def into_chunks(lattice: Samples, chunk: int) -> Samples:
    """Return a lattice cut into chunks that share their borders, NaN beyond it.

    Returns
    -------
    (CR, CC, chunk + 1, chunk + 1) float32
    """
    rows, columns = (-(-(extent - 1) // chunk) for extent in lattice.shape)
    chunks = np.full((rows, columns, chunk + 1, chunk + 1), np.nan, np.float32)
    for row in range(rows):
        for column in range(columns):
            part = lattice[
                row * chunk : (row + 1) * chunk + 1, column * chunk : (column + 1) * chunk + 1
            ]
            chunks[row, column, : part.shape[0], : part.shape[1]] = part
    return chunks


def nodes_into_chunks(nodes: Nodes, count: int) -> Nodes:
    """Return nodes cut into chunks of `count` x `count`, errors 0 and ranges NaN beyond them.

    Its arrays have the shapes (CR, CC, count, count, ...).
    """

    def cut(values: npt.NDArray[np.generic], fill: float) -> npt.NDArray[np.generic]:
        rows, columns = (-(-extent // count) for extent in values.shape[:2])
        missing = rows * count - values.shape[0], columns * count - values.shape[1]
        padded = np.pad(values, ((0, missing[0]), (0, missing[1]), (0, 0)), constant_values=fill)
        return padded.reshape(rows, count, columns, count, -1).swapaxes(1, 2)

    return Nodes(cut(nodes.errors, 0), cut(nodes.ranges, np.nan))  # type: ignore[arg-type]
