"""Which PN-triangles cannot be seen, in float64: what ``kernels/pn_cull.h`` decides."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import numpy.typing as npt

from .pn import CUBIC

Array = npt.NDArray[np.float64]


def _tangents(controls: Array) -> tuple[list[Array], list[Array]]:
    """Return the six control vectors of the derivative along u and along v, both against w."""
    place = {power: index for index, power in enumerate(CUBIC)}
    across, along = [], []
    for i, j, k in product(range(3), repeat=3):
        if i + j + k == 2:
            origin = controls[place[i, j, k + 1]]
            across.append(controls[place[i + 1, j, k]] - origin)
            along.append(controls[place[i, j + 1, k]] - origin)
    return across, along


def back_cosine_of(controls: Array, view: npt.NDArray[Any]) -> float:
    """Return the least cosine between a control normal of a patch and a ray from the eye to it.

    Parameters
    ----------
    controls : (10, 3)
    view : layout.VIEW record

    Returns
    -------
    float
        Above 0 where all of the patch is turned away.
    """
    rays = controls - view["eye"].astype(np.float64)
    if view["parallel"]:
        rays = view["axes"][2][None].astype(np.float64)
    rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    across, along = _tangents(controls)
    normals = np.array([np.cross(a, b) for a in across for b in along])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    return float((normals / np.where(lengths > 0, lengths, 1.0) @ rays.T).min())


def frustum_depth(controls: Array, view: npt.NDArray[Any]) -> float:
    """Return how far the bounds of the control points reach into the frustum; below 0 is outside.

    The least over the planes of the farthest that a corner of the bounds is inside of one.
    """
    low, high = controls.min(axis=0), controls.max(axis=0)
    normals = view["planes"][:, :3].astype(np.float64)
    farthest = np.where(normals > 0, normals * high, normals * low).sum(axis=1)
    return float((farthest + view["planes"][:, 3]).min())
