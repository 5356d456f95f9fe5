"""Plane, deviation and range of every tile, in float64: what ``terrain/analysis.cl`` computes."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ...ground.grid import TileGrid
from ...ground.heightmap import Heightmap

Array = npt.NDArray[np.float64]


class TileFit(NamedTuple):
    """One tile: unit normal (3,), height at the centre, deviation, minimum, maximum, holes."""

    normal: Array
    height: float
    deviation: float
    minimum: float
    maximum: float
    nodata: int


def fit_tile(
    heights: Array, known: npt.NDArray[np.bool_], spacing: tuple[float, float], plane: str
) -> TileFit:
    """Fit one tile of (rows, columns) `heights`; x east, y south from its centre, in cells."""
    rows, columns = heights.shape
    holes = int(heights.size - known.sum())
    if not known.any():
        nan = float("nan")
        return TileFit(np.array([0.0, 0.0, 1.0]), nan, nan, nan, nan, holes)
    y, x = np.nonzero(known)
    x, y, z = x - (columns - 1) / 2, y - (rows - 1) / 2, heights[known]
    if plane == "corners" and not holes:
        slope_x, slope_y = _corner_slopes(heights, spacing)
    else:
        # the pseudo-inverse gives the flattest plane where samples lie on one line
        about_mean = np.stack([x - x.mean(), y - y.mean()], axis=1)
        slope_x, slope_y = np.linalg.pinv(about_mean) @ (z - z.mean())
    height = z.mean() - slope_x * x.mean() - slope_y * y.mean()
    normal = np.array([-slope_x / spacing[0], slope_y / spacing[1], 1.0])
    normal /= np.linalg.norm(normal)
    distance = (z - height - slope_x * x - slope_y * y) * normal[2]
    deviation = np.sqrt((distance**2).sum() / max(len(z) - 1, 1))
    return TileFit(normal, height, deviation, z.min(), z.max(), holes)


def _corner_slopes(heights: Array, spacing: tuple[float, float]) -> tuple[float, float]:
    """Return the slopes a cell of the mean of the four corners' unit normals."""
    across, down = (
        (extent - 1) * step for extent, step in zip(heights.shape[::-1], spacing, strict=True)
    )
    (nw, ne), (sw, se) = heights[:: len(heights) - 1, :: heights.shape[1] - 1]
    total = np.zeros(3)
    for east in (ne - nw, se - sw):
        for south in (sw - nw, se - ne):
            normal = np.array([-east / across, -south / down, 1.0])
            total += normal / np.linalg.norm(normal)
    return -total[0] / total[2] * spacing[0], -total[1] / total[2] * spacing[1]


def analyse(ground: Heightmap, *, tile: int = 15, plane: str = "least_squares") -> list[TileFit]:
    """Return the fit of every tile, row by row; heights relative to the heightmap's base."""
    grid = TileGrid.of(ground, tile)
    heights, known = ground.heights.astype(np.float64), ground.valid
    corner_rows, corner_columns = grid.corner_rows, grid.corner_columns
    return [
        fit_tile(
            heights[top : bottom + 1, left : right + 1],
            known[top : bottom + 1, left : right + 1],
            ground.spacing,
            plane,
        )
        for top, bottom in pairwise(corner_rows)
        for left, right in pairwise(corner_columns)
    ]
