"""Quad patches through the tessellator, and the meshes on them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import one_of, positive
from ..device.device import Device
from ..device.layout import PARTITIONINGS
from ..mesh.mesh import Mesh
from ..mesh.vertices import DeviceVertices
from ..tessellation.pattern import DevicePattern
from ..tessellation.semi_uniform import LARGEST_LEVEL, semi_uniform_device
from ..tessellation.tessellator import tessellate_device

SEMI_UNIFORM: Final = "semi_uniform"

Evaluate = Callable[[DevicePattern, DeviceVertices, int, int], None]
"""Takes points, the vertices to fill, the work-items in all and those of a group."""


def uniform_mesh(
    patches: int, factor: float, partitioning: str, device: Device, evaluate: Evaluate
) -> Mesh:
    """Return the mesh of `patches` quads with one `factor`; see :func:`quad_mesh`.

    Raises
    ------
    InputError
        If the factor is not positive, `partitioning` is unknown, or there are too many indices.
    DeviceMemoryError
        If the mesh does not fit the device.
    """
    factor = positive("factor", factor)
    with np.errstate(over="ignore"):  # to infinity, which is clamped
        edges, insides = (np.full((patches, width), factor, np.float32) for width in (4, 2))
    return quad_mesh(edges, insides, partitioning, device, evaluate)


def quad_mesh(
    edges: npt.NDArray[np.float32],
    insides: npt.NDArray[np.float32],
    partitioning: str,
    device: Device,
    evaluate: Evaluate,
) -> Mesh:
    """Return the mesh of P quads with (P, 4) and (P, 2) factors, vertices filled by `evaluate`.

    Triangles are counter-clockwise seen from the side that dP/du x dP/dv points to.

    Raises
    ------
    InputError
        If `partitioning` is unknown, or there are too many indices.
    DeviceMemoryError
        If the mesh does not fit the device.
    """
    one_of("partitioning", partitioning, (*PARTITIONINGS, SEMI_UNIFORM))
    if not len(edges):
        nothing = np.empty((0, 3), np.float32)
        return Mesh(nothing, nothing, np.empty((0, 3), np.int32))
    with device.timed() as timeline:
        # clockwise with v down is counter-clockwise with v up
        if partitioning == SEMI_UNIFORM:
            levels = np.log2(np.clip(edges, 1, 2**LARGEST_LEVEL)).astype(np.float32)
            pattern = semi_uniform_device(
                device.array(levels), maximum=LARGEST_LEVEL, keep_degenerate=False, clockwise=True
            )
        else:
            pattern = tessellate_device(
                "quad", device.array(edges), device.array(insides), partitioning, clockwise=True
            )
        count = pattern.points.shape[0]
        vertices = DeviceVertices.empty(device, count)
        group = device.group_size(64)
        groups = device.runs(len(edges))
        evaluate(pattern, vertices, groups * group, group)
        return Mesh(
            vertices.positions.host(),
            vertices.normals.host(),
            pattern.primitives.host(),
            timings=timeline.seconds,
        )
