"""A good place to look at ground or a mesh from, when nobody names one."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..arguments import instance
from ..ground.heightmap import Heightmap
from .camera import FOV, SIZE, Camera

# across, back and up from the middle of a mesh to the eye, in diagonals
_EYE: Final = (0.5, -1.0, 0.6)


def default_camera(ground: Heightmap, *, fov: float = FOV, size: tuple[int, int] = SIZE) -> Camera:
    """Return an oblique view over the ground: from its southern edge, looking north.

    The eye stands above the highest ground near it, so that the picture runs from the tiles at its
    feet to the horizon.
    """
    x, y, _ = instance("a Heightmap for ground", ground, Heightmap).centre
    width, depth = ground.extent
    low, high = ground.height_range
    diagonal = float(np.hypot(width, depth))
    eye = (x - 0.20 * width, y - 0.50 * depth)
    target = (x + 0.06 * width, y - 0.03 * depth, low + 0.3 * (high - low))
    nearby = _highest_near(ground, eye, 0.20 * diagonal)
    height = max(target[2] + 0.16 * diagonal, nearby + 0.02 * diagonal)
    return Camera((*eye, height), target, fov=fov, size=size)


def camera_around(
    points: npt.NDArray[np.floating[Any]], origin: npt.ArrayLike = (0.0, 0.0, 0.0)
) -> Camera:
    """Return a view of all `points` (N, 3), relative to `origin`: from the south, above them."""
    seen = points if len(points) else np.zeros((1, 3))
    low, high = (bound.astype(np.float64) for bound in (seen.min(axis=0), seen.max(axis=0)))
    middle, diagonal = (low + high) / 2 + origin, float(np.linalg.norm(high - low)) or 1.0
    eye = middle + np.multiply(_EYE, diagonal)
    return Camera(tuple(eye.tolist()), tuple(middle.tolist()))


def _highest_near(ground: Heightmap, point: tuple[float, float], radius: float) -> float:
    """Return the highest elevation within `radius` of a world point, or of all ground if none."""
    rows, columns = ground.shape
    x = ground.origin[0] + ground.spacing[0] * np.arange(columns) - point[0]
    y = ground.origin[1] - ground.spacing[1] * np.arange(rows) - point[1]
    near = (np.hypot(x, y[:, None]) <= radius) & ground.valid
    return ground.base + float(ground.heights[near].max()) if near.any() else ground.height_range[1]
