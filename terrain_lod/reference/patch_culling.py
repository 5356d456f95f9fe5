"""Which PN-triangles cannot be seen, in float64: what ``kernels/pn_cull.h`` decides."""

from __future__ import annotations

from itertools import product
from math import factorial
from typing import Any

import numpy as np
import numpy.typing as npt

from .pn import CUBIC

Array = npt.NDArray[np.float64]


def _control_normals(controls: Array) -> Array:
    """Return the fifteen control normals of a patch's normal, which is of degree four; (15, 3).

    The product, in Bernstein form, of the derivatives along u and along v against w. Their lengths
    mean nothing.
    """
    place = {power: index for index, power in enumerate(CUBIC)}
    across, along = {}, {}
    for i, j, k in product(range(3), repeat=3):
        if i + j + k == 2:
            times = 2 / (factorial(i) * factorial(j) * factorial(k))
            origin = controls[place[i, j, k + 1]]
            across[i, j] = times * (controls[place[i + 1, j, k]] - origin)
            along[i, j] = times * (controls[place[i, j + 1, k]] - origin)
    normals: dict[tuple[int, int], Array] = {}
    for (i, j), a in across.items():
        for (k, m), b in along.items():
            normals[i + k, j + m] = normals.get((i + k, j + m), 0) + np.cross(a, b)
    return np.array(list(normals.values()))


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
    normals = _control_normals(controls)
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
