"""Islands: ridges cut by short rivers, platforms cut by waves, and a sea that is flat at 0 m."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.ndimage import distance_transform_edt
from terrain_lod.heightmaps.erosion import (
    Mask,
    crept,
    evolve,
    fallen,
    floodplains,
)
from terrain_lod.heightmaps.noise import (
    Field,
    Random,
    fractal,
    grid,
    refined,
)

# steps, and years of each, on cells of 120, 60 and 30 m
STAGES = ((100, 20_000.0), (30, 10_000.0), (20, 5_000.0))


def islands(seed: int) -> Field:
    """Return the heights of 15.4 x 15.4 km on cells of 30 m; (513, 513)."""
    random = Random(seed)
    cell, shape = 120.0, (129, 129)
    # land where this is positive; an uneven ring of open sea all around
    rows, columns = (axis / 64 - 1 for axis in grid(shape))
    outwards = rows * rows * rows * rows + columns * columns * columns * columns
    land = 0.12 + fractal(random, shape, 48, 5, 0.55) - 0.9 * outwards
    height = 60 * land
    for stage, (steps, years) in enumerate(STAGES):
        if stage:
            cell /= 2
            height, land = refined(random, 1.5, height, land)
            land += 0.06 * fractal(random, land.shape, 16, 3, 0.6)
        sea = land <= 0
        height = np.where(sea, 0, np.maximum(height, 0.5))
        rock = np.clip(1 + 0.5 * fractal(random, height.shape, 30 * 2**stage, 4, 0.6), 0.3, 2.0)
        height, area = evolve(
            height, sea, random, _settling(sea, cell, years),
            cell=cell, steps=steps, years=years,
            uplift=6e-4 * np.clip(2.2 * land, 0.05, 1.3), erodibility=6e-6 * rock,
        )  # fmt: skip
    # the plains of the rivers, then a platform a few metres up with cliffs behind it
    height = floodplains(height, area, cell, width=0.08, rise=0.008)
    inland = distance_transform_edt(~sea)
    reach = 5 + 9 * fractal(random, height.shape, 50, 3)
    platform = np.where(inland <= reach, 3 + 0.012 * cell * inland, np.inf)
    height = fallen(np.minimum(height, platform), 1.3 * cell, 30)
    return np.where(sea, 0, crept(height, 0.1))


def _settling(sea: Mask, cell: float, years: float) -> Callable[[Field], Field]:
    """Return what slopes do in a step: rock falls, soil creeps, the sea stays."""

    def settle(height: Field) -> Field:
        return np.where(sea, 0, crept(fallen(height, 0.8 * cell, 2), 0.012 * years / cell**2))

    return settle
