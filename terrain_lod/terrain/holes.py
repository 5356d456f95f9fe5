"""Ground without data is not covered: triangles that reach into it are left out."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..device.scan import exclusive_scans
from ..tessellation.pattern import DevicePattern
from .buffers import PatchSet

_GROUP: Final = 16


def without_holes_on_device(patches: PatchSet, pattern: DevicePattern) -> DevicePattern:
    """Return `pattern` without the triangles that share an area with a cell that lacks a sample.

    Parameters
    ----------
    patches : PatchSet
        On ground with holes.
    pattern : DevicePattern
        Of quads, one a patch.

    Returns
    -------
    DevicePattern
        Fewer triangles, and the points that they use.
    """
    device, ground = patches.device, patches.ground
    count = pattern.primitives.shape[0]
    kept = device.empty(count, np.uint8)
    point_count = pattern.points.shape[0]
    used = device.empty(point_count, np.uint8)
    counts, point_counts = (device.empty(patches.count, np.uint32) for _ in range(2))
    device.kernel("terrain/holes.cl", "count_kept", **patches.defines)(
        (patches.count,),
        (_GROUP,),
        **ground.arguments,
        **patches.arguments,
        patches=patches.count,
        details=patches.details,
        point_offsets=pattern.point_offsets,
        points=pattern.points,
        triangle_offsets=pattern.primitive_offsets,
        triangles=pattern.primitives,
        kept=kept,
        used=used,
        counts=counts,
        point_counts=point_counts,
    )
    (offsets, total), (point_offsets, used_total) = exclusive_scans(counts, point_counts)
    triangles = device.empty((total, 3), np.int32)
    points = device.empty((used_total, 2), np.uint32)
    device.kernel("terrain/holes.cl", "copy_kept", **patches.defines)(
        (patches.count,),
        (_GROUP,),
        patches=patches.count,
        point_offsets=pattern.point_offsets,
        points=pattern.points,
        triangle_offsets=pattern.primitive_offsets,
        triangles=pattern.primitives,
        kept=kept,
        used=used,
        kept_offsets=offsets,
        used_offsets=point_offsets,
        renumbered=device.empty(point_count, np.uint32),
        kept_triangles=triangles,
        used_points=points,
    )
    return DevicePattern(points, triangles, point_offsets, offsets)
