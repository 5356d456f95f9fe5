"""Levels of detail in float64: what the headers of ``kernels/terrain/lod/`` compute."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt
from scipy.spatial import ConvexHull

from ...camera.camera import Camera

Array = npt.NDArray[np.float64]
Parameters = Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Patch:
    """What a formula knows of patches: ``patch.h``.

    Attributes
    ----------
    distance, deviation : array
        From the eye to the middle of the corners, and of the samples from the plane.
    midpoint, normal : (..., 3)
        The middle of the corners, relative to the terrain's origin, and of the plane.
    minimum, maximum : array
        Heights above the terrain's base; NaN where there is no data.
    boxes : (..., 2, 3)
        Lowest and highest corner in the world.
    holes : array
        Samples without data.
    camera : Camera or None
    """

    distance: Array
    deviation: Array
    midpoint: Array
    normal: Array
    minimum: Array
    maximum: Array
    boxes: Array
    holes: Array
    camera: Camera | None


def nearness(distance: Array, near: float, far: float) -> Array:
    """Return 1 at `near` and before, 0 at `far` and beyond."""
    return 1 - np.clip((distance - near) / (far - near), 0, 1)


def uniform(patch: Patch, parameters: Parameters) -> Array:
    """``uniform.h``."""
    return np.full_like(patch.distance, parameters["factor"])


def distance_scaled(patch: Patch, parameters: Parameters) -> Array:
    """``distance.h``."""
    scale = nearness(patch.distance, parameters["near"], parameters["far"])
    low, high = parameters["minimum"], parameters["maximum"]
    return low + (high - low) * scale ** parameters["falloff"]


def coplanarity(patch: Patch, parameters: Parameters) -> Array:
    """``coplanarity.h``."""
    assert patch.camera is not None
    camera = patch.camera
    depth = 1.0 if camera.height else np.maximum(patch.distance, camera.near)
    seen = patch.deviation * camera.focal / depth
    share = np.cbrt(np.minimum(seen / parameters["pixels"], 1))
    return np.maximum(parameters["maximum"] * share, parameters["minimum"])


def book_coplanarity(patch: Patch, parameters: Parameters) -> Array:
    """``book_coplanarity.h``."""
    scale = nearness(patch.distance, parameters["near"], parameters["far"])
    detail = np.minimum(patch.deviation / parameters["full_deviation"], 1)
    flat = parameters["flat_weight"]
    low, high = parameters["minimum"], parameters["maximum"]
    return low + (high - low) * scale * (flat + (1 - flat) * np.sqrt(detail))


def screen_area(patch: Patch, parameters: Parameters) -> Array:
    """``area.h``; the outline of a box in the picture is a convex hull here."""
    assert patch.camera is not None
    sides = [
        np.sqrt(_area_in_picture(patch.camera, box)) if np.isfinite(box).all() else np.nan
        for box in patch.boxes.reshape(-1, 2, 3)
    ]
    segments = np.reshape(sides, patch.distance.shape) / parameters["pixels"]
    return np.clip(segments, parameters["minimum"], parameters["maximum"])


def _area_in_picture(camera: Camera, box: Array) -> float:
    """Return the pixels that a box covers; infinite where it reaches the near plane."""
    corners = np.stack(np.meshgrid(*box.T), axis=-1).reshape(-1, 3)
    pixels, depth = camera.project(corners)
    if not camera.height and depth.min() <= camera.near:
        return np.inf
    return float(ConvexHull(pixels).volume)  # which is the area in a plane


Formula = Callable[[Patch, Parameters], Array]
"""Segments along an edge of patches, from what is known of them and the formula's numbers."""

# by the header's name
FORMULAS: Final[Mapping[str | Path, Formula]] = {
    "terrain/lod/uniform.h": uniform,
    "terrain/lod/distance.h": distance_scaled,
    "terrain/lod/coplanarity.h": coplanarity,
    "terrain/lod/book_coplanarity.h": book_coplanarity,
    "terrain/lod/area.h": screen_area,
}
