"""Errors of tiles and edges at pairs of odd factors, in float64: ``kernels/terrain/ladder.cl``."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import numpy.typing as npt

from ...ground.grid import TileGrid
from ...ground.heightmap import Heightmap
from .analysis import TileFit

Array = npt.NDArray[np.float64]


def lattice_heights(heights: Array, fu: int, fv: int) -> Array:
    """Return a tile's heights at fu x fv segments, bilinear in its samples; (fv + 1, fu + 1)."""
    rows, columns = heights.shape
    across = np.linspace(0, columns - 1, fu + 1)
    down = np.linspace(0, rows - 1, fv + 1)
    lines = np.stack([np.interp(across, np.arange(columns), row) for row in heights])
    return np.stack([np.interp(down, np.arange(rows), line) for line in lines.T], axis=1)


def tile_errors(heights: Array, fu: int, fv: int) -> tuple[float, float]:
    """Return the largest distance of the lattice's triangles to the samples (rows, columns).

    Of all samples, and of those that lie within the lattice's outermost inner lines.
    """
    rows, columns = heights.shape
    lattice = lattice_heights(heights, fu, fv)
    # where each sample lies in the lattice
    x = np.arange(columns) * fu / (columns - 1)
    y = np.arange(rows) * fv / (rows - 1)
    i = np.minimum(x.astype(int), fu - 1)
    j = np.minimum(y.astype(int), fv - 1)[:, None]
    a, b = x - i, y[:, None] - j
    z00, z10 = lattice[j, i], lattice[j, i + 1]
    z01, z11 = lattice[j + 1, i], lattice[j + 1, i + 1]
    # diagonals: falling north-west and south-east of the middle, rising elsewhere
    falling = ((j < fv // 2) & (i <= fu // 2)) | ((j > fv // 2) & (i >= fu // 2))
    below = np.where(
        a >= b, z00 + (z10 - z00) * a + (z11 - z10) * b, z00 + (z01 - z00) * b + (z11 - z01) * a
    )
    beside = np.where(
        a + b <= 1,
        z00 + (z10 - z00) * a + (z01 - z00) * b,
        z11 + (z01 - z11) * (1 - a) + (z10 - z11) * (1 - b),
    )
    errors = np.abs(np.where(falling, below, beside) - heights)
    row, column = -(-(rows - 1) // fv), -(-(columns - 1) // fu)
    inner = errors[row : rows - row, column : columns - column]
    return float(errors.max()), float(inner.max(initial=0.0))


def edge_error(line: Array, factor: int) -> float:
    """Return the largest distance of `factor` segments to the samples of an edge."""
    samples = np.arange(len(line))
    ends = np.linspace(0, len(line) - 1, factor + 1)
    return float(np.abs(np.interp(samples, ends, np.interp(ends, samples, line)) - line).max())


def ladder(
    ground: Heightmap, grid: TileGrid, fits: list[TileFit]
) -> tuple[Array, Array, Array, Array]:
    """Return errors of tiles and of inner samples (P, L, L), of edges across and down (., L)."""
    heights = ground.heights.astype(np.float64)
    factors = 2 * np.arange(grid.levels) + 1
    of_tiles = []
    rows, columns = list(pairwise(grid.corner_rows)), list(pairwise(grid.corner_columns))
    for index, (row, column) in enumerate((row, column) for row in rows for column in columns):
        tile = heights[row[0] : row[1] + 1, column[0] : column[1] + 1]
        cells = tile.shape[0] - 1, tile.shape[1] - 1
        errors = np.full((2, grid.levels, grid.levels), np.inf)
        for v, u in np.ndindex(errors.shape[1:]):
            fv, fu = (
                min(int(factors[level]), limit) for level, limit in zip((v, u), cells, strict=True)
            )
            # a tile with holes is always meshed in full
            if not fits[index].nodata or (fv, fu) == cells:
                errors[:, v, u] = tile_errors(tile, fu, fv)
        of_tiles.append(errors)

    def edges(lines: list[Array]) -> Array:
        return np.array(
            [[edge_error(line, min(int(f), len(line) - 1)) for f in factors] for line in lines]
        )

    across = [heights[row, a : b + 1] for row in grid.corner_rows for a, b in columns]
    down = [heights[a : b + 1, column] for a, b in rows for column in grid.corner_columns]
    every, inner = np.swapaxes(of_tiles, 0, 1)
    return every, inner, edges(across), edges(down)
