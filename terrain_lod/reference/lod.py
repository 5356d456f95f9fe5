"""Levels of detail in float64: what the ``kernels/lod_*.h`` headers compute."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Parameters = Mapping[str, float]


def nearness(distance: Array, near: float, far: float) -> Array:
    """Return 1 at `near` and before, 0 at `far` and beyond."""
    return 1 - np.clip((distance - near) / (far - near), 0, 1)


def uniform(distance: Array, deviation: Array, parameters: Parameters) -> Array:
    """``lod_uniform.h``."""
    return np.full_like(distance, parameters["factor"])


def distance_scaled(distance: Array, deviation: Array, parameters: Parameters) -> Array:
    """``lod_distance.h``."""
    scale = nearness(distance, parameters["near"], parameters["far"])
    low, high = parameters["minimum"], parameters["maximum"]
    return low + (high - low) * scale ** parameters["falloff"]


def coplanarity(distance: Array, deviation: Array, parameters: Parameters) -> Array:
    """``lod_coplanarity.h``."""
    scale = nearness(distance, parameters["near"], parameters["far"])
    detail = np.minimum(deviation / parameters["full_deviation"], 1)
    flat = parameters["flat_weight"]
    low, high = parameters["minimum"], parameters["maximum"]
    return low + (high - low) * scale * (flat + (1 - flat) * np.sqrt(detail))


# by the header's name
FORMULAS: Final[Mapping[str, Callable[[Array, Array, Parameters], Array]]] = {
    "lod_uniform.h": uniform,
    "lod_distance.h": distance_scaled,
    "lod_coplanarity.h": coplanarity,
}
