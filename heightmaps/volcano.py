"""A volcano: a cone gullied by rain, then young ash cones, lava flows and the crater."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.ndimage import distance_transform_edt
from terrain_lod.heightmaps.erosion import (
    Mask,
    crept,
    evolve,
    fallen,
    route,
)
from terrain_lod.heightmaps.noise import (
    Field,
    Random,
    fractal,
    grid,
    refined,
)

# steps, and years of each, on cells of 60, 30 and 15 m
STAGES = ((12, 5_000.0), (12, 4_000.0), (12, 2_500.0))
CELL = 15.0
# places are rows and columns of the finest grid, sizes are metres
SUMMIT = (300, 340)
CRATER_FLOOR, CRATER_RADIUS = 2080.0, 150.0
# row, column, height, radius
ASH_CONES = (
    (452, 222, 230, 520), (490, 290, 150, 380), (195, 478, 190, 450), (395, 500, 120, 330),
    (180, 170, 130, 380),
)  # fmt: skip
# row and column of the vent, length in steps, width and thickness in metres
LAVAS = ((340, 352, 190, 190, 32), (270, 306, 170, 150, 24), (472, 222, 150, 150, 22))


def volcano(seed: int) -> Field:
    """Return the heights of 7.7 x 7.7 km on cells of 15 m; (513, 513)."""
    random = Random(seed)
    cell, shape = 4 * CELL, (161, 161)
    # concave flanks: 34 degrees at the top, a few at the foot
    away = _away(random, shape, *SUMMIT, cell, 0.06)
    flank = 1 + away / 5200 + (away / 4200) * (away / 4200)
    height = 480 + 2250 / (flank * flank) + 45 * fractal(random, shape, 50, 5)
    for stage, (steps, years) in enumerate(STAGES):
        if stage:
            cell /= 2
            (height,) = refined(random, 3.0, height)
            height += 6 / 2**stage * fractal(random, height.shape, 12, 3)
        border = np.ones(height.shape, bool)
        border[1:-1, 1:-1] = False
        rock = np.clip(1 + 0.5 * fractal(random, height.shape, 40 * 2**stage, 4, 0.6), 0.3, 2.0)
        height, _ = evolve(
            height, border, random, _settling(cell, years),
            cell=cell, steps=steps, years=years, erodibility=6e-6 * rock,
        )  # fmt: skip
    for ash_cone in ASH_CONES:
        height = _with_ash_cone(random, height, *ash_cone)
    for lava in LAVAS:
        height = _with_lava(random, height, border, *lava)
    # the crater: a flat floor and steep walls; where the cone is low its rim is open
    away = _away(random, height.shape, *SUMMIT, CELL, 0.1)
    height = np.minimum(height, CRATER_FLOOR + 1.1 * np.maximum(0, away - CRATER_RADIUS))
    return crept(height, 0.1, 2)[64:-64, 64:-64]


def _settling(cell: float, years: float) -> Callable[[Field], Field]:
    """Return what slopes do in a step: rock falls, soil creeps."""
    return lambda height: crept(fallen(height, 0.85 * cell, 3), 0.004 * years / cell**2)


def _away(
    random: Random, shape: tuple[int, int], row: int, column: int, cell: float, wobble: float
) -> Field:
    """Return the distance in metres from a place, uneven by `wobble`."""
    rows, columns = grid(shape)
    down, along = rows * cell - row * CELL, columns * cell - column * CELL
    return np.sqrt(down * down + along * along) * (
        1 + wobble * fractal(random, shape, 2400 / cell, 4)
    )


def _with_ash_cone(
    random: Random, height: Field, row: int, column: int, top: float, radius: float
) -> Field:
    """Return `height` with a smooth small cone that buries the gullies, and the bowl in its top."""
    away = _away(random, height.shape, row, column, CELL, 0.08) / radius
    cone = crept(height, 0.25, 100) + top * np.minimum(1 - away, 0.5 + 1.5 * away)
    return np.maximum(height, cone)


def _with_lava(
    random: Random, height: Field, border: Mask, row: int, column: int,
    length: int, width: float, thickness: float,
) -> Field:  # fmt: skip
    """Return `height` with a lava flow: down the way of water, with blunt sides and a lobe."""
    smooth = crept(height, 0.25, 60)
    receiver = route(smooth, border, np.full(height.shape, 0.41)).receiver
    sample, vein = row * height.shape[1] + column, np.zeros(height.size, bool)
    for _ in range(length):
        vein[sample], sample = True, receiver[sample]
    away = distance_transform_edt(~vein.reshape(height.shape)) * CELL
    side = away * (1 + 0.5 * fractal(random, height.shape, 24, 4, 0.6)) / width
    square = side * side
    return np.maximum(height, smooth + thickness - 100 * square * square)
