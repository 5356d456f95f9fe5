"""Heights and rays against a mesh in float64: ``kernels/mesh/queries.cl``.

Every triangle is tried, with barycentric weights from determinants (Möller, Trumbore, "Fast,
minimum storage ray/triangle intersection", Journal of Graphics Tools 2(1), 1997), whereas the
kernel looks into bins and shears.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...mesh.mesh import Mesh

Array = npt.NDArray[np.float64]

# share of a triangle by which a point may be outside: the triangles beside it find it as well
_SLACK = 1e-10


def heights(mesh: Mesh, points: Array) -> Array:
    """Return the highest elevation at world points (N, 2); NaN where there is none."""
    above = np.column_stack([points, np.full(len(points), mesh.origin[2])])
    corners = mesh.vertices.astype(np.float64)[mesh.triangles]
    found = np.full(len(points), -np.inf)
    for i, point in enumerate(above - mesh.origin):
        t = _along(corners, point, np.array([0.0, 0.0, 1.0]))
        found[i] = np.nanmax(t, initial=-np.inf)
    return np.where(np.isinf(found), np.nan, found + mesh.origin[2])


def distances(mesh: Mesh, origins: Array, directions: Array) -> Array:
    """Return how far along unit `directions` each ray first meets a triangle; NaN where none."""
    corners = mesh.vertices.astype(np.float64)[mesh.triangles]
    found = np.full(len(origins), np.inf)
    for i, (origin, direction) in enumerate(zip(origins - mesh.origin, directions, strict=True)):
        t = _along(corners, origin, direction)
        found[i] = np.min(t[t >= 0], initial=np.inf)
    return np.where(np.isinf(found), np.nan, found)


def _along(corners: Array, origin: Array, direction: Array) -> Array:
    """Return where the line passes each triangle (T, 3, 3), NaN where it does not."""
    a, b, c = np.moveaxis(corners, 1, 0)
    edge1, edge2 = b - a, c - a
    across = np.cross(direction, edge2)
    determinant = (edge1 * across).sum(axis=1)
    with np.errstate(invalid="ignore", divide="ignore"):
        u = ((origin - a) * across).sum(axis=1) / determinant
        turned = np.cross(origin - a, edge1)
        v = (turned @ direction) / determinant
        t = (turned * edge2).sum(axis=1) / determinant
        inside = (u >= -_SLACK) & (v >= -_SLACK) & (u + v <= 1 + _SLACK)
    return np.where(inside & (determinant != 0), t, np.nan)
