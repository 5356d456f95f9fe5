"""Bicubic Bézier patches by de Casteljau's construction, in float64.

Farin: *Curves and Surfaces for CAGD*, sections 4.2 and 14.1.
"""

from __future__ import annotations

from math import comb

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

# how far towards the middle a normal is taken where there is none
_INWARD = 1e-5


def curve(points: Array, t: Array) -> tuple[Array, Array]:
    """Return a cubic's points and first derivatives at `t` (N,); control points (N, 4, 3)."""
    t = t[:, None, None]
    while points.shape[1] > 2:
        points = points[:, :-1] * (1 - t) + points[:, 1:] * t
    slope = 3 * (points[:, 1] - points[:, 0])
    return points[:, 0] * (1 - t[:, 0]) + points[:, 1] * t[:, 0], slope


def curve_of_any_degree(points: Array, t: Array) -> tuple[Array, Array]:
    """Return points and unit tangents at `t` (N,) of curves (N, degree + 1, 3), by Bernstein."""
    degree = points.shape[1] - 1
    bases = [
        np.stack([comb(d, k) * t**k * (1 - t) ** (d - k) for k in range(d + 1)], axis=1)
        for d in (degree, degree - 1)
    ]
    at = np.einsum("nk,nkx->nx", bases[0], points)
    along = np.einsum("nk,nkx->nx", bases[1], np.diff(points, axis=1))
    return at, along / np.linalg.norm(along, axis=1, keepdims=True)


def surface(nets: Array, u: Array, v: Array) -> tuple[Array, Array]:
    """Return positions and dP/du × dP/dv (N, 3) of points of patches (N, 4, 4, 3)."""
    rows = np.stack([curve(nets[:, i], v)[0] for i in range(4)], axis=1)
    columns = np.stack([curve(nets[:, :, j], u)[0] for j in range(4)], axis=1)
    at, along_u = curve(rows, u)
    _, along_v = curve(columns, v)
    return at, np.cross(along_u, along_v)


def field(vectors: Array, u: Array, v: Array) -> Array:
    """Return the vectors of fields (N, I, J, 3) of degrees I - 1 and J - 1 at u and v; (N, 3)."""
    along_u, along_v = (
        np.stack([comb(d, k) * t**k * (1 - t) ** (d - k) for k in range(d + 1)], axis=1)
        for t, d in ((u, vectors.shape[1] - 1), (v, vectors.shape[2] - 1))
    )
    return np.asarray(np.einsum("ni,nj,nijk->nk", along_u, along_v, vectors))


def bezier(nets: Array, u: Array, v: Array) -> tuple[Array, Array]:
    """Return positions and unit normals (N, 3) of points of patches (N, 4, 4, 3).

    Where a patch is collapsed, the normal is that of a point a little further in.
    """
    at, normals = surface(nets, u, v)
    size = np.ptp(nets.reshape(len(nets), -1, 3), axis=1).max(axis=1)
    flat = np.linalg.norm(normals, axis=1) < 1e-9 * size**2
    inward = [x + (0.5 - x) * _INWARD for x in (u[flat], v[flat])]
    normals[flat] = surface(nets[flat], *inward)[1]
    return at, normals / np.linalg.norm(normals, axis=1, keepdims=True)
