"""How far all samples are from coarse lattices: the errors that a pyramid stores.

The distance is to the lattice's surface, bilinear in each of its cells. Where a cell's corner has
no data while a sample in it has, or the other way round, it is infinite: the lattice is no
likeness of that ground.
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from .division import LADDER, NODE, Samples

# a dozen roundings to float32, as a part of the largest height that is interpolated
_ROUNDING: Final = 1e-6
# rows of nodes that are worked on at a time: as much as a processor keeps at hand
_STRIPS: Final = 4

Errors = npt.NDArray[np.float32]


def drifts(heights: Samples, lattice: Samples, stride: int) -> Errors:
    """Return the largest distance of samples from a lattice, in squares of `NODE` cells.

    Parameters
    ----------
    heights : (R, C) float32
        NaN where there is no data.
    lattice : float32
        As :func:`~terrain_lod.pyramid.division.lattice_of` makes it.
    stride : int
        Cells of a cell of the lattice.

    Returns
    -------
    (ceil((R - 1) / NODE), ceil((C - 1) / NODE)) float32
        Of the samples of each square, those on its borders included. A bound: rounded up.
    """
    rows, columns = heights.shape
    has_holes = has_nan(heights)
    lines = _between(lattice, stride, columns)
    # the next line as seen from each
    steps = np.diff(lines, axis=0)
    found = np.empty((-(-(rows - 1) // NODE), -(-(columns - 1) // NODE)), np.float32)
    for first in range(0, len(found), _STRIPS):
        top, bottom = first * NODE, min((first + _STRIPS) * NODE, rows - 1)
        places = np.arange(top, bottom + 1)
        above = np.minimum(places // stride, len(steps) - 1)
        share = ((places - above * stride) / np.float32(stride)).astype(np.float32)
        off = steps[above]
        off *= share[:, None]
        off += lines[above]
        there = heights[top : bottom + 1]
        beside = np.isnan(off) if has_holes else None
        off -= there
        np.abs(off, out=off)
        if beside is not None:
            missing = np.isnan(there)
            off[missing & beside] = 0.0
            off[missing != beside] = np.inf
        found[first : first + _STRIPS] = _squares(off)
    found[found > 0] *= np.float32(1 + _ROUNDING)
    found[found > 0] += np.float32(_ROUNDING * _largest(lattice))
    return found


def ranges(heights: Samples) -> Errors:
    """Return the lowest and highest sample in squares of `NODE` cells; NaN where all are.

    Returns
    -------
    (ceil((R - 1) / NODE), ceil((C - 1) / NODE), 2) float32
    """
    down = -heights
    if has_nan(heights):
        missing = np.isnan(heights)
        heights, down = (np.where(missing, -np.inf, values) for values in (heights, down))
    low, high = -_squares(down), _squares(heights)
    found = np.stack([low, high], axis=-1).astype(np.float32)
    found[np.isinf(high)] = np.nan
    return found


def has_nan(heights: Samples) -> bool:
    """Return whether any height is NaN, without an array of answers."""
    return bool(np.isnan(heights.sum(dtype=np.float64)))


def ladders(by_stride: list[Errors], level: int) -> Errors:
    """Return the errors of a level's nodes: of its lattice, and of the next `LADDER` - 1.

    Parameters
    ----------
    by_stride : list of (NR, NC) float32
        :func:`drifts` of the lattices of level 0, 1, 2, ...
    level : int

    Returns
    -------
    (NR / 2^level, NC / 2^level, LADDER) float32
        Rounded up; infinite where `by_stride` ends.
    """
    rungs = []
    for rung in range(LADDER):
        known = level + rung < len(by_stride)
        rungs.append(
            gathered(by_stride[level + rung], level)
            if known
            else np.full_like(gathered(by_stride[0], level), np.inf)
        )
    return np.stack(rungs, axis=-1)


def gathered(values: npt.NDArray[Any], level: int) -> npt.NDArray[Any]:
    """Return the largest of each square of 2^level x 2^level values, NaN left aside."""
    for axis in (0, 1):
        edges = np.arange(0, values.shape[axis], 1 << level)
        values = np.fmax.reduceat(values, edges, axis=axis)
    return values


def _between(lattice: Samples, stride: int, columns: int) -> Samples:
    """Return the lines of a lattice at all columns."""
    rows, points = lattice.shape
    steps = np.diff(lattice, axis=1)
    lines = np.empty((rows, points - 1, stride), np.float32)
    for place in range(stride):
        between = lines[:, :, place]
        np.multiply(steps, np.float32(place / stride), out=between)
        between += lattice[:, :-1]
    inner = lines.reshape(rows, -1)
    if columns <= inner.shape[1]:
        return inner[:, :columns]
    return np.concatenate([inner, lattice[:, -1:]], axis=1)


def _squares(values: Samples) -> Errors:
    """Return the largest of the values in squares of `NODE` cells, borders included."""
    rows, columns = values.shape
    down, across = np.arange(0, rows - 1, NODE), np.arange(0, columns - 1, NODE)
    lines = np.stack([values[top : top + NODE + 1].max(axis=0) for top in down])
    within = np.maximum.reduceat(lines[:, :-1], across, axis=1)
    east = lines[:, np.minimum(across + NODE, columns - 1)]
    found: Errors = np.maximum(within, east)
    return found


def _largest(heights: Samples) -> float:
    """Return the largest height or depth, 0 where there is no data."""
    high, low = np.fmax.reduce(heights, axis=None), np.fmin.reduce(heights, axis=None)
    return float(np.fmax(np.fmax(high, -low), 0.0))
