"""A character to amplify: a closed mesh of about 2,000 triangles, made of round cones.

A robed figure with a pointed hat and a staff: limbs, narrow parts and a wide brim, as the wizard of
1,986 triangles that the thesis draws, which is not to be had.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

import terrain_lod as tl

Array = npt.NDArray[np.float64]

# ends (x right, y back, z up) and radii of round cones; the x of limbs is mirrored
_MIDDLE = (
    ((0.00, 0.00, 0.16), (0.00, 0.00, 0.95), 0.36, 0.17),  # robe
    ((0.00, 0.00, 1.00), (0.00, 0.00, 1.20), 0.22, 0.19),  # shoulders
    ((0.00, -0.02, 1.50), (0.00, -0.02, 1.56), 0.19, 0.19),  # head
    ((0.00, -0.14, 1.36), (0.00, -0.20, 1.14), 0.10, 0.06),  # beard
    ((0.00, 0.00, 1.72), (0.06, 0.10, 2.30), 0.19, 0.06),  # hat
)
_LIMBS = (
    ((0.18, 0.00, 1.20), (0.46, -0.05, 0.98), 0.10, 0.09),  # upper arm
    ((0.46, -0.05, 0.98), (0.56, -0.30, 1.10), 0.09, 0.10),  # lower arm
    ((0.17, -0.16, 0.06), (0.17, -0.32, 0.06), 0.11, 0.09),  # shoe
)
_STAFF = (
    ((0.60, -0.36, 0.06), (0.60, -0.36, 1.75), 0.08, 0.08),
    ((0.60, -0.36, 1.85), (0.60, -0.36, 1.87), 0.13, 0.13),
)
_BRIM = (0.0, -0.01, 1.70), 0.36, 0.075  # middle, radius, half its height
_BLEND = 0.06  # how softly parts meet
# the grid on which the surface is found; finer makes more triangles
_SPACING = 0.0988
_LOW, _HIGH = np.array([-0.85, -0.7, -0.2]), np.array([0.9, 0.6, 2.5])


def character() -> tl.Mesh:
    """Return the figure; 2 units high, closed, with the normals of its surface.

    Naive surface nets: a vertex in each cell of a grid that the surface passes, a quad about each
    edge of the grid that it crosses (S. F. Gibson: *Constrained Elastic Surface Nets*, 1998). Then
    each vertex is moved onto the surface.
    """
    counts = np.ceil((_HIGH - _LOW) / _SPACING).astype(int) + 1
    grid = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1)
    inside = distance((_LOW + _SPACING * grid).reshape(-1, 3)).reshape(counts) < 0
    quads = []
    for axis in range(3):
        first, last = np.delete(inside, -1, axis), np.delete(inside, 0, axis)
        at = np.argwhere(first != last)
        b, c = np.roll(np.eye(3, dtype=int), -axis, axis=0)[1:]
        # the four cells about the edge, counter-clockwise seen from its end
        around = np.stack([at - b - c, at - c, at, at - b], axis=1)
        enters = last[tuple(at.T)]
        around[enters] = around[enters, ::-1]
        quads.append(around.reshape(-1, 3))
    cells, corner = np.unique(np.concatenate(quads), axis=0, return_inverse=True)
    q = corner.reshape(-1, 4)
    triangles = np.concatenate([q[:, [0, 1, 2]], q[:, [0, 2, 3]]]).astype(np.int32)
    vertices = _LOW + _SPACING * (cells + 0.5)
    for _ in range(8):  # the distance is none exactly where parts blend
        vertices = vertices - 0.7 * distance(vertices)[:, None] * gradient(vertices)
    return tl.Mesh(vertices.astype(np.float32), gradient(vertices).astype(np.float32), triangles)


def distance(points: Array) -> Array:
    """Return about how far points (N, 3) are outside the figure; (N,)."""
    mirrored = np.abs(points * (1, 0, 0)) + points * (0, 1, 1)
    parts = [_round_cone(points, *part) for part in (*_MIDDLE, *_STAFF)]
    parts += [_round_cone(mirrored, *part) for part in _LIMBS]
    middle, radius, half = _BRIM
    away = points - middle
    beyond = np.maximum(np.hypot(away[:, 0], away[:, 1]) - radius, 0)
    parts.append(np.hypot(beyond, away[:, 2]) - half)
    # smooth minimum: -k log sum exp(-d / k)
    stacked = -np.array(parts) / _BLEND
    top = stacked.max(axis=0)
    found: Array = -_BLEND * (top + np.log(np.exp(stacked - top).sum(axis=0)))
    return found


def gradient(points: Array, step: float = 1e-4) -> Array:
    """Return the unit normals of the figure at points (N, 3)."""
    slopes = [distance(points + step * axis) - distance(points - step * axis) for axis in np.eye(3)]
    normals = np.stack(slopes, axis=1)
    found: Array = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return found


def _round_cone(points: Array, start: tuple, end: tuple, first: float, last: float) -> Array:
    along = np.subtract(end, start)
    t = np.clip((points - start) @ along / (along @ along), 0, 1)
    nearest = start + t[:, None] * along
    found: Array = np.linalg.norm(points - nearest, axis=1) - (first + t * (last - first))
    return found
