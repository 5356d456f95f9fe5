"""Ground and detail in one, in float64: what kernels find that include ``terrain/ground.h``."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...ground.heightmap import Heightmap

Array = npt.NDArray[np.float64]


def elevations(ground: Heightmap, detail: Heightmap, steps: tuple[int, int]) -> Array:
    """Return the elevations of the sum, NaN where there is no data; ((R - 1) * down + 1, ...).

    One sample after the other, from weights of the four samples of the ground around it.
    """
    across, down = steps
    rows, columns = (ground.shape[0] - 1) * down + 1, (ground.shape[1] - 1) * across + 1
    row, column = np.indices((rows, columns))
    total = np.zeros((rows, columns))
    known = ground.elevation
    for r in (row // down, -(-row // down)):
        for c in (column // across, -(-column // across)):
            # on a line of samples both neighbours are the same, and have half the weight each
            weight_r = np.where(row % down, 1 - np.abs(row / down - r), 0.5)
            weight_c = np.where(column % across, 1 - np.abs(column / across - c), 0.5)
            total += weight_r * weight_c * known[r, c]
    repeated = detail.elevation[row % detail.shape[0], column % detail.shape[1]]
    result: Array = total + repeated
    return result
