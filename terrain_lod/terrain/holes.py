"""Ground without data is not covered: triangles that reach into it are left out."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from ..device.scan import exclusive_scan
from ..tessellation.pattern import DevicePattern
from .tiles import DeviceTiles

_GROUP: Final = 16


def without_holes_on_device(tiles: DeviceTiles, pattern: DevicePattern) -> DevicePattern:
    """Return `pattern` without the triangles that share an area with a cell that lacks a sample.

    Parameters
    ----------
    tiles : DeviceTiles
        Of ground with holes.
    pattern : DevicePattern
        Of quads, one a tile, row by row.

    Returns
    -------
    DevicePattern
        The same points, fewer triangles.
    """
    device, ground, patches = tiles.device, tiles.ground, tiles.grid.count
    count = pattern.primitives.shape[0]
    kept = device.empty(count, np.uint8)
    counts = device.empty(patches, np.uint32)
    device.kernel("terrain/holes.cl", "count_kept", **ground.defines)(
        (patches,),
        (_GROUP,),
        **ground.arguments,
        details=tiles.analysis.details,
        points=pattern.points,
        triangle_offsets=pattern.primitive_offsets,
        triangles=pattern.primitives,
        kept=kept,
        counts=counts,
    )
    offsets, total = exclusive_scan(counts)
    triangles = device.empty((total, 3), np.int32)
    device.kernel("terrain/holes.cl", "copy_kept", **ground.defines)(
        (patches,),
        (_GROUP,),
        patches=patches,
        triangle_offsets=pattern.primitive_offsets,
        triangles=pattern.primitives,
        kept=kept,
        kept_offsets=offsets,
        kept_triangles=triangles,
    )
    return replace(pattern, primitives=triangles, primitive_offsets=offsets)
