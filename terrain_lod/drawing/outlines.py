"""Where patches end: the edges of a mesh that belong to one triangle of their patch."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..mesh.mesh import Mesh


def patch_outlines(mesh: Mesh) -> npt.NDArray[np.int64]:
    """Return the edges around every patch, as pairs of vertices; (L, 2).

    Patches do not share vertices, so that an edge between two of them is there twice.
    """
    corners = mesh.triangles.astype(np.int64)
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]], corners[:, [2, 0]]])
    edges.sort(axis=1)
    keys, counts = np.unique(edges[:, 0] * len(mesh.vertices) + edges[:, 1], return_counts=True)
    return np.stack(np.divmod(keys[counts == 1], len(mesh.vertices)), axis=1)
