r"""Where do open edges face each other? Nodes on edges, and pieces that run both ways.

::

        \     \     \     /
    <----*-----*-----*-----    three edges of the triangles above, right to left
    ----------*----------->    two of the triangles below, left to right

        1 --> 2 -> 3 --> 4     cut at the nodes, both run through the same pieces

Ends of open edges that nearly coincide are one *node*; a node that lies on an open edge cuts it;
and a piece that runs from node to node one way on one edge and the other way on another has the
mesh at both sides. What is far enough apart to be an outline stays unopposed.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from ..mesh.open_edges import Indices, weld

# ends meet within this part of an open edge's length, and of its triangle's height over it
REACH: Final = 0.25
# coordinates are known to this part of the largest
ROUNDING: Final = 2.0**-22
# edges seen from above that are so much longer along one axis are measured in its own unit
_OBLONG: Final = 16.0

Array = npt.NDArray[np.float64]


class Pieces(NamedTuple):
    """Pieces of open edges, K of them, each opposite to a piece of another.

    Attributes
    ----------
    edge : (K,) int64
        Number of the open edge.
    gap : (K,) float64
        Distance to the other side, the larger of both ends.
    node : (K,) int64
        Number of the node where that is.
    point : (K, 3) float64
        And its place.
    t_junctions : int
        Nodes that cut an edge where such pieces meet.
    """

    edge: Indices
    gap: Array
    node: Indices
    point: Array
    t_junctions: int

    def joined_by(self, edges: Indices, middles: Array) -> Pieces:
        """Return these pieces and whole `edges` that have no other side."""
        return Pieces(
            np.append(self.edge, edges),
            np.append(self.gap, np.full(len(edges), np.inf)),
            np.append(self.node, -1 - edges),
            np.append(self.point, middles, axis=0),
            self.t_junctions,
        )


def opposed_pieces(starts: Array, ends: Array, apexes: Array, *, from_above: bool) -> Pieces:
    """Cut open edges at the nodes on them and return the pieces that another edge runs back.

    Parameters
    ----------
    starts, ends : (E, 3) float64
        Of each open edge, its triangle on the left.
    apexes : (E, 3) float64
        The third corners of these triangles.
    from_above : bool
        Compare x and y only.
    """
    count = len(starts)
    if not count:
        none = np.zeros(0, np.int64)
        return Pieces(none, np.zeros(0), none, np.zeros((0, 3)), 0)
    seen = [array[:, :2] * _units(starts, ends) if from_above else array
            for array in (starts, ends, apexes)]  # fmt: skip
    ground_plan = _Plan.of(*seen)
    cut_edge, cut_node, cut_at = ground_plan.cuts()

    # stops along each edge: its start, the cuts, its end
    edge = np.concatenate([np.arange(count), cut_edge, np.arange(count)])
    node = np.concatenate([ground_plan.start_nodes, cut_node, ground_plan.end_nodes])
    at = np.concatenate([np.zeros(count), cut_at, np.ones(count)])
    order = np.lexsort([at, edge])
    edge, node, at = edge[order], node[order], at[order]
    is_cut = (order >= count) & (order < count + len(cut_edge))
    stop = (1 - at)[:, None] * starts[edge] + at[:, None] * ends[edge]

    # a piece runs from a stop to the next; another runs back
    begin = np.flatnonzero((edge[1:] == edge[:-1]) & (node[1:] != node[:-1]))
    other = _partners(node[begin], node[begin + 1])
    begin, other = begin[other >= 0], begin[other[other >= 0]]
    gaps = np.stack(
        [
            np.linalg.norm(stop[begin] - stop[other + 1], axis=1),
            np.linalg.norm(stop[begin + 1] - stop[other], axis=1),
        ]
    )
    wider = begin + np.argmax(gaps, axis=0)
    t_junctions = int(np.count_nonzero(is_cut[np.unique([begin, begin + 1])]))
    return Pieces(edge[begin], gaps.max(axis=0), node[wider], stop[wider], t_junctions)


def _units(starts: Array, ends: Array) -> Array:
    """Return powers of two that bring edges along x and y to like lengths, where they differ much.

    Else what rounding leaves of the one would be as long as the other.
    """
    longest = abs(ends - starts)[:, :2].max(axis=0)
    if not longest.all() or longest.max() <= _OBLONG * longest.min():
        return np.ones(2)
    return np.asarray(2.0 ** -np.round(np.log2(longest)))


def _partners(first: Indices, last: Indices) -> Indices:
    """Return for each piece one that runs from its last node to its first, or -1."""
    forth, back = first << 32 | last, last << 32 | first
    order = np.argsort(forth)
    place = np.searchsorted(forth, back, sorter=order)
    partner = order[np.minimum(place, len(order) - 1)] if len(order) else order
    return np.where(forth[partner] == back, partner, -1)


@dataclass(frozen=True, eq=False)
class _Plan:
    """E open edges in D dimensions, and the S different spots where they end.

    Attributes
    ----------
    starts, ends : (E, D) float64
    reach : (E,) float64
        How near something counts as on the edge.
    start_nodes, end_nodes : (E,) int64
    spots : (S, D) float64
    spot_reach : (S,) float64
        The least of the edges that end there.
    nodes : (S,) int64
        The same for spots within reach of each other.
    """

    starts: Array
    ends: Array
    reach: Array
    start_nodes: Indices
    end_nodes: Indices
    spots: Array
    spot_reach: Array
    nodes: Indices

    @classmethod
    def of(cls, starts: Array, ends: Array, apexes: Array) -> _Plan:
        """Return the plan of edges whose triangles have their third corners at `apexes`."""
        both = np.concatenate([starts, ends])
        spot = weld(both.astype(np.float32))
        spots = np.empty((int(spot.max()) + 1, both.shape[1]))
        spots[spot] = both
        reach = _reach(starts, ends, apexes)
        spot_reach = np.full(len(spots), np.inf)
        np.minimum.at(spot_reach, spot, np.tile(reach, 2))
        nodes = _nodes(spots, spot_reach)
        start_nodes, end_nodes = nodes[spot].reshape(2, -1)
        return cls(starts, ends, reach, start_nodes, end_nodes, spots, spot_reach, nodes)

    def cuts(self) -> tuple[Indices, Indices, Array]:
        """Return edge, node and place along the edge (0..1) of the nodes that lie on an edge."""
        edge, spot = _near_pairs(self.starts, self.ends, self.spots)
        along = self.ends[edge] - self.starts[edge]
        offset = self.spots[spot] - self.starts[edge]
        at = (offset * along).sum(axis=1) / (along * along).sum(axis=1)
        distance = np.linalg.norm(offset - at[:, None] * along, axis=1)
        node = self.nodes[spot]
        chosen = (at > 0) & (at < 1) & (distance <= self.reach[edge])
        chosen &= distance <= self.spot_reach[spot]
        chosen &= (node != self.start_nodes[edge]) & (node != self.end_nodes[edge])
        edge, node, at = edge[chosen], node[chosen], at[chosen]
        # a node cuts an edge once
        _, first = np.unique(edge << 32 | node, return_index=True)
        return edge[first], node[first], at[first]


def _reach(starts: Array, ends: Array, apexes: Array) -> Array:
    """Return how near another end counts as on each open edge; (E,)."""
    along, aside = ends - starts, apexes - starts
    length = np.linalg.norm(along, axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        foot = (along * aside).sum(axis=1) / (length * length)
        height = np.linalg.norm(aside - foot[:, None] * along, axis=1)
    reach = REACH * np.fmin(np.minimum(length, length.mean()), height)
    return np.asarray(np.maximum(reach, ROUNDING * max(abs(starts).max(), abs(ends).max())))


def _nodes(spots: Array, reach: Array) -> Indices:
    """Return the same number for spots that are within each other's reach; (S,)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    count = len(spots)
    # reach is short: few spots are within it, and a chain of them is one node
    found = cKDTree(spots).query(spots, k=5, distance_upper_bound=2 * reach.max())
    distances, neighbours = np.asarray(found[0]), np.asarray(found[1])
    spot, column = np.nonzero(neighbours < count)
    distance, neighbour = distances[spot, column], neighbours[spot, column]
    near = distance <= np.minimum(reach[spot], reach[neighbour])
    links = coo_array(
        (np.ones(np.count_nonzero(near), np.int8), (spot[near], neighbour[near])),
        shape=(count, count),
    )
    _, nodes = connected_components(links, directed=False)
    return np.asarray(nodes, np.int64)


