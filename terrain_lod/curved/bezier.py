"""Bicubic Bézier patches through the tessellator."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from ..arguments import array
from ..device.device import Device
from ..files.meshes.bpt import as_nets, load_bpt
from ..mesh.mesh import Mesh
from ..mesh.vertices import DeviceVertices
from ..tessellation.pattern import DevicePattern
from .uniform_quads import uniform_mesh


def bezier(
    patches: npt.ArrayLike | str | Path,
    *,
    factor: float = 5.0,
    partitioning: str = "fractional_odd",
    device: Device | None = None,
) -> Mesh:
    """Return the mesh of bicubic Bézier patches.

    Patches whose edges have the same control points, in whichever direction, have the same
    vertices there to the bit: no cracks. Vertices are not shared between patches, as normals may
    differ.

    Parameters
    ----------
    patches : (P, 4, 4, 3) or (P, 16, 3) array_like, or path
        Control points [patch, along u, along v], used in float32; or a .bpt file, see
        :func:`terrain_lod.curved.load_bpt`.
    factor : float, optional
        Tessellation factor of all edges and insides, clamped to the partitioning's range.
    partitioning : {"integer", "pow2", "fractional_odd", "fractional_even"}, optional
    device : Device, optional

    Returns
    -------
    Mesh
        Triangles counter-clockwise seen from the side of the normals, which is that of
        dP/du × dP/dv. Where a patch is collapsed into a point, the normal is the limit on the way
        to the middle of the patch: always of unit length.

    Raises
    ------
    InputError
        If there are not 16 control points a patch, one is not finite, or the factor is not
        positive.
    FileError
        If the file cannot be read.
    DeviceMemoryError
        If the mesh does not fit the device.
    """
    nets = load_bpt(patches) if isinstance(patches, str | Path) else as_nets(patches)
    points = array("control points", nets, nets.shape, np.float32)
    device = Device.of(device)
    padded = np.zeros((len(points), 16, 4), np.float32)
    padded[..., :3] = points.reshape(-1, 16, 3)

    def evaluate(pattern: DevicePattern, vertices: DeviceVertices, items: int, group: int) -> None:
        device.kernel("curved/bezier.cl", "bezier", GROUP=group)(
            (items,),
            (group,),
            patches=len(points),
            nets=device.array(padded),
            point_offsets=pattern.point_offsets,
            points=pattern.points,
            positions=vertices.positions,
            normals=vertices.normals,
        )

    return uniform_mesh(len(points), factor, partitioning, device, evaluate)
