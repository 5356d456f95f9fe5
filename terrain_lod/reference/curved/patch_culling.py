"""Which PN-triangles cannot be seen, in float64: what ``curved/pn_cull.h`` decides."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import numpy.typing as npt

from .pn import CUBIC

Array = npt.NDArray[np.float64]


def _facet_normals(controls: Array) -> Array:
    """Return the products of a patch's control tangents along two sides each; (108, 3).

    In the middle of all of them is the plane triangle's normal. Their lengths mean nothing.
    """
    place = {power: index for index, power in enumerate(CUBIC)}
    along: tuple[list[Array], ...] = ([], [], [])
    for i, j, k in product(range(3), repeat=3):
        if i + j + k == 2:
            powers = (i + 1, j, k), (i, j + 1, k), (i, j, k + 1)
            corners = [controls[place[power]] for power in powers]
            for side in range(3):
                along[side].append(corners[(side + 2) % 3] - corners[(side + 1) % 3])
    pairs = [product(along[side], along[(side + 1) % 3]) for side in range(3)]
    return np.array([np.cross(one, other) for pair in pairs for one, other in pair])


def back_cosine_of(controls: Array, view: npt.NDArray[Any]) -> float:
    """Return the least cosine between normals that triangles may have and rays from the eye.

    Parameters
    ----------
    controls : (10, 3)
    view : layout.VIEW record

    Returns
    -------
    float
        Above 0 where all triangles of the patch, divided evenly, are turned away.
    """
    rays = controls - view["eye"].astype(np.float64)
    if view["parallel"]:
        rays = view["axes"][2][None].astype(np.float64)
    rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    normals = _facet_normals(controls)
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
