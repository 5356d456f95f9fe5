"""Eroded ridges: a mountain range between two plains, lifted and cut by rivers at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from terrain_lod.heightmaps.erosion import (
    crept,
    evolve,
    fallen,
    floodplains,
    steepness,
)
from terrain_lod.heightmaps.noise import (
    Field,
    Random,
    fractal,
    gradient_noise,
    refined,
)

# steps, and years of each, on cells of 160, 80, 40 and 20 m
STAGES = ((150, 25_000.0), (60, 10_000.0), (40, 5_000.0), (24, 2_500.0))
REPOSE = 0.8  # slope above which rock falls: 39 degrees
CREEP = 0.015  # square metres a year


def ridge(seed: int) -> Field:
    """Return the heights of 20.5 x 20.5 km on cells of 20 m; (1025, 1025)."""
    random = Random(seed)
    cell, shape = 160.0, (161, 161)
    height = 30 + 60 * fractal(random, shape, 70, 6)
    uplift = 1e-3 * (1 + 0.35 * fractal(random, shape, 80, 2))
    rock = 1 + 0.5 * fractal(random, shape, 40, 5, 0.7)
    for stage, (steps, years) in enumerate(STAGES):
        if stage:
            cell /= 2
            height, uplift, rock = refined(random, 2.5, height, uplift, rock)
            rock += 0.3 * gradient_noise(random, rock.shape, 6)
        # the plains lie to the north and south
        plain = np.zeros(height.shape, bool)
        plain[[0, -1]] = True
        height, area = evolve(
            height, plain, random, _settling(cell, years),
            cell=cell, steps=steps, years=years,
            uplift=uplift, erodibility=4e-6 * np.clip(rock, 0.4, 2.0),
        )  # fmt: skip
    # valleys wide enough for a road, and outcrops where it is steep
    height = floodplains(height, area, cell, width=0.02, rise=0.01)
    height = fallen(height, REPOSE * cell, 60)
    outcrops = fractal(random, height.shape, 12, 3, 0.6)
    height = crept(height + 6 * outcrops * np.clip(steepness(height, cell) - 0.2, 0, 1), 0.1, 2)
    return height[128:-128, 128:-128]


def _settling(cell: float, years: float) -> Callable[[Field], Field]:
    """Return what slopes do in a step: rock falls, soil creeps."""
    return lambda height: crept(fallen(height, REPOSE * cell, 2), CREEP * years / cell**2)
