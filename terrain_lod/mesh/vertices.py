"""What a domain stage leaves on the device."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..device.device import Device, DeviceArray


@dataclass(frozen=True, eq=False)
class DeviceVertices:
    """The domain stage's output.

    Attributes
    ----------
    positions : DeviceArray, (N, 3) float32
        Relative to the terrain's origin and base.
    normals : DeviceArray, (N, 3) float32
    """

    positions: DeviceArray
    normals: DeviceArray

    @classmethod
    def empty(cls, device: Device, count: int) -> DeviceVertices:
        """Return room for so many, or refuse it with the bytes wanted and had."""
        device.require(f"{count} vertices", 12 * count, 12 * count)
        return cls(*(device.empty((count, 3), np.float32) for _ in range(2)))
