"""Seeded noise that is the same, bit for bit, on every machine.

Random numbers are the raw stream of PCG64, which NumPy promises never to change; everything else
here and in the grounds is + - x / and sqrt, which IEEE 754 rounds in one way only. No exp, no
sin, no library filter: machines differ in the last bit of those, and rivers amplify it.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Field = npt.NDArray[np.float64]


class Random:
    """Uniform numbers in 0..1 from one seed."""

    def __init__(self, seed: int) -> None:
        self._bits = np.random.PCG64(seed)

    def uniform(self, *shape: int) -> Field:
        """Return numbers of 53 random bits each; `shape`."""
        raw = np.asarray(self._bits.random_raw(int(np.prod(shape))))
        return (raw >> np.uint64(11)).astype(np.float64).reshape(shape) / 2.0**53


def grid(shape: tuple[int, int]) -> tuple[Field, Field]:
    """Return the row and the column of every sample; (R, 1) and (1, C)."""
    rows, columns = np.arange(float(shape[0])), np.arange(float(shape[1]))
    return rows[:, None], columns[None]


def gradient_noise(random: Random, shape: tuple[int, int], period: float) -> Field:
    """Return noise around 0, about -1 to 1, with bumps some `period` samples across; `shape`.

    K. Perlin, "Improving noise", SIGGRAPH 2002: a random slope at each lattice point, blended with
    the fade 6 t^5 - 15 t^4 + 10 t^3.
    """
    y, x = (axis / period for axis in grid(shape))
    lattice = int(y[-1, 0]) + 2, int(x[0, -1]) + 2
    slope_y, slope_x = random.uniform(*lattice) * 2 - 1, random.uniform(*lattice) * 2 - 1
    j, i = y.astype(int), x.astype(int)
    v, u = y - j, x - i
    fade_v, fade_u = (t * t * t * (t * (t * 6 - 15) + 10) for t in (v, u))
    total = np.zeros(shape)
    for dj, weight_v in ((0, 1 - fade_v), (1, fade_v)):
        for di, weight_u in ((0, 1 - fade_u), (1, fade_u)):
            node = j + dj, i + di
            total += weight_v * weight_u * (slope_y[node] * (v - dj) + slope_x[node] * (u - di))
    return total * 1.8


def fractal(
    random: Random, shape: tuple[int, int], period: float, octaves: int, gain: float = 0.5
) -> Field:
    """Return a sum of noises, each half as wide and `gain` times as high as the last; `shape`."""
    total, amplitude = np.zeros(shape), 1.0
    for _ in range(octaves):
        total += amplitude * gradient_noise(random, shape, period)
        period, amplitude = period / 2, amplitude * gain
    return total


def doubled(field: Field) -> Field:
    """Return `field` with cells of half the size; (R, C) to (2 R - 1, 2 C - 1).

    Catmull-Rom at the midpoints: (-1, 9, 9, -1) / 16.
    """
    for axis in (0, 1):
        f = np.moveaxis(field, axis, 0)
        p = np.concatenate([f[:1], f, f[-1:]])
        field = np.empty((2 * len(f) - 1, *f.shape[1:]))
        field[::2], field[1::2] = f, (9 * (p[1:-2] + p[2:-1]) - (p[:-3] + p[3:])) / 16
        field = np.moveaxis(field, 0, axis)
    return np.ascontiguousarray(field)


def looked_up(field: Field, rows: Field, columns: Field) -> Field:
    """Return `field` at fractional rows and columns, bilinear, clamped at the border."""
    y = np.clip(rows, 0, field.shape[0] - 1)
    x = np.clip(columns, 0, field.shape[1] - 1)
    j = np.minimum(y.astype(int), field.shape[0] - 2)
    i = np.minimum(x.astype(int), field.shape[1] - 2)
    v, u = y - j, x - i
    upper = field[j, i] * (1 - u) + field[j, i + 1] * u
    lower = field[j + 1, i] * (1 - u) + field[j + 1, i + 1] * u
    between: Field = upper * (1 - v) + lower * v
    return between


def refined(random: Random, wiggle: float, *fields: Field) -> list[Field]:
    """Return each field doubled, all bent alike by some `wiggle` of the new cells.

    The bending takes rivers off the eight directions of the coarse grid.
    """
    finer = [doubled(field) for field in fields]
    shape = finer[0].shape
    rows, columns = grid(shape)
    rows = rows + wiggle * fractal(random, shape, 32, 4, 0.6)
    columns = columns + wiggle * fractal(random, shape, 32, 4, 0.6)
    return [looked_up(field, rows, columns) for field in finer]
