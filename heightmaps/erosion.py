"""What water and gravity do to ground: rivers that cut, slopes that creep and fall.

Rivers follow the stream power law

    dh/dt = U - K sqrt(A) S,      uplift U, erodibility K, drainage area A, slope S,

solved implicitly from the outlets upwards:
    J. Braun, S. D. Willett, "A very efficient O(n), implicit and parallel method to solve the
    stream power equation governing fluvial incision and landscape evolution", Geomorphology
    180-181, 2013.
A depression spills over its lowest pass:
    G. Cordonnier, B. Bovy, J. Braun, "A versatile, linear complexity algorithm for flow routing
    in topographies with depressions", Earth Surface Dynamics 7, 2019.

Heights are (R, C) in metres. Samples are also numbered row by row, N = R C of them. All of it is
+ - x / and sqrt in a fixed order, so that a ground comes out the same on every machine.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np
import numpy.typing as npt
from scipy.ndimage import distance_transform_edt
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import breadth_first_order, minimum_spanning_tree
from terrain_lod.heightmaps.noise import Field, Random

Index = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]
Window = tuple[slice, slice]

HALF_RING: Final = ((0, 1), (1, 1), (1, 0), (1, -1))
RING: Final = (*HALF_RING, *((-row, -column) for row, column in HALF_RING))
# the ring and the knight's moves around it
STAR: Final = (*RING, *((r, c) for r, c in product((-2, -1, 1, 2), repeat=2) if abs(r) != abs(c)))


@dataclass(frozen=True)
class Flow:
    """Where water goes: what each sample drains to, and an order to walk the samples in."""

    receiver: Index  # (N,), the sample itself at an outlet
    distance: Field  # (N,), cells to the receiver; 1 at an outlet
    levels: list[Index]  # samples by the number of steps to their outlet, the outlets first


def evolve(
    height: Field,
    outlet: Mask,
    random: Random,
    settle: Callable[[Field], Field],
    *,
    cell: float,
    steps: int,
    years: float,
    uplift: float | Field = 0.0,
    erodibility: float | Field = 4e-6,
    inflow: float | Field = 0.0,
) -> tuple[Field, Field]:
    """Return the ground after `steps` steps of `years` each, and its drainage area; 2 x (R, C).

    `uplift` is in metres a year, `erodibility` per year, `inflow` in square metres of drainage
    area from beyond the border, `cell` in metres. `settle` is what the slopes do after each step.
    """
    area = np.zeros(height.shape)
    for step in range(steps):
        # rivers wander a little, not every year
        if step % 4 == 0:
            jitter = random.uniform(*height.shape)
        flow = route(height, outlet, jitter)
        area = drainage(flow, np.full(height.shape, cell * cell) + inflow)
        raised = np.where(outlet, height, height + uplift * years)
        height = settle(incised(raised, flow, erodibility * years * np.sqrt(area) / cell))
    return height, area


def route(height: Field, outlet: Mask, jitter: Field) -> Flow:
    """Return how water flows over `height` to the samples where `outlet` is True."""
    receiver = _steepest(height, jitter)
    numbers = np.arange(height.size)
    receiver[outlet.ravel()] = numbers[outlet.ravel()]
    receiver = _spilled(height, receiver, outlet.ravel())
    # length of each step, in cells
    columns = height.shape[1]
    down, along = numbers // columns - receiver // columns, numbers % columns - receiver % columns
    distance = np.sqrt((down * down + along * along).astype(np.float64))
    distance[receiver == numbers] = 1.0
    # steps to the outlet, the stride doubled until all have arrived
    depth, ahead = (receiver != numbers).astype(np.int64), receiver
    while not np.array_equal(ahead, ahead[ahead]):
        depth, ahead = depth + depth[ahead], ahead[ahead]
    order = np.argsort(depth, kind="stable")
    return Flow(receiver, distance, np.split(order, np.cumsum(np.bincount(depth))[:-1]))


def drainage(flow: Flow, rain: Field) -> Field:
    """Return how much of `rain` passes through each sample; both (R, C)."""
    area = rain.ravel().copy()
    for level in flow.levels[:0:-1]:
        np.add.at(area, flow.receiver[level], area[level])
    return area.reshape(rain.shape)


def incised(height: Field, flow: Flow, strength: Field) -> Field:
    """Return `height` after one implicit step of rivers cutting down.

    With f = `strength` / distance each sample solves h = (h + f h_receiver) / (1 + f), the outlets
    first. A sample below its receiver, the floor of a depression, stays as it is.
    """
    result, factor = height.ravel().copy(), strength.ravel() / flow.distance
    for level in flow.levels[1:]:
        here, below, f = result[level], result[flow.receiver[level]], factor[level]
        result[level] = np.where(below < here, (here + f * below) / (1 + f), here)
    return result.reshape(height.shape)


def crept(height: Field, amount: float, steps: int = 1) -> Field:
    """Return `height` diffused: each step moves `amount`, at most 1/4, of the Laplacian."""
    for _ in range(steps):
        p = np.pad(height, 1, mode="edge")
        around = (p[:-2, 1:-1] + p[2:, 1:-1]) + (p[1:-1, :-2] + p[1:-1, 2:])
        height = height + min(amount, 0.25) * (around - 4 * height)
    return height


def fallen(height: Field, drop: float | Field, steps: int) -> Field:
    """Return `height` lowered until nothing is steeper than `drop` metres per cell.

    The rivers carry the debris away. `steps` cells is how far a slope can reach.
    """
    drop = np.broadcast_to(drop, height.shape)
    for _ in range(steps):
        before, height = height, height.copy()
        for row, column in STAR:
            here, there = _apart(row, column)
            length = float(np.sqrt(row * row + column * column))
            np.minimum(height[here], before[there] + drop[here] * length, out=height[here])
        if np.array_equal(before, height):
            break
    return height


def floodplains(height: Field, area: Field, cell: float, *, width: float, rise: float) -> Field:
    """Return `height` planed by its rivers as they swing from side to side.

    A river's plain reaches `width` sqrt(area) metres to each side, rising by `rise`.
    """
    half_width = width * np.sqrt(area) / cell
    planed = height
    for reach in (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0):
        river = half_width >= reach
        if not river.any():
            break
        away, (row, column) = distance_transform_edt(~river, return_indices=True)
        plain = height[row, column] + rise * cell * away
        planed = np.where(away <= reach, np.minimum(planed, plain), planed)
    return planed


def steepness(height: Field, cell: float) -> Field:
    """Return the slope of `height`, rise over run, from central differences; (R, C)."""
    down, along = np.gradient(height, cell)
    return np.sqrt(down * down + along * along)


def _apart(row: int, column: int) -> tuple[Window, Window]:
    """Return the samples that have a neighbour at that offset, and those neighbours."""
    return (_kept(-row), _kept(-column)), (_kept(row), _kept(column))


def _kept(step: int) -> slice:
    """Return what is left of an axis whose first `step` samples are cut, or last if negative."""
    return slice(step, None) if step > 0 else slice(None, step or None)


def _steepest(height: Field, jitter: Field) -> Index:
    """Return the neighbour that each sample drains to, itself in a pit; (N,).

    Diagonals have a random length of 1 to 2, so that rivers do not favour the directions of the
    grid: J. Fairfield, P. Leymarie, "Drainage networks from grid digital elevation models", Water
    Resources Research 27(5), 1991. `jitter` is 0..1.
    """
    numbers = np.arange(height.size).reshape(height.shape)
    best, receiver = np.zeros(height.shape), numbers.copy()
    for row, column in RING:
        here, there = _apart(row, column)
        slope = height[here] - height[there]
        if row and column:
            slope = slope / (1 + jitter[here])
        better = slope > best[here]
        best[here][better], receiver[here][better] = slope[better], numbers[there][better]
    return receiver.ravel()


def _spilled(height: Field, receiver: Index, outlet: Mask) -> Index:
    """Return `receiver` with each pit drained over the lowest passes to an outlet; (N,)."""
    pits = np.flatnonzero((receiver == np.arange(height.size)) & ~outlet)
    if not len(pits):
        return receiver
    # basin 0 is all that reaches an outlet, basin k what reaches pit k - 1
    basin = np.zeros(height.size, np.int64)
    basin[pits] = np.arange(1, len(pits) + 1)
    root = receiver
    while not np.array_equal(root, root[root]):
        root = root[root]
    basin = basin[root]
    ends = _passes(height, basin)
    # the tree of lowest passes, seen from the outlets; ranks for heights make it unique
    low, high = np.sort(basin[ends], axis=0)
    rank = np.arange(1.0, ends.shape[1] + 1)
    count = len(pits) + 1
    tree = minimum_spanning_tree(coo_matrix((rank, (low, high)), (count, count)).tocsr()).tocoo()
    _, parent = breadth_first_order(tree.tocsr(), 0, directed=False)
    # each pit drains to the far side of the pass to its parent
    receiver = receiver.copy()
    ends = ends[:, tree.data.astype(np.int64) - 1]
    for inner, outer in (ends, ends[::-1]):
        down = parent[basin[inner]] == basin[outer]
        receiver[pits[basin[inner[down]] - 1]] = outer[down]
    return receiver


def _passes(height: Field, basin: Index) -> Index:
    """Return the two samples of the lowest pass between each two basins, lowest first; (2, P)."""
    numbers = np.arange(height.size).reshape(height.shape)
    sides = []
    for row, column in HALF_RING:
        here, there = _apart(row, column)
        side = np.stack([numbers[here].ravel(), numbers[there].ravel()])
        sides.append(side[:, basin[side[0]] != basin[side[1]]])
    ends = np.concatenate(sides, axis=1)
    # a pass is as high as the higher of its sides; ties go to the first in the grid
    ends = ends[:, np.lexsort((ends[1], ends[0], height.ravel()[ends].max(axis=0)))]
    low, high = np.sort(basin[ends], axis=0)
    _, first = np.unique(low * (basin.max() + 1) + high, return_index=True)
    return ends[:, np.sort(first)]
