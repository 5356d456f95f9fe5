"""Vertices that float: one height for all points at a place, fitted to the samples around.

The kernels, and what they minimise: ``kernels/terrain/floating.cl``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from ..device.device import DeviceArray
from ..tessellation.pattern import DevicePattern
from .buffers import PatchSet

_PASSES: Final = 16
_GROUP: Final = 64
_NOBODY: Final = -1
_INFINITE: Final = int(np.float32(np.inf).view(np.int32))


@dataclass(frozen=True, eq=False)
class Vertices:
    """The vertices of N points of a pattern, and where they stand.

    Attributes
    ----------
    places : DeviceArray, (N, 4) int32
        Of the points: cells, and fractions in 1/65536 of a cell, east and south.
    table : DeviceArray, int32
        Where points are found by their places.
    numbers : DeviceArray, (N,) int32
        Of the vertex of each point: one of the points at its place, which stands for all.
    above : DeviceArray, (N,) float32
        Of those that stand for all: height above the ground.
    """

    places: DeviceArray
    table: DeviceArray
    numbers: DeviceArray
    above: DeviceArray

    @property
    def found(self) -> dict[str, Any]:
        """What finds these vertices in a later round."""
        return {
            "earlier_places": self.places,
            "earlier_last": self.table.size - 1,
            "earlier_table": self.table,
            "earlier_heights": self.above,
        }


def fit_heights(
    patches: PatchSet,
    pattern: DevicePattern,
    allowed: DeviceArray,
    *,
    passes: int = _PASSES,
    before: Vertices | None = None,
) -> tuple[Vertices, PatchSet]:
    """Move the vertices of a pattern until its triangles are within what patches allow.

    Parameters
    ----------
    patches : PatchSet
    pattern : DevicePattern
    allowed : DeviceArray, (P,) float32
        Vertical error of each patch.
    passes : int
        How often all vertices are moved; patches that nothing pulls at are left alone.
    before : Vertices, optional
        Those that stand at the same places begin where they were.

    Returns
    -------
    vertices : Vertices
    patches : PatchSet
        Whose points stand there: those that share a place at the same height, to the bit.

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold the vertices.
    """
    device, count = patches.device, pattern.points.shape[0]
    group = device.group_size(_GROUP)
    slots = 1 << max(2 * count - 1, 1).bit_length()
    device.require(f"heights of {count} vertices", 32 * count, 29 * count, 4 * slots)
    items = device.runs(patches.count) * group

    # looked at where they will be measured
    defines = replace(patches, is_lifted=True).defines

    def run(name: str, items: int, **arguments: Any) -> None:
        kernel = device.kernel("terrain/floating.cl", name, GROUP=group, **defines)
        kernel((items,), (group,), **arguments)

    shared = {"patches": patches.count, "point_offsets": pattern.point_offsets}
    placed = {**patches.ground.arguments, **patches.arguments, **shared}
    places, corners = device.empty((count, 4), np.int32), device.empty((count, 4), np.float32)
    run("put_points", items, **placed, points=pattern.points, places=places, corners=corners)
    table = device.empty(slots, np.int32).fill(_NOBODY)
    numbers, finest = (device.empty(count, np.int32) for _ in range(2))
    finest.fill(_INFINITE)
    run(
        "weld",
        patches.count,
        **shared,
        places=places,
        allowed=allowed,
        last=slots - 1,
        table=table,
        vertices=numbers,
        finest=finest,
    )
    vertices = Vertices(places, table, numbers, device.zeros(count, np.float32))
    of_vertices = {"count": count, "vertices": numbers}
    if before is not None:
        run(
            "recall",
            count,
            **of_vertices,
            places=places,
            **before.found,
            heights_above=vertices.above,
        )
    last = vertices.above.copy(0, count)
    moved, asking = device.zeros(count, np.uint8), device.zeros(patches.count, np.uint8).fill(1)
    sums = {"pulls": device.zeros(count, np.int32), "weights": device.zeros(count, np.int32)}
    moving = {"finest": finest, "heights_above": vertices.above, "moved": moved, **sums}
    for _ in range(passes):
        run(
            "pull",
            items,
            **placed,
            **moving,
            details=patches.details,
            triangle_offsets=pattern.primitive_offsets,
            triangles=pattern.primitives,
            corners=corners,
            vertices=numbers,
            allowed=allowed,
            asking=asking,
            scratch=group * 4,
        )
        run("move", count, **of_vertices, **moving, before=last)
    lifts = device.empty(count, np.float32)
    run("spread", count, **of_vertices, heights_above=vertices.above, lifts=lifts)
    return vertices, patches.lifted(lifts)
