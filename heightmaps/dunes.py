"""Dunes: sand that the wind takes from windward slopes and drops in the lee, on stony ground.

Slabs of sand hop downwind, settle in wind shadows and slide where it is too steep:
    B. T. Werner, "Eolian dunes: computer simulations and attractor interpretation", Geology
    23(12), 1995;
here in the mean of many slabs, with the wind faster up windward slopes, as in
    H. Momiji, R. Carretero-Gonzalez, S. R. Bishop, A. Warren, "Simulation of the effect of wind
    speedup in the formation of transverse dune fields", Earth Surface Processes and Landforms
    25(8), 2000.
The wind blows from the west and leaves in the east to come back in the west.
"""

from __future__ import annotations

import numpy as np
from terrain_lod.heightmaps.erosion import crept
from terrain_lod.heightmaps.noise import (
    Field,
    Random,
    doubled,
    fractal,
)

CELL = 10.0  # metres, while the wind blows; half of it at the end
GUSTS = 1000
SAND = 13.0  # metres, if it were spread evenly
TAKEN = 0.5  # metres of sand a gust takes from level ground
SPEED_UP, FASTEST = 8.0, 1.4  # of the wind with slope, and its limit
HOP, HOPS = 4, 8  # cells
SHADOW = 0.2  # slope of the edge of the wind shadow: 11 degrees
REPOSE = 0.62  # slope of dry sand: 32 degrees


def dunes(seed: int) -> Field:
    """Return the heights of 2.6 x 2.6 km on cells of 5 m; (513, 513)."""
    random = Random(seed)
    shape = (256, 256)
    sand = np.maximum(SAND + 2 * fractal(random, shape, 16, 4, 0.7), 0)
    for _ in range(GUSTS):
        sand = _smoothed(_slid(_blown(random, sand), 2))
    sand = _slid(sand, 20)
    # close the circle, halve the cells and put the sand on its stony plain
    sand = doubled(np.pad(sand, ((0, 1), (0, 1)), mode="wrap"))
    sand = crept(np.maximum(sand, 0), 0.15, 3)
    return sand + 40 + 5 * fractal(random, sand.shape, 160, 4)


def _blown(random: Random, sand: Field) -> Field:
    """Return `sand` after one gust."""
    # a dune throws its shadow downwind, also over the seam
    ramp = np.arange(2.0 * sand.shape[1]) * SHADOW * CELL
    twice = np.concatenate([sand, sand], axis=1) + ramp
    shadow = (np.maximum.accumulate(twice, axis=1) > twice + 1e-6)[:, sand.shape[1] :]
    # the wind takes more where it runs uphill
    uphill = (sand - np.roll(sand, 3, axis=1)) / (3 * CELL)
    gust = TAKEN * (0.6 + 0.8 * random.uniform(*sand.shape))
    taken = np.minimum(sand, gust * np.clip(1 + SPEED_UP * uphill, 0.2, FASTEST))
    flying = np.where(shadow, 0, taken)
    sand = sand - flying
    # it comes down for good in the shadow, more often on sand than on stones
    for hop in range(HOPS):
        flying = np.roll(flying, HOP, axis=1)
        share = np.where(shadow | (hop == HOPS - 1), 1.0, np.where(sand > 0.5, 0.45, 0.2))
        landing = flying * share
        sand, flying = sand + landing, flying - landing
    return sand


def _slid(sand: Field, rounds: int) -> Field:
    """Return `sand` after avalanches where it was steeper than its angle of repose."""
    for _ in range(rounds):
        for step, length in (((0, 1), 1.0), ((1, 0), 1.0), ((1, 1), 1.41421), ((1, -1), 1.41421)):
            limit = REPOSE * CELL * length
            drop = sand - np.roll(sand, (-step[0], -step[1]), axis=(0, 1))
            moved = (drop - np.clip(drop, -limit, limit)) / 4
            sand = sand - moved + np.roll(moved, step, axis=(0, 1))
    return sand


def _smoothed(sand: Field) -> Field:
    """Return `sand` with the finest ripples gone and none of it below the stones."""
    around = np.roll(sand, 1, 0) + np.roll(sand, -1, 0) + np.roll(sand, 1, 1) + np.roll(sand, -1, 1)
    return np.maximum(sand + 0.02 * np.where(sand > 0.3, around - 4 * sand, 0), 0)
