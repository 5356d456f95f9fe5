"""How much of the sky each sample of the ground sees: soft light for pictures.

Heights stand within a border as wide as the farthest look, lower than any ground::

    b b b b b b b      looks go to whole samples, so that their distances are exact; the farthest
    b b . . . b b      is 64 samples away
    b b . . . b b
    b b b b b b b
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from ..device.device import Device
from ..ground.heightmap import Heightmap

DIRECTIONS: Final = 12
_REACHES: Final = (1, 2, 3, 5, 8, 12, 18, 27, 42, 64)
"""How far looks go along each direction, in samples."""
BORDER: Final = _REACHES[-1]

_LANES: Final = 8
_GROUP: Final = (4, 64)  # so square that what its looks reach stays in a core's cache
_BELOW: Final = float(np.finfo(np.float32).min)


def looks() -> npt.NDArray[np.int32]:
    """Return steps south and east of every look; (DIRECTIONS, L, 2)."""
    turns = 2 * np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    ways = np.stack([-np.cos(turns), np.sin(turns)], axis=-1)
    steps = np.rint(ways[:, None] * np.array(_REACHES)[None, :, None])
    whole: npt.NDArray[np.int32] = steps.astype(np.int32)
    return whole


def sky_seen(ground: Heightmap, device: Device) -> npt.NDArray[np.float32]:
    """Return the share of the sky's light that each sample has; (R, C) in 0..1.

    Samples without data count as the lowest ground.

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold the raster twice.
    """
    rows, columns = ground.shape
    lanes = -(-columns // _LANES)
    stride = _LANES * lanes + 2 * BORDER
    device.require(ground, 4 * stride * (rows + 2 * BORDER), 4 * rows * lanes * _LANES)
    bordered = np.full((rows + 2 * BORDER, stride), _BELOW, np.float32)
    within = bordered[BORDER : BORDER + rows, BORDER : BORDER + columns]
    within[:] = ground.heights
    if ground.mask is not None:
        within[ground.mask] = ground.heights[~ground.mask].min()
    steps = looks()
    distances = np.hypot(steps[..., 0] * ground.spacing[1], steps[..., 1] * ground.spacing[0])
    seen = device.empty((rows, lanes * _LANES), np.float32)
    kernel = device.kernel("terrain/sky.cl", "sky", DIRECTIONS=DIRECTIONS, LOOKS=steps.shape[1])
    kernel(
        (-(-lanes // _GROUP[0]) * _GROUP[0], -(-rows // _GROUP[1]) * _GROUP[1]),
        _GROUP,
        rows=rows,
        lanes=lanes,
        stride=stride,
        first=BORDER * stride + BORDER,
        heights=device.array(bordered),
        offsets=device.array(steps[..., 0] * np.int32(stride) + steps[..., 1]),
        nearnesses=device.array((1 / distances).astype(np.float32)),
        seen=seen,
    )
    return np.ascontiguousarray(seen.host()[:, :columns])
