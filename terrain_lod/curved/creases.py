"""Sharp edges from angles: vertices split where faces meet at too much of one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from ..arguments import finite
from ..errors import InputError
from ..mesh.mesh import Mesh
from ..mesh.normals import vertex_normals
from ..mesh.open_edges import weld
from ..mesh.soundness import sound_mesh
from .adjacency import EDGE_ENDS, Adjacency


def split_at_creases(mesh: Mesh, degrees: float) -> Mesh:
    r"""Return the mesh with vertices of its own for every smooth part around a vertex.

    ::

         \  2  /         faces 1 | 2 | 3 meet at more than the angle at both thick edges, so the
       1  \   /  3       vertex becomes two: one for face 2, one for the rest, whose faces are
     ______\ /______     joined below it

    Normals are computed anew: the mean of the faces of the part, weighted by area. Where an edge
    has three faces or more, each is a part of its own.

    Parameters
    ----------
    mesh : Mesh
        Sound.
    degrees : float
        Angle between the normals of two faces above which their common edge is sharp, 0 to 180.

    Raises
    ------
    InputError
        If the angle is not from 0 to 180.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    mesh, degrees = sound_mesh(mesh), finite("degrees", degrees)
    if not 0 <= degrees <= 180:
        raise InputError(f"expected an angle from 0 to 180 degrees, got {degrees:g}")
    adjacency = Adjacency.of(mesh)
    places = _smooth_edges(mesh, adjacency, np.cos(np.radians(degrees)))
    # corners at the same position, on both sides of a smooth edge, are one vertex
    points = weld(mesh.vertices)[mesh.triangles]
    triangles, ends = places // 3, EDGE_ENDS[places % 3]
    one, other = (3 * triangles[:, side, None] + ends[:, side] for side in (0, 1))
    crossed = points.ravel()[one[:, 0]] != points.ravel()[other[:, 0]]
    other[crossed] = other[crossed, ::-1]
    corners = mesh.triangles.size
    joined = coo_array(
        (np.ones(one.size, np.int8), (one.ravel(), other.ravel())), shape=(corners, corners)
    )
    count, part = connected_components(joined, directed=False)
    vertices = np.empty((count, 3), np.float32)
    vertices[part] = mesh.vertices[mesh.triangles.ravel()]
    split = part.reshape(-1, 3).astype(np.int32)
    normals = vertex_normals(vertices, split).astype(np.float32)
    # vertices become one across seams of textures, too
    return replace(
        mesh, vertices=vertices, normals=normals, triangles=split, patches=None, textures=None
    )


def _smooth_edges(mesh: Mesh, adjacency: Adjacency, least_cosine: float) -> npt.NDArray[np.int64]:
    """Return the two places of edges of two faces that meet at no more than an angle; (S, 2)."""
    uses = np.bincount(adjacency.edges.ravel(), minlength=len(adjacency.sides))
    sides = adjacency.sides[uses == 2].astype(np.int64)
    a, b, c = (mesh.vertices[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    across = np.cross(b - a, c - a)
    first, second = across[sides[:, 0] // 3], across[sides[:, 1] // 3]
    cosines = np.einsum("ij,ij->i", first, second)
    lengths = np.linalg.norm(first, axis=1) * np.linalg.norm(second, axis=1)
    # a face without an area meets nothing at an angle
    smooth: npt.NDArray[np.int64] = sides[cosines >= least_cosine * lengths]
    return smooth
