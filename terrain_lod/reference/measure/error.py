"""Vertical error in float64 NumPy: what ``measure/vertical_error.cl`` computes, by other means.

The kernel cuts triangles along rows; here every sample in a triangle's bounding box gets its
barycentric weights.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np
import numpy.typing as npt

from ...ground.heightmap import Heightmap
from ...mesh.mesh import Mesh

# cells within which a point is on a sample or an edge; a thinner triangle covers nothing
NEAR: Final = 2.0**-26
# relative spacing of float32: how well a vertex says where it is
SINGLE: Final = 2.0**-23
# samples looked at together
_BATCH: Final = 1 << 20

Array = npt.NDArray[np.float64]


def error_field(mesh: Mesh, ground: Heightmap) -> Array:
    """Return mesh minus ground at every sample, the largest where triangles overlap.

    Returns
    -------
    (R, C) float64
        NaN where no triangle covers the sample, and where there is no data.
    """
    corners = placed_vertices(mesh, ground)[mesh.triangles]
    highest, lowest = np.full(ground.shape, -np.inf), np.full(ground.shape, np.inf)
    for triangle, row, column in _samples_in_boxes(corners, ground.shape):
        inside, height = _interpolate(corners[triangle], column, row)
        error = height[inside] - ground.heights[row[inside], column[inside]]
        sample = row[inside], column[inside]
        np.maximum.at(highest, sample, error)
        np.minimum.at(lowest, sample, error)
    field = np.where(highest >= -lowest, highest, lowest)
    field[np.isinf(field) | ~ground.valid] = np.nan
    return field


def placed_vertices(mesh: Mesh, ground: Heightmap) -> Array:
    """Return column, row and height above the ground's base of every vertex; (V, 3).

    A column or row that float32 cannot tell from a whole number is that number.
    """
    x, y, z = np.asarray(mesh.vertices, np.float64).T
    (dx, dy), (x0, y0) = ground.spacing, ground.origin
    return np.stack(
        [
            _onto_samples((x + (mesh.origin[0] - x0)) / dx, abs(x) * SINGLE / dx),
            _onto_samples(-(y + (mesh.origin[1] - y0)) / dy, abs(y) * SINGLE / dy),
            z + (mesh.origin[2] - ground.base),
        ],
        axis=1,
    )


def _onto_samples(value: Array, near: Array) -> Array:
    whole = np.rint(value)
    return np.where(abs(value - whole) <= np.maximum(near, NEAR), whole, value)


def _samples_in_boxes(
    corners: Array, shape: tuple[int, int]
) -> Iterator[tuple[npt.NDArray[np.int64], ...]]:
    """Yield triangle, row and column of every sample in a triangle's bounding box, in batches."""
    limit = np.array(shape[::-1]) - 1
    first = np.ceil(corners[..., :2].min(axis=1) - NEAR).clip(0, limit + 1).astype(np.int64)
    last = np.floor(corners[..., :2].max(axis=1) + NEAR).clip(-1, limit).astype(np.int64)
    width, depth = (last - first + 1).clip(min=0).T
    counts = width * depth
    batches = np.cumsum(counts) // _BATCH
    for members in np.split(np.arange(len(counts)), np.flatnonzero(np.diff(batches)) + 1):
        triangle = np.repeat(members, counts[members])
        starts = np.cumsum(counts[members]) - counts[members]
        position = np.arange(len(triangle)) - np.repeat(starts, counts[members])
        row, column = np.divmod(position, width[triangle])
        yield triangle, row + first[triangle, 1], column + first[triangle, 0]


def _interpolate(
    corners: Array, x: npt.NDArray[np.int64], y: npt.NDArray[np.int64]
) -> tuple[npt.NDArray[np.bool_], Array]:
    """Return whether triangles (N, 3, 3) contain the points x, y, and their heights there."""
    following = np.roll(corners, -1, axis=1)
    edge = following - corners
    # twice the area of the triangle that each edge makes with the point
    weight = edge[..., 0] * (y[:, None] - corners[..., 1])
    weight -= edge[..., 1] * (x[:, None] - corners[..., 0])
    first, last = edge[:, 0], edge[:, 2]
    area = first[:, 1] * last[:, 0] - first[:, 0] * last[:, 1]
    weight *= np.sign(area)[:, None]
    length = np.hypot(edge[..., 0], edge[..., 1])
    extent = np.ptp(corners[..., :2], axis=1).max(axis=1, initial=0.0)
    inside = (weight >= -NEAR * length).all(axis=1) & (abs(area) > NEAR * extent)
    # on an edge, the corner across it has no say
    weight = weight.clip(min=0.0)
    heights = np.roll(corners[..., 2], 1, axis=1)
    with np.errstate(invalid="ignore"):
        return inside, (weight * heights).sum(axis=1) / weight.sum(axis=1)
