"""What a domain stage leaves on the device."""

from __future__ import annotations

from dataclasses import dataclass

from ..device.device import DeviceArray


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
