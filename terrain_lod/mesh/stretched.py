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
        What is known of its errors is of its own heights, too.

    Raises
    ------
    InputError
        If the exaggeration is not above 0.
    """
    factor = positive("exaggeration", exaggeration)
    if factor == 1:
        return mesh
    scale = np.array([1.0, 1.0, factor])
    normals = mesh.normals / scale.astype(np.float32)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-30)
    achieved = mesh.achieved
    return replace(
        mesh,
        vertices=mesh.vertices * scale.astype(np.float32),
        normals=normals.astype(np.float32),
        origin=mesh.origin * scale,
        achieved=achieved and replace(achieved, metres=achieved.metres * factor),
    )
