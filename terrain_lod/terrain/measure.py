"""The finished triangles of patches, measured at every sample of the ground."""

from __future__ import annotations

import numpy as np

from ..device.device import DeviceArray
from ..tessellation.pattern import DevicePattern
from .buffers import PatchSet


def measure_patches(
    patches: PatchSet, pattern: DevicePattern, wanted: DeviceArray, errors: DeviceArray
) -> None:
    """Measure the largest error of each patch that is `wanted`; others keep theirs.

    Parameters
    ----------
    patches : PatchSet
    pattern : DevicePattern
        Of one quad a patch.
    wanted : DeviceArray, (P,) uint8
    errors : DeviceArray, (P,) float32
        In the raster's unit; a bound where patches are measured on a lattice.
    """
    device = patches.device
    group = device.group_size(64)
    defines = {"GROUP": group, "LANES": device.lanes, **patches.defines}
    device.kernel("terrain/tile_error.cl", "tile_error", **defines)(
        (device.runs(patches.count) * group,),
        (group,),
        **patches.ground.arguments,
        **patches.arguments,
        details=patches.details,
        patches=patches.count,
        changed=wanted,
        point_offsets=pattern.point_offsets,
        points=pattern.points,
        triangle_offsets=pattern.primitive_offsets,
        triangles=pattern.primitives,
        corners=device.empty((pattern.points.shape[0], 4), np.float32),
        errors=errors,
        scratch=group * 4,
    )
