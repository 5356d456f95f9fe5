"""Can a mesh's triangles be followed at all? Asked before anything is computed from them."""

from __future__ import annotations

import numpy as np

from .errors import InputError
from .mesh import Mesh


def require_sound(mesh: Mesh, what: str = "a mesh") -> None:
    """Refuse positions that are not finite, and corners that are no vertices.

    Raises
    ------
    InputError
        Names the first such vertex or triangle.
    """
    finite = np.isfinite(mesh.vertices)
    if not finite.all():
        vertex = int(np.argmin(finite.all(axis=1)))
        position = ", ".join(f"{value:g}" for value in mesh.vertices[vertex])
        raise InputError(
            f"expected {what} of finite positions, got ({position}) at vertex {vertex}"
        )
    count = len(mesh.vertices)
    if mesh.triangles.size and not 0 <= mesh.triangles.min() <= mesh.triangles.max() < count:
        outside = ((mesh.triangles < 0) | (mesh.triangles >= count)).any(axis=1)
        triangle = int(np.argmax(outside))
        raise InputError(
            f"expected {what} whose corners are among its {count} vertices, "
            f"got {mesh.triangles[triangle].tolist()} at triangle {triangle}"
        )