def _near_pairs(starts: Array, ends: Array, spots: Array) -> tuple[Indices, Indices]:
    """Return pairs of an edge and a spot that may lie on it; each (N,)."""
    from scipy.spatial import cKDTree

    length = np.linalg.norm(ends - starts, axis=1)
    # edges longer than the mean in pieces: these are at most one an edge more
    pieces = np.ceil(length / max(length.mean(), np.finfo(float).tiny)).astype(np.int64)
    edge = np.repeat(np.arange(len(length)), pieces)
    number = np.arange(len(edge)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    middle = starts[edge] + ((number + 0.5) / pieces[edge])[:, None] * (ends - starts)[edge]
    # by size, so that short pieces look at few spots: an octave of lengths at a time
    octave = np.frexp(length[edge] / pieces[edge])[1]
    tree = cKDTree(spots)
    found: list[tuple[Indices, Indices]] = [(np.zeros(0, np.int64), np.zeros(0, np.int64))]
    for exponent in np.unique(octave):
        members = np.flatnonzero(octave == exponent)
        # half the piece, and the reach of its edge
        radius = (0.5 + REACH) * 2.0 ** float(exponent)
        pairs = cKDTree(middle[members]).sparse_distance_matrix(tree, radius, output_type="ndarray")
        found.append((edge[members[pairs["i"]]], pairs["j"].astype(np.int64)))
    edges, near = zip(*found, strict=True)
    return np.concatenate(edges), np.concatenate(near)
