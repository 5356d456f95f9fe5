"""Curved PN-triangles in float64: what ``pn_*.cl`` compute, by the papers' own formulas.

Control points and their places are written as b_ijk with i + j + k = 3, as in Vlachos et al. 2001;
the kernels keep the same surface as differences from the plane triangle.
"""

from __future__ import annotations

from math import factorial
from typing import Final

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int32]

# exponents of u, v, w: corners, edges opposite corners 0, 1, 2 in their direction, middle
CUBIC: Final = (
    *[(3, 0, 0), (0, 3, 0), (0, 0, 3)],
    *[(0, 2, 1), (0, 1, 2), (1, 0, 2), (2, 0, 1), (2, 1, 0), (1, 2, 0)],
    (1, 1, 1),
)
# corners, middles of the edges opposite corners 0, 1, 2
QUADRATIC: Final = ((2, 0, 0), (0, 2, 0), (0, 0, 2), (0, 1, 1), (1, 0, 1), (1, 1, 0))

_EDGES: Final = ((1, 2), (2, 0), (0, 1))
_NO_DIRECTION: Final = 1e-6


def control_points(patches: Indices, positions: Array, normals: Array) -> Array:
    """Return the ten control points of T patches of 12 indices; (T, 10, 3).

    An edge's control points are the means of those that its two sides would have alone (PN-AEN); a
    patch without a neighbour to agree with (-1) has a straight edge there.
    """
    corners = positions[patches[:, :3]]
    controls = np.empty((len(patches), 10, 3))
    controls[:, :3] = corners
    for side, (first, second) in enumerate(_EDGES):
        for end, (i, j) in enumerate(((first, second), (second, first))):
            adjacent = patches[:, 3 + 2 * side + end]
            p, q = corners[:, i], corners[:, j]
            own = _edge_point(p, q, normals[patches[:, i]])
            both = (own + _edge_point(p, q, normals[adjacent])) / 2
            straight = (2 * p + q) / 3
            controls[:, 3 + 2 * side + end] = np.where(adjacent[:, None] < 0, straight, both)
    # equation 9.8 of the book: E + (E - V) / 2
    mean, middle = controls[:, 3:9].mean(axis=1), corners.mean(axis=1)
    controls[:, 9] = mean + (mean - middle) / 2
    return controls


def _edge_point(p: Array, q: Array, normal: Array) -> Array:
    """Return the point a third along, projected onto the plane across `normal` at `p`."""
    weight = np.einsum("ij,ij->i", q - p, normal)[:, None]
    found: Array = (2 * p + q - weight * normal) / 3
    return found


def control_normals(patches: Indices, positions: Array, normals: Array) -> Array:
    """Return the six control normals of T patches; (T, 6, 3). Zero where there is no direction."""
    corners, own = positions[patches[:, :3]], normals[patches[:, :3]]
    controls = np.empty((len(patches), 6, 3))
    controls[:, :3] = own
    for side, (i, j) in enumerate(_EDGES):
        along, total = corners[:, j] - corners[:, i], own[:, i] + own[:, j]
        square = np.einsum("ij,ij->i", along, along)
        slope = 2 * np.einsum("ij,ij->i", along, total) / np.where(square > 0, square, 1.0)
        mirrored = total - slope[:, None] * along
        lengths = np.linalg.norm(mirrored, axis=1, keepdims=True)
        controls[:, 3 + side] = mirrored / np.where(lengths > 0, lengths, 1.0)
    return controls


def positions_at(controls: Array, weights: Array) -> Array:
    """Return the cubic surfaces (N, 10, 3) at the weights (N, 3) of their corners; (N, 3)."""
    found = np.zeros((len(controls), 3))
    for index, (i, j, k) in enumerate(CUBIC):
        times = 6 // (factorial(i) * factorial(j) * factorial(k))
        found += times * _monomial(weights, (i, j, k)) * controls[:, index]
    return found


def normals_at(normals: Array, corners: Array, weights: Array, *, linear: bool = False) -> Array:
    """Return unit normals of patches with control normals (N, 6, 3) and corners (N, 3, 3).

    The blend has no binomial factors, as in the paper. Where it has no direction, the plane
    triangle's normal stands in, and where that has none, (0, 0, 1).
    """
    if linear:
        blend = (weights[:, :, None] * normals[:, :3]).sum(axis=1)
    else:
        terms = [_monomial(weights, power) * normals[:, k] for k, power in enumerate(QUADRATIC)]
        blend = np.sum(terms, axis=0)
    across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    across[~across.any(axis=1)] = 0.0, 0.0, 1.0
    lost = np.linalg.norm(blend, axis=1) <= _NO_DIRECTION
    blend[lost] = across[lost]
    unit: Array = blend / np.linalg.norm(blend, axis=1, keepdims=True)
    return unit


def _monomial(weights: Array, powers: tuple[int, int, int]) -> Array:
    found: Array = (weights ** np.array(powers)).prod(axis=1, keepdims=True)
    return found
