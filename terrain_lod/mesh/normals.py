"""Normals of a mesh's vertices from its triangles."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt


def vertex_normals(
    points: npt.NDArray[np.floating[Any]], triangles: npt.NDArray[np.int32]
) -> npt.NDArray[np.float64]:
    """Return the mean normal of the triangles around each vertex, weighted by area.

    Parameters
    ----------
    points : (V, 3) array of float
    triangles : (T, 3) int32

    Returns
    -------
    (V, 3) float64
        Unit length; (0, 0, 1) where no triangle with an area is.
    """
    a, b, c = (points[triangles[:, corner]].astype(np.float64) for corner in range(3))
    # twice the area, along the face's normal
    weighted = np.cross(b - a, c - a)
    corners = triangles.ravel()
    normals = np.stack(
        [
            np.bincount(corners, np.repeat(weighted[:, axis], 3), minlength=len(points))
            for axis in range(3)
        ],
        axis=1,
    )
    lengths = np.linalg.norm(normals, axis=1)
    normals[lengths == 0] = 0.0, 0.0, 1.0
    lengths[lengths == 0] = 1.0
    return np.asarray(normals / lengths[:, None])
