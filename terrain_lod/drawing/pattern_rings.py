"""The rings of a pattern: which strip each triangle lies in, and where strips meet."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..device.layout import FIXED_ONE

Points = npt.NDArray[np.int64]
Indices = npt.NDArray[np.intp]

# the third coordinate of a triangle is what the others leave: rounded twice
_ROUNDING = 8


def rings_of_points(domain: str, points: Points) -> Indices:
    """Return the ring that each point (N, 2), in 16.16, lies on: 0 is the boundary; (N,)."""
    if domain == "triangle":
        inward = np.minimum(points.min(axis=1), FIXED_ONE - points.sum(axis=1))
        levels = np.unique(inward)
        firsts = levels[np.diff(levels, prepend=-FIXED_ONE) > _ROUNDING]
        ring: Indices = np.searchsorted(firsts, inward, side="right") - 1
        return ring
    # inside is a lattice: a point is as far in as its column or its row
    inside = ((points > 0) & (points < FIXED_ONE)).all(axis=1)
    rings = np.zeros(len(points), np.intp)
    depths = []
    for axis in (0, 1):
        places, rank = np.unique(points[inside, axis], return_inverse=True)
        depths.append(np.minimum(rank, len(places) - 1 - rank))
    rings[inside] = 1 + np.minimum(*depths)
    return rings


def strips_of_triangles(domain: str, points: Points, triangles: Indices) -> Indices:
    """Return the strip that each triangle (T, 3) lies in: r between ring r and r + 1; (T,)."""
    strips: Indices = rings_of_points(domain, points)[triangles].min(axis=1)
    return strips


def edges_of_triangles(
    points: Points, triangles: Indices, strips: Indices
) -> tuple[Indices, npt.NDArray[np.bool_]]:
    """Return each edge (E, 2) once, and whether it is on a ring (E,).

    That is where two strips meet or the pattern ends. Triangles without an area have no edges.
    """
    # points at one place are one
    _, first, number = np.unique(points, axis=0, return_index=True, return_inverse=True)
    corners = first[number.reshape(-1)][triangles]
    has_area = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    corners, strips = corners[has_area], strips[has_area]
    edges = np.concatenate([corners[:, [k, (k + 1) % 3]] for k in range(3)])
    edges.sort(axis=1)
    unique, edge, uses = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    low, high = np.full(len(unique), len(points)), np.full(len(unique), -1)
    np.minimum.at(low, edge.reshape(-1), np.tile(strips, 3))
    np.maximum.at(high, edge.reshape(-1), np.tile(strips, 3))
    return unique, (low != high) | (uses == 1)
