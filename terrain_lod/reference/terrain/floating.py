"""Heights that float within the tolerance, in float64: what ``terrain/floating.cl`` moves."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]

_LONGEST: Final = 8.0
_INERTIA: Final = 0.25
_MOMENTUM: Final = 0.8
_SHARE: Final = 0.97
_REST: Final = 1e-3
_OUTSIDE: Final = -1e-4


@dataclass(frozen=True)
class Samples:
    """The S pairs of a triangle and a sample in it.

    Attributes
    ----------
    corners : (S, 3) int
        Vertices of the triangle.
    weights : (S, 3)
        Of its corners at the sample.
    heights : (S,)
        Of the sample.
    room : (S,)
        How far the triangle may be from it.
    triangle : (S,) int
    """

    corners: Array
    weights: Array
    heights: Array
    room: Array
    triangle: Array


def welded(columns: Array, rows: Array) -> Array:
    """Return the vertex of each point: points at one place are one."""
    _, vertices = np.unique(np.stack([columns, rows]), axis=1, return_inverse=True)
    return vertices.ravel()


def samples_of(
    heights: Array, valid: Array, points: Array, triangles: Array, allowed: Array, vertices: Array
) -> Samples:
    """Return the samples that each triangle is asked of.

    Parameters
    ----------
    heights, valid : (R, C)
    points : (N, 2)
        Column and row of each point of the pattern.
    triangles : (M, 3) int
        Into points.
    allowed : (M,)
        Error of each triangle's patch.
    vertices : (N,) int
    """
    parts = []
    for index, triangle in enumerate(triangles):
        (ax, ay), (bx, by), (cx, cy) = corners = points[triangle]
        area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        if area == 0:
            continue
        (left, top), (right, bottom) = np.ceil(corners.min(0)), np.floor(corners.max(0))
        y, x = np.mgrid[int(top) : int(bottom) + 1, int(left) : int(right) + 1]
        one = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
        two = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
        weights = np.stack([1 - one - two, one, two], axis=-1)
        held = (weights.min(axis=-1) >= _OUTSIDE) & valid[y, x]
        parts.append((np.full(held.sum(), index), weights[held], heights[y, x][held]))
    triangle, weights, found = (np.concatenate(each) for each in zip(*parts, strict=True))
    room = allowed[triangle] * _SHARE
    return Samples(vertices[triangles[triangle]], weights, found, room, triangle)


def excesses(samples: Samples, heights: Array) -> Array:
    """Return how far triangles are off their samples beyond what they may; (S,)."""
    residuals = (samples.weights * heights[samples.corners]).sum(axis=1) - samples.heights
    beyond: Array = residuals - np.clip(residuals, -samples.room, samples.room)
    return beyond


def fitted(samples: Samples, ground: Array, finest: Array, passes: int) -> Array:
    """Return the heights of V vertices after so many passes.

    Parameters
    ----------
    samples : Samples
    ground : (V,)
        The ground's height at each vertex, where all begin.
    finest : (V,)
        The least that the patches of each vertex allow.
    passes : int
    """
    heights, before = ground.copy(), ground.copy()
    most = _SHARE * finest
    # sums are limited triangle by triangle
    triangles, inverse = np.unique(samples.triangle, return_inverse=True)
    corners = np.zeros((len(triangles), 3), int)
    corners[inverse] = samples.corners
    for _ in range(passes):
        excess = excesses(samples, heights)
        pulls, weights = np.zeros(len(heights)), np.zeros(len(heights))
        for corner in range(3):
            weight = samples.weights[:, corner] * (excess != 0)
            pull, total = (
                np.bincount(inverse, each, len(triangles)) for each in (weight * excess, weight)
            )
            vertex = corners[:, corner]
            longest = _LONGEST * finest[vertex] * total
            asking = total > 0
            np.add.at(pulls, vertex[asking], np.clip(pull, -longest, longest)[asking])
            np.add.at(weights, vertex[asking], total[asking])
        following = np.clip(heights - pulls / (weights + _INERTIA), ground - most, ground + most)
        way = following - before
        resting = (pulls == 0) & (np.abs(way) < _REST * finest)
        uphill = (heights - following) * way > 0
        further = following + np.where(resting | uphill, 0.0, _MOMENTUM * way)
        heights, before = np.clip(further, ground - most, ground + most), following
    return heights
