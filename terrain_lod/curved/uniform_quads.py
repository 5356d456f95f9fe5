"""Quad patches that are all divided alike, and the meshes on them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arguments import one_of, positive
from ..device.device import Device
from ..device.layout import PARTITIONINGS
from ..mesh.mesh import Mesh
from ..mesh.vertices import DeviceVertices
from ..tessellation.pattern import DevicePattern
from ..tessellation.tessellator import tessellate_device

Evaluate = Callable[[DevicePattern, DeviceVertices, int, int], None]
"""Takes points, the vertices to fill, the work-items in all and those of a group."""


def uniform_mesh(
    patches: int, factor: float, partitioning: str, device: Device, evaluate: Evaluate
) -> Mesh:
    """Return the mesh of `patches` quads with one `factor`, its vertices filled by `evaluate`.

    Triangles are counter-clockwise seen from the side that dP/du x dP/dv points to.

    Raises
    ------
    InputError
        If the factor is not positive, `partitioning` is unknown, or there are too many indices.
    DeviceMemoryError
        If the mesh does not fit the device.
    """
    factor = positive("factor", factor)
    one_of("partitioning", partitioning, PARTITIONINGS)
    if patches == 0:
        nothing = np.empty((0, 3), np.float32)
        return Mesh(nothing, nothing, np.empty((0, 3), np.int32))
    with np.errstate(over="ignore"):  # to infinity, which is clamped
        edges, insides = (np.full((patches, width), factor, np.float32) for width in (4, 2))
    with device.timed() as timeline:
        # clockwise with v down is counter-clockwise with v up
        pattern = tessellate_device(
            "quad", device.array(edges), device.array(insides), partitioning, clockwise=True
        )
        count = pattern.points.shape[0]
        vertices = DeviceVertices.empty(device, count)
        group = device.group_size(64)
        groups = device.runs(patches)
        evaluate(pattern, vertices, groups * group, group)
        return Mesh(
            vertices.positions.host(),
            vertices.normals.host(),
            pattern.primitives.host(),
            timings=timeline.seconds,
        )
