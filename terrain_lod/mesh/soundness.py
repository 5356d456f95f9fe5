"""Can a mesh's triangles be followed at all? Asked before anything is computed from them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ..arguments import instance
from ..errors import InputError
from .mesh import Mesh


def sound_mesh(mesh: object) -> Mesh:
    """Return `mesh` if it is one, of finite positions and corners that are vertices.

    Raises
    ------
    InputError
        See :func:`require_sound`.
    """
    made = instance("a Mesh", mesh, Mesh)
    require_sound(made.vertices, made.triangles)
    return made


def require_sound(
    vertices: npt.NDArray[np.floating[Any]],
    triangles: npt.NDArray[np.integer[Any]],
    what: str = "a mesh",
) -> None:
    """Refuse positions that are not finite, and corners that are no vertices.

    Parameters
    ----------
    vertices : (V, 3) array of float
    triangles : (T, 3) array of int
    what : str, optional
        What the message calls them.

    Raises
    ------
    InputError
        Names the first such vertex or triangle.
    """
    finite = np.isfinite(vertices)
    if not finite.all():
        vertex = int(np.argmin(finite.all(axis=1)))
        position = ", ".join(f"{value:g}" for value in vertices[vertex])
        raise InputError(
            f"expected {what} of finite positions, got ({position}) at vertex {vertex}"
        )
    count = len(vertices)
    if triangles.size and not 0 <= triangles.min() <= triangles.max() < count:
        outside = ((triangles < 0) | (triangles >= count)).any(axis=1)
        triangle = int(np.argmax(outside))
        raise InputError(
            f"expected {what} whose corners are among its {count} vertices, "
            f"got {triangles[triangle].tolist()} at triangle {triangle}"
        )
