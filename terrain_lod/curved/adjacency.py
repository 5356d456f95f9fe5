r"""Which triangles of a mesh meet at which edge: patches of 12 indices.

Vertices at the same position, bit for bit, are taken as one, so that an edge has its two sides
whether or not they share vertices. Edge k of a triangle lies opposite its corner k and runs from
corner k + 1 to corner k + 2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..device.layout import PATCH_ADJACENT, PATCH_DOMINANT, PATCH_INDICES
from ..mesh.mesh import Mesh
from ..mesh.open_edges import weld

Indices = npt.NDArray[np.int32]

# ends of edges 0, 1, 2 among a triangle's corners
EDGE_ENDS = np.array([[1, 2], [2, 0], [0, 1]])


@dataclass(frozen=True, eq=False)
class Adjacency:
    """T triangles as patches, and their E different edges.

    Attributes
    ----------
    patches : (T, 12) int32
        Vertices of the mesh:

        - 0 1 2: the corners
        - 3 4: the ends of edge 0, as the neighbour there has them
        - 5 6: of edge 1
        - 7 8: of edge 2
        - 9 10 11: the dominant corners: of all vertices at the corner's position, the first

        On the outline the neighbour is the triangle itself. Where three or more triangles meet
        that do not all have the same normals at the edge, none can speak for the others: -1.
    edges : (T, 3) int32
        Number of each triangle's edges 0, 1, 2 among all.
    sides : (E, 2) int32
        Two of the places in `edges`, flattened, where the edge occurs; the same one twice on the
        outline.

    Notes
    -----
    J. McDonald, M. Kilgard: *Crack-Free Point-Normal Triangles Using Adjacent Edge Normals*,
    NVIDIA 2010.
    """

    patches: Indices
    edges: Indices
    sides: Indices

    @classmethod
    def of(cls, mesh: Mesh) -> Adjacency:
        """Return the adjacency of a sound mesh."""
        points = weld(mesh.vertices)
        # (T, 3 edges, 2 ends): by vertex, by position
        ends = mesh.triangles[:, EDGE_ENDS]
        welded = points[ends].reshape(-1, 2)
        order = np.sort(welded, axis=1)
        _, first, edges, uses = np.unique(
            order[:, 0] * (points.max(initial=0) + 1) + order[:, 1],
            return_index=True,
            return_inverse=True,
            return_counts=True,
        )
        # the last place of each edge; of two, the other one
        last = np.zeros_like(first)
        last[edges] = np.arange(len(edges))
        other = np.where(last[edges] == np.arange(len(edges)), first[edges], last[edges])
        # the other side's ends in this side's order
        flat = ends.reshape(-1, 2)
        same_way = welded[other, 0] == welded[:, 0]
        adjacent = np.where(same_way[:, None], flat[other], flat[other][:, ::-1])
        adjacent[_disagreeing(mesh, flat, welded, edges, uses)] = -1

        patches = np.empty((len(mesh.triangles), PATCH_INDICES), np.int32)
        patches[:, :PATCH_ADJACENT] = mesh.triangles
        patches[:, PATCH_ADJACENT:PATCH_DOMINANT] = adjacent.reshape(-1, 6)
        _, dominant = np.unique(points, return_index=True)
        patches[:, PATCH_DOMINANT:] = dominant[points[mesh.triangles]]
        return cls(
            patches,
            edges.reshape(-1, 3).astype(np.int32),
            np.stack([first, last], axis=1).astype(np.int32),
        )

    def without_neighbours(self) -> Adjacency:
        """Return the same edges, with each triangle as its own neighbour: plain PN-triangles."""
        patches = self.patches.copy()
        own = patches[:, :PATCH_ADJACENT][:, EDGE_ENDS]
        patches[:, PATCH_ADJACENT:PATCH_DOMINANT] = own.reshape(-1, 6)
        return Adjacency(patches, self.edges, self.sides)


def _disagreeing(
    mesh: Mesh,
    ends: Indices,
    welded: npt.NDArray[np.int64],
    edges: npt.NDArray[np.int64],
    uses: npt.NDArray[np.int64],
) -> npt.NDArray[np.bool_]:
    """Return True for the places of edges that many use, but not all with the same normals."""
    crowded = np.flatnonzero(uses[edges] > 2)
    found = np.zeros(len(edges), bool)
    if not len(crowded):
        return found
    # normals in the order of the edge's lower end
    kinds = weld(mesh.normals)[ends[crowded]]
    falls = welded[crowded, 0] > welded[crowded, 1]
    kinds[falls] = kinds[falls, ::-1]
    order = np.argsort(edges[crowded], kind="stable")
    group, kinds = edges[crowded][order], kinds[order]
    differs = (group[1:] == group[:-1]) & (kinds[1:] != kinds[:-1]).any(axis=1)
    found[np.isin(edges, group[1:][differs])] = True
    return found
