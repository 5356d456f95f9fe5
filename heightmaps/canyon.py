"""A canyon: a river sinks into a plateau of hard and soft layers, each with a slope of its own."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from terrain_lod.heightmaps.erosion import (
    crept,
    evolve,
    fallen,
    floodplains,
)
from terrain_lod.heightmaps.noise import (
    Field,
    Random,
    fractal,
    gradient_noise,
    grid,
    refined,
)

# steps, and years of each, on cells of 120, 60, 30 and 15 m
STAGES = ((60, 20_000.0), (30, 10_000.0), (20, 6_000.0), (10, 3_000.0))
RIM, RIVER = 2100.0, 750.0  # metres: the plateau, and the river where it leaves
# thickness in metres and slope, from above the rim down, after the walls of the Grand Canyon: a
# limestone cliff, a slope, a sandstone cliff, shale, ledges, the great red wall, a broad bench of
# shale, a last cliff, and the gorge in old hard rock
STRATA = np.array([
    (400, 0.5), (90, 2.2), (80, 0.6), (110, 2.6), (90, 0.5), (30, 2.0), (45, 0.6), (30, 2.0),
    (45, 0.6), (30, 2.0), (45, 0.6), (150, 2.6), (60, 0.8), (110, 0.3), (60, 2.2), (600, 0.9),
])[::-1]  # fmt: skip
# a wall that is LEVEL[k] high stands REACH[k] metres back from its foot
LEVEL = np.cumsum([RIM + 400 - STRATA[:, 0].sum(), *STRATA[:, 0]])
REACH = np.cumsum([0.0, *(STRATA[:, 0] / STRATA[:, 1])])


def canyon(seed: int) -> Field:
    """Return the heights of 15.4 x 15.4 km on cells of 15 m; (1025, 1025)."""
    random = Random(seed)
    cell, shape = 120.0, (161, 161)
    rows, columns = grid(shape)
    # the plateau dips to the east; a winding trough shows the river where to begin
    course = 80 + 45 * fractal(random, shape, 50, 3, 0.6)[80]
    trough = 2.5 * np.minimum(np.abs(rows - course), 16)
    height = RIM - 40 + 0.2 * (160 - columns) + trough + 30 * fractal(random, shape, 40, 5)
    dip = 12 * fractal(random, shape, 60, 2)
    rock = 1 + 0.4 * fractal(random, shape, 30, 4, 0.6)
    rough = 1 + 0.3 * fractal(random, shape, 12, 4, 0.6)
    for stage, (steps, years) in enumerate(STAGES):
        if stage:
            cell /= 2
            height, dip, rock, rough = refined(random, 2.0, height, dip, rock, rough)
            rough += 0.15 * gradient_noise(random, rough.shape, 5)
        # in from the west with the rain of a large country, out to the east
        finer = 2**stage
        river, mouth = np.zeros(height.shape), np.zeros(height.shape, bool)
        river[int(course[0]) * finer, 0] = 2.5e10
        mouth[int(course[-1]) * finer, -1] = True
        height[mouth] = RIVER
        height, area = evolve(
            height, mouth, random, _settling(dip, rough, cell, years),
            cell=cell, steps=steps, years=years,
            erodibility=0.8e-6 * np.clip(rock, 0.4, 2.0), inflow=river,
        )  # fmt: skip
    height = floodplains(height, area, cell, width=0.0006, rise=0.002)
    height = crept(_walls(height, dip, np.clip(rough, 0.5, 2.0), cell, 150), 0.05)
    return height[128:-128, 128:-128]


def _settling(dip: Field, rough: Field, cell: float, years: float) -> Callable[[Field], Field]:
    """Return what slopes do in a step: cliffs retreat, soil creeps."""
    return lambda height: crept(_walls(height, dip, rough, cell, 2), 0.003 * years / cell**2)


def _walls(height: Field, dip: Field, rough: Field, cell: float, steps: int) -> Field:
    """Return `height` lowered until no layer is steeper than it can stand.

    Measured by how far back a wall of that height stands, every layer has the slope 1, and one
    fall serves them all. `dip` lifts the layers, `rough` steepens them.
    """
    reach = fallen(_along(height - dip, LEVEL, REACH), rough * cell, steps)
    return np.minimum(height, _along(reach, REACH, LEVEL) + dip)


def _along(x: Field, knots: Field, values: Field) -> Field:
    """Return the polyline through (`knots`, `values`) at `x`, its ends prolonged."""
    k = np.clip(np.searchsorted(knots, x, side="right") - 1, 0, len(knots) - 2)
    slope = (values[1:] - values[:-1]) / (knots[1:] - knots[:-1])
    return values[k] + (x - knots[k]) * slope[k]
