"""Device memory for patterns, counted before any of it is taken."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..device.device import Device, DeviceArray
from ..errors import InputError

_LARGEST_INDEX_COUNT: Final = 2**31


def room_for_pattern(
    device: Device, patches: int, point_count: int, primitive_count: int, corners: int
) -> tuple[DeviceArray, DeviceArray]:
    """Return arrays for points and primitives, or refuse before allocating either.

    Raises
    ------
    InputError, DeviceMemoryError
        If there would be too many indices, or too many bytes.
    """
    index_count = corners * primitive_count
    if index_count > _LARGEST_INDEX_COUNT:
        raise InputError(
            f"expected at most {_LARGEST_INDEX_COUNT} indices, got {index_count} from {patches} "
            "patches: use smaller factors or fewer patches at a time"
        )
    what = f"a pattern of {point_count} points and {index_count} indices"
    device.require(what, 8 * point_count, 4 * index_count)
    return (
        device.empty((point_count, 2), np.uint32),
        device.empty((primitive_count, corners), np.int32),
    )
