"""Ground for tests: real sizes of nothing, but every shape that has ever caused trouble."""

from __future__ import annotations

import numpy as np

from terrain_lod import Heightmap


def rough(rows: int = 100, columns: int = 77, seed: int = 0, **options: object) -> Heightmap:
    """Return ground with detail at all scales; heights of some hundred units."""
    rng = np.random.default_rng(seed)
    heights = rng.normal(size=(rows, columns)).cumsum(axis=0).cumsum(axis=1)
    return Heightmap(heights, **options)


def holed(rows: int = 100, columns: int = 77, seed: int = 0, **options: object) -> Heightmap:
    """Return rough ground with single holes, a whole tile, a row and a corner missing."""
    rng = np.random.default_rng(seed + 1)
    heights = np.array(rough(rows, columns, seed).heights)
    heights[rng.random(heights.shape) < 0.01] = np.nan
    heights[:17, :17] = np.nan
    heights[40] = np.nan
    heights[-3:, -5:] = np.nan
    return Heightmap(heights, **options)


def plane(slope_x: float, slope_y: float, size: int = 46, **options: object) -> Heightmap:
    """Return an exact plane that rises by these heights a cell, east and south."""
    row, column = np.mgrid[:size, :size].astype(np.float64)
    return Heightmap(slope_x * column + slope_y * row, **options)
