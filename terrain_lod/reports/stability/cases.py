"""Ground and cameras that are hard on 32-bit floats."""

from __future__ import annotations

from typing import Final

import numpy as np

from ...camera.camera import Camera
from ...ground.heightmap import Heightmap

_SIZE: Final = 46  # samples along a side: three tiles of 15 cells
_STEP: Final = 30.0  # metres from sample to sample


def grounds() -> dict[str, Heightmap]:
    """Return the hard grounds by name; the same every time."""
    row, column = np.mgrid[:_SIZE, :_SIZE].astype(np.float64)
    noise = np.random.default_rng(3).normal(size=row.shape)
    rough = np.random.default_rng(5).normal(size=row.shape).cumsum(axis=0).cumsum(axis=1)
    heights = {
        "constant, 8,848 m": np.full(row.shape, 8848.0),
        "millimetres on a slope at 8,848 m": 8848 + 0.5 * column + 1e-3 * noise,
        "millimetres on a slope at 1,000 km": 1e6 + 0.5 * column + 1e-3 * noise,
        "one spike": np.where((row == 20) & (column == 21), 1e4, 0.0),
        "cliff of one cell": np.where(column > 22, 500.0, 0.0),
        "checkerboard of ±1": np.where((row + column) % 2, 1.0, -1.0),
        "denormals": 1e-42 * row * column,
        "near the end of float32": np.where(noise > 0, 1e38, -1e38),
        "extremes of int16": np.where(noise > 0, 32767.0, -32768.0),
        "hole of one sample": np.where((row == 20) & (column == 21), np.nan, rough),
        "hole of one row": np.where(row == 20, np.nan, rough),
        "hole of a tile": np.where((row <= 15) & (column <= 15), np.nan, rough),
        "all but one sample missing": np.where((row == 7) & (column == 8), 5.0, np.nan),
        "2 × 2 samples": rough[:2, :2],
        "one sample more than a tile": rough[:17, :17],
    }
    for slope in (0.001, 1.0, 1000.0):
        heights[f"plane of slope {slope:g}"] = slope * _STEP * (column - 0.3 * row)
    made = {name: Heightmap(each, spacing=_STEP) for name, each in heights.items()}
    made["spacing 1 : 1000"] = Heightmap(rough, spacing=(1.0, 1000.0))
    made["coordinates of 1,000 km"] = Heightmap(rough, spacing=_STEP, origin=(1e6, -1e6))
    return made


def rough_ground() -> Heightmap:
    """Return ordinary ground, for the hard cameras."""
    steps = np.random.default_rng(5).normal(size=(_SIZE, _SIZE))
    return Heightmap(10 * steps.cumsum(axis=0).cumsum(axis=1), spacing=_STEP)


def cameras(ground: Heightmap) -> dict[str, Camera]:
    """Return the hard cameras over `ground` by name."""
    x, y, z = ground.centre
    x0, y0 = ground.origin
    corner = x0, y0, ground.base + float(ground.heights[0, 0])
    far = x - 1e7, y, z + 1e6
    above = x, y - 600.0, z + 900.0
    return {
        "camera on a corner": Camera(corner, (x, y, z)),
        "camera inside the ground": Camera((x, y, z - 20.0), (x + 100.0, y + 50.0, z)),
        "camera at 10⁷ m": Camera(far, (x, y, z)),
        "field of view 0.1°": Camera(above, (x, y, z), fov=0.1),
        "field of view 179°": Camera(above, (x, y, z), fov=179.0),
        "parallel camera": Camera(above, (x, y, z), height=700.0),
    }
