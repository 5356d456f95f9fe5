"""A city: streets on a hillside, blocks on level terraces, flat roofs, towers, parks and a river.

Steps everywhere: the hardest ground for a mesh of few triangles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from terrain_lod.heightmaps.noise import (
    Field,
    Random,
    fractal,
    grid,
    looked_up,
)

CELL, SHAPE = 2.0, (513, 513)
# streets run along (12, 5) / 13 and across it, 22.6 degrees off the grid
ALONG, ACROSS = 12 / 13, 5 / 13
BLOCKS = 30  # in each direction, more than are seen
STREET, AVENUE = 13.0, 26.0  # metres; every third street is an avenue
STOREY = 3.5
QUAY, RIVER = 7.0, 48.0  # metres, the height of the quays and the width of the water
DOWNTOWN, STADIUM = (180, 340), (400, 415)  # row and column


@dataclass(frozen=True)
class Strips:
    """Blocks and the streets after them, in one direction."""

    number: npt.NDArray[np.int64]  # (R, C), the block that a sample is in or after
    offset: Field  # (R, C), metres from the near side of that block
    depth: Field  # (R, C), metres inside the block, not positive on a street
    middle: Field  # (BLOCKS,), position of the middle of each block, metres


def city(seed: int) -> Field:
    """Return the heights of 1.0 x 1.0 km on cells of 2 m; (513, 513)."""
    random = Random(seed)
    rows, columns = grid(SHAPE)
    x = _strips(random, (ALONG * columns + ACROSS * rows) * CELL, 70, 110)
    y = _strips(random, (ALONG * rows - ACROSS * columns) * CELL + 500, 50, 75)
    # hills on both banks of a winding river
    course = 130 + 60 * fractal(random, SHAPE, 230, 2)[:, 256:257] + 0.2 * rows
    from_water = np.abs(columns - course) * CELL - RIVER / 2
    hill = QUAY + np.clip(from_water / 500, 0, 1) * (60 + 40 * fractal(random, SHAPE, 200, 3))
    # the middle of each block, as row and column
    along, across = x.middle / CELL, (y.middle[:, None] - 500) / CELL
    middle = ACROSS * along + ALONG * across, ALONG * along - ACROSS * across
    # a block is a terrace with something on it
    level = np.round(looked_up(hill, *middle))[y.number, x.number]
    depth = np.minimum(x.depth, y.depth)
    block = level + _buildings(random, x, y, depth, middle)
    height = np.where((depth > 0) & (from_water > 18), block, hill)
    height = _with_stadium(height, hill)
    # water between quay walls, with avenues on bridges
    bridge = (y.depth <= 0) & (y.number % 3 == 0)
    return np.where(from_water < 0, np.where(bridge, QUAY + 1, 0), height)


def _strips(random: Random, position: Field, narrowest: float, widest: float) -> Strips:
    """Return how positions in metres fall into blocks and streets."""
    width = np.round(narrowest + (widest - narrowest) * random.uniform(BLOCKS))
    street = np.where(np.arange(BLOCKS) % 3 == 0, AVENUE, STREET)
    start = np.cumsum(width + street) - width - street
    number = np.searchsorted(start[1:], position, side="right")
    offset = position - start[number]
    return Strips(number, offset, np.minimum(offset, width[number] - offset), start + width / 2)


def _buildings(
    random: Random, x: Strips, y: Strips, depth: Field, middle: tuple[Field, Field]
) -> Field:
    """Return what stands on each block, in metres above its terrace; (R, C)."""
    block = y.number, x.number
    kind, size = random.uniform(BLOCKS, BLOCKS), random.uniform(BLOCKS, BLOCKS)
    away = np.sqrt((middle[0] - DOWNTOWN[0]) ** 2 + (middle[1] - DOWNTOWN[1]) ** 2)
    # houses shoulder to shoulder around a yard with sheds; a lot is 19 by 23 metres
    lot = block[0] * 6 + (y.offset // 19).astype(int), block[1] * 6 + (x.offset // 23).astype(int)
    storeys = random.uniform(6 * BLOCKS + 6, 6 * BLOCKS + 6)[lot]
    houses = np.where(depth < 16, np.floor(4 + 5 * storeys), np.floor(1.2 * storeys))
    # a tower on a broad base steps back twice; it is tall in the middle of the town
    tall = np.floor((12 + 26 * size) * np.clip(1.25 - away / 260, 0.4, 1))[block]
    steps = [depth > 24, depth > 18, depth > 12, depth > 5]
    tower = np.select(steps, [tall + 4, tall, np.floor(0.6 * tall), np.full(SHAPE, 4.0)], 0)
    # slabs side by side; what is left is park
    slabs = np.where((x.offset % 32 < 13) & (depth > 4), 9.0, 0)
    is_tower = ((away < 75) & (kind < 0.85)) | (kind < 0.07)
    kinds = [is_tower[block], (kind < 0.72)[block], (kind < 0.86)[block]]
    return STOREY * np.where(depth > 2, np.select(kinds, [tower, houses, slabs], 0), 0)


def _with_stadium(height: Field, hill: Field) -> Field:
    """Return `height` with rows of seats around a field, sunk into a level square."""
    rows, columns = grid(SHAPE)
    down, along = (rows - STADIUM[0]) * CELL, (columns - STADIUM[1]) * CELL
    away = np.sqrt(down * down + along * along / 2)
    ground = np.round(hill[STADIUM])
    seats = ground - 6 + 1.5 * np.floor((away - 40) / 3)
    rings = [away < 40, away < 76, away < 96]
    return np.select(rings, [np.full(SHAPE, ground - 6), seats, np.full(SHAPE, ground)], height)
