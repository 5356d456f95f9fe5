"""The domain stage: points of patches become points of the ground, with its normals."""

from __future__ import annotations

from ..mesh.vertices import DeviceVertices
from ..tessellation.pattern import DevicePattern
from .buffers import PatchSet


def displace_on_device(patches: PatchSet, pattern: DevicePattern) -> DeviceVertices:
    """Put every point of `pattern` on the ground.

    Heights are bilinear between samples; normals are the ground's own, from a Sobel operator in
    world units, not those of the triangles.

    Parameters
    ----------
    patches : PatchSet
    pattern : DevicePattern
        Of quads, one a patch.

    Returns
    -------
    DeviceVertices

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold the vertices.

    Notes
    -----
    Zink, Pettineo, Hoxley: *Practical Rendering and Computation with Direct3D 11*, section 9.1.1,
    step 3.
    """
    device = patches.device
    count = pattern.points.shape[0]
    vertices = DeviceVertices.empty(device, count)
    group = device.group_size(64)
    built = {"GROUP": group, "LANES": device.lanes, **patches.defines}
    kernel = device.kernel("terrain/domain.cl", "domain", **built)
    kernel(
        (device.runs(patches.count) * group,),
        (group,),
        **patches.ground.arguments,
        **patches.arguments,
        patches=patches.count,
        point_offsets=pattern.point_offsets,
        points=pattern.points,
        positions=vertices.positions,
        normals=vertices.normals,
    )
    return vertices
