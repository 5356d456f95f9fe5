"""Factors of quad patches, by the formulas for the edges of curved meshes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..arguments import positive
from ..camera.camera import Camera
from ..device.device import Device
from ..mesh.mesh import Mesh
from .adjacency import Adjacency
from .patch_factors import MAX_FACTOR, EdgeFactor
from .patched_mesh import unit_normals
from .pn import DevicePatchMesh, edge_factors_on_device
from .smooth import diagonal_of, view_for

# edges in the tessellator's order, u = 0, v = 0, u = 1, v = 1: among the six of the two triangles
# 0 1 2 and 0 2 3 of a quad's corners, each of whose edges lies opposite a corner
_EDGES = [4, 2, 0, 3]
_HALVES = [(0, 1, 2), (0, 2, 3)]


def quad_factors(
    nets: npt.NDArray[np.float32],
    normals: npt.NDArray[np.float64],
    factor: float | None,
    lod: EdgeFactor | None,
    camera: Camera | None,
    device: Device,
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Return the factors of edges (P, 4) and insides (P, 2) of bicubic patches.

    A formula is asked about the polygons of the patches' corners, once an edge; insides are as fine
    as the finer of the edges beside them.

    Parameters
    ----------
    nets : (P, 4, 4, 3) float32
    normals : (P, 4, 3)
        At the corners, from u = v = 0 counter-clockwise.
    factor, lod, camera
        As for :func:`terrain_lod.pn_triangles`.
    device : Device

    Raises
    ------
    InputError
        If there are both a factor and a formula, a factor is not positive, or a camera is missing.
    """
    corners = nets[:, [0, 3, 3, 0], [0, 0, 3, 3]].reshape(-1, 3)
    first = 4 * np.arange(len(nets), dtype=np.int32)[:, None]
    halves = (first + np.array(_HALVES, np.int32).ravel()).reshape(-1, 3)
    mesh = Mesh(corners, unit_normals(normals.reshape(-1, 3).astype(np.float32)), halves)
    view = view_for(mesh, factor, lod, camera)
    if lod is None or not len(nets):
        alike = min(positive("factor", 5.0 if factor is None else factor), MAX_FACTOR)
        edges, insides = (np.full((len(nets), width), alike, np.float32) for width in (4, 2))
        return edges, insides
    adjacency = Adjacency.of(mesh)
    uploaded = DevicePatchMesh.upload(mesh.vertices, mesh.normals, adjacency, device)
    found = edge_factors_on_device(uploaded, lod, diagonal_of(mesh), view).host()
    edges = found[adjacency.edges.reshape(-1, 6)[:, _EDGES]]
    return edges, np.stack([edges[:, 1::2].max(axis=1), edges[:, ::2].max(axis=1)], axis=1)
