"""Meshes taller than they are: what files and pictures of exaggerated ground show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arguments import positive
from .mesh import Mesh


def stretched(mesh: Mesh, exaggeration: float) -> Mesh:
    """Return a mesh whose heights are so many times as high, sea level staying where it is.

    Parameters
    ----------
    mesh : Mesh
    exaggeration : float
        Above 0.

    Returns
    -------
    Mesh
        What was achieved is not said of it any more: errors are of the true mesh.

    Raises
    ------
    InputError
        If the exaggeration is not above 0.
    """
    factor = positive("exaggeration", exaggeration)
    if factor == 1:
        return mesh
    scale = np.array([1.0, 1.0, factor])
    normals = mesh.normals / scale
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    return replace(
        mesh,
        vertices=mesh.vertices * scale,
        normals=normals.astype(np.float32),
        origin=mesh.origin * scale,
        achieved=None,
    )
