r"""Which edges of a mesh have no partner? Welding and pairing.

Vertices of the same position are one; a triangle that then has two equal corners, or repeats
another, is left out. What remains is a set of directed edges, and in a closed surface every one
meets its opposite:

::

        c             each triangle's edges run counter-clockwise, so two neighbours run along
       / \            their common edge in opposite directions: a -> b of this triangle wants
      /   \           b -> a of another; without one, it is open
     a --- b
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

Indices = npt.NDArray[np.int64]

# how often an edge is used from its lower end to its higher, and the other way, in one number
_FORTH: Final = 1
_BACK: Final = 1 << 15


@dataclass(frozen=True, eq=False)
class Topology:
    """A welded mesh and the edges in it whose two directions do not cancel.

    Attributes
    ----------
    triangles : (T, 3) int64
        Corners among the welded points, without repetitions.
    open_edges : (E, 2) int64
        Start and end of the edges used once, along their triangles.
    open_apexes : (E,) int64
        The third corner of each one's triangle.
    unbalanced : int
        Edges used several times, but not as often one way as the other.
    left_out : int
        Triangles with two equal corners, and repetitions.
    """

    triangles: Indices
    open_edges: Indices
    open_apexes: Indices
    unbalanced: int
    left_out: int


def weld(positions: npt.NDArray[np.float32]) -> Indices:
    """Return the same number for vertices at the same position, bit for bit; 0 and -0 are equal.

    Parameters
    ----------
    positions : (V, 2) or (V, 3) float32

    Returns
    -------
    (V,) int64
        From 0, without gaps.
    """
    bits = (positions + np.float32(0)).view(np.uint32)
    numbers = _numbered(bits[:, 0], bits[:, 1])
    return numbers if bits.shape[1] == 2 else _numbered(numbers, bits[:, 2])


def _numbered(high: npt.NDArray[Any], low: npt.NDArray[Any]) -> Indices:
    """Return the rank of each pair of 32-bit numbers among the different ones."""
    pairs = high.astype(np.uint64) << np.uint64(32) | low.astype(np.uint64)
    numbers: Indices = np.unique(pairs, return_inverse=True)[1].astype(np.int64)
    return numbers


def topology(triangles: Indices) -> Topology:
    """Pair the edges of (T, 3) welded `triangles`."""
    a, b, c = triangles.T
    proper = triangles[(a != b) & (b != c) & (c != a)]
    singles, others = _unpaired(proper)
    if len(others):
        # a repeated triangle shows in its edges
        proper = _without_repetitions(proper, others)
        singles, others = _unpaired(proper)
    return Topology(
        triangles=proper,
        open_edges=singles,
        open_apexes=_apexes(proper, singles),
        unbalanced=len(others),
        left_out=len(triangles) - len(proper),
    )


def _unpaired(triangles: Indices) -> tuple[Indices, Indices]:
    """Return the directed edges used once, and those used oftener in ways that do not cancel."""
    from scipy.sparse import coo_array

    start = triangles.ravel()
    end = np.roll(triangles, -1, axis=1).ravel()
    count = int(triangles.max(initial=-1)) + 1
    # a sparse matrix sums equal edges faster than any sort
    uses = coo_array(
        (
            np.where(start < end, np.int32(_FORTH), np.int32(_BACK)),
            (np.minimum(start, end), np.maximum(start, end)),
        ),
        shape=(count, count),
    ).tocsr()
    unpaired = np.flatnonzero(uses.data != _FORTH + _BACK)
    kinds = uses.data[unpaired]
    # twice each way is four triangles about an edge: closed
    unbalanced = kinds % _BACK != kinds // _BACK
    unpaired, kinds = unpaired[unbalanced], kinds[unbalanced]
    low = np.searchsorted(uses.indptr, unpaired, side="right") - 1
    edges = np.stack([low, uses.indices[unpaired]], axis=1).astype(np.int64)
    edges[kinds == _BACK] = edges[kinds == _BACK, ::-1]
    once = (kinds == _FORTH) | (kinds == _BACK)
    return edges[once], edges[~once]


def _without_repetitions(triangles: Indices, edges: Indices) -> Indices:
    """Drop triangles at `edges` that repeat another's corners in the same direction."""
    suspects = np.flatnonzero(_at(triangles, edges).all(axis=1))
    # the smallest corner to the front
    turn = np.argmin(triangles[suspects], axis=1)[:, None] + np.arange(3)
    a, b, c = np.take_along_axis(triangles[suspects], turn % 3, axis=1).T
    repeated = np.ones(len(suspects), bool)
    repeated[np.unique(_numbered(_numbered(a, b), c), return_index=True)[1]] = False
    return np.delete(triangles, suspects[repeated], axis=0)


def _at(triangles: Indices, edges: Indices) -> npt.NDArray[np.bool_]:
    """Return which corners of the triangles are ends of `edges`; (T, 3)."""
    is_end = np.zeros(int(triangles.max(initial=-1)) + 1, np.bool_)
    is_end[edges] = True
    corners: npt.NDArray[np.bool_] = is_end[triangles]
    return corners


def _apexes(triangles: Indices, singles: Indices) -> Indices:
    """Return the third corner of the triangle at each of the directed edges `singles`."""
    near = triangles[_at(triangles, singles).sum(axis=1) > 1]
    start, end, apex = (np.roll(near, -turn, axis=1).ravel() for turn in range(3))
    keys = start << 32 | end
    order = np.argsort(keys)
    wanted = singles[:, 0] << 32 | singles[:, 1]
    return np.asarray(apex[order[np.searchsorted(keys, wanted, sorter=order)]])
