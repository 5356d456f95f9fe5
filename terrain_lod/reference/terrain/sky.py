"""How much of the sky each sample sees: kernels/terrain/sky.cl in float64."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...ground.heightmap import Heightmap
from ...terrain.sky import BORDER, looks


def sky_seen(ground: Heightmap) -> npt.NDArray[np.float64]:
    """Return the mean over all directions of the cosine squared of the horizon; (R, C)."""
    heights = ground.heights.astype(np.float64)
    if ground.mask is not None:
        heights[ground.mask] = heights[~ground.mask].min()
    bordered = np.pad(heights, BORDER, constant_values=-np.inf)
    rows, columns = ground.shape
    total = np.zeros(ground.shape)
    for direction in looks():
        slope = np.zeros(ground.shape)
        for south, east in direction.tolist():
            top, left = BORDER + south, BORDER + east
            there = bordered[top : top + rows, left : left + columns]
            distance = np.hypot(south * ground.spacing[1], east * ground.spacing[0])
            slope = np.maximum(slope, (there - heights) / distance)
        total += 1 / (1 + slope**2)
    return total / len(looks())
