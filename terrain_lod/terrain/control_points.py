"""Control points of the patches: the corners of all tiles, and which twelve each patch holds."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from ..device.device import DeviceArray
from .buffers import DeviceAnalysis, DeviceGround, DevicePatches

_GROUP: Final = 64


def patch_indices(tile_rows: int, tile_columns: int) -> npt.NDArray[np.int32]:
    """Return the index buffer of the 12-control-point patches.

    Control points are the corners of all tiles, (TR + 1) x (TC + 1), row by row. A patch holds

    - 0 1 2 3: its own corners, north-west, north-east, south-west, south-east
    - 4 5: the far corners of the neighbour at u = 1, east
    - 6 7: at v = 1, south
    - 8 9: at u = 0, west
    - 10 11: at v = 0, north

    ::

              10 --- 11
               |     |
         8 --- 0 --- 1 --- 4
         |     |     |     |
         9 --- 2 --- 3 --- 5
               |     |
               6 --- 7

    clamped to the border of the terrain, so that a missing neighbour's midpoint is the midpoint
    of the edge.

    Returns
    -------
    (P, 12) int32

    Notes
    -----
    Zink, Pettineo, Hoxley: *Practical Rendering and Computation with Direct3D 11*, listing 9.2
    and figure 9.5; its x is u here, its z is v.
    """
    # steps from the patch's north-western corner, row then column
    steps = np.array(
        [
            *[(0, 0), (0, 1), (1, 0), (1, 1)],
            *[(0, 2), (1, 2), (2, 0), (2, 1)],
            *[(0, -1), (1, -1), (-1, 0), (-1, 1)],
        ]
    )
    row, column = np.indices((tile_rows, tile_columns)).reshape(2, -1, 1)
    rows = np.clip(row + steps[:, 0], 0, tile_rows)
    columns = np.clip(column + steps[:, 1], 0, tile_columns)
    indices: npt.NDArray[np.int32] = (rows * (tile_columns + 1) + columns).astype(np.int32)
    return indices


def patches_on_device(ground: DeviceGround, analysis: DeviceAnalysis) -> DevicePatches:
    """Return the patches of all tiles, their corners on the ground."""
    indices = ground.device.array(patch_indices(*ground.grid.shape))
    return DevicePatches(control_points_on_device(ground, analysis), indices)


def control_points_on_device(ground: DeviceGround, analysis: DeviceAnalysis) -> DeviceArray:
    """Put the corners of all tiles on the ground; (TR + 1, TC + 1, 4) float32.

    Those without data stand at the lowest height there is.
    """
    rows, columns = ground.grid.shape
    points = ground.device.empty((rows + 1, columns + 1, 4), np.float32)
    kernel = ground.device.kernel("terrain/control_points.cl", "control_points", **ground.defines)
    kernel(
        ((rows + 1) * (columns + 1),),
        (_GROUP,),
        **ground.arguments,
        # of tiles: samples are hundreds of times as many
        fallback=float(np.nanmin(analysis.details.host()[..., 1])),
        points=points,
    )
    return points
