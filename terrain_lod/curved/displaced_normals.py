"""Normals of a surface whose points were moved, on the device."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from ..device.device import DeviceArray
from ..device.layout import PARTITIONINGS
from ..mesh.open_edges import weld
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from .adjacency import Adjacency
from .pn import DevicePatchMesh

_GROUP: Final = 64


def renew_normals_on_device(
    mesh: DevicePatchMesh,
    kinds: tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]],
    factors: DeviceFactors,
    partitioning: str,
    pattern: DevicePattern,
    positions: DeviceArray,
    normals: DeviceArray,
) -> None:
    """Replace the (N, 3) `normals` of a pattern's points by those of the triangles around each.

    Weighted by area, over all patches that meet at the point with the same normals of the mesh:
    what was smooth stays smooth, what was sharp stays sharp. Normals are kept where no triangle has
    an area.

    Parameters
    ----------
    mesh : DevicePatchMesh
    kinds : (K + 1,) and (3 T,) int32
        See :func:`corner_kinds`.
    factors, partitioning, pattern
        What the points come from.
    positions, normals : DeviceArray, (N, 3) float32
        Of the points, after they were moved.

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold the sums.
    """
    device, count = mesh.device, positions.shape[0]
    device.require(f"normals of {count} vertices", 12 * count)
    sums = device.empty((count, 3), np.float32)
    number = PARTITIONINGS.index(partitioning)
    tessellation = {
        "partitioning": number,
        "edge_factors": factors.edge,
        "inside_factors": factors.inside,
        "point_offsets": pattern.point_offsets,
        "sums": sums,
    }
    group = device.group_size(_GROUP)
    device.kernel("curved/displaced_normals.cl", "faces")(
        (mesh.count,),
        (group,),
        patches=mesh.count,
        point_offsets=pattern.point_offsets,
        triangle_offsets=pattern.primitive_offsets,
        triangles=pattern.primitives,
        positions=positions,
        sums=sums,
    )
    device.kernel("curved/displaced_normals.cl", "edges")(
        (mesh.sides.shape[0],),
        (group,),
        edge_count=mesh.sides.shape[0],
        sides=mesh.sides,
        patches=mesh.patches,
        mesh_normals=mesh.normals,
        positions=positions,
        **tessellation,
    )
    offsets, members = kinds
    device.kernel("curved/displaced_normals.cl", "corners")(
        (len(offsets) - 1,),
        (group,),
        kinds=len(offsets) - 1,
        offsets=device.array(offsets),
        members=device.array(members),
        **tessellation,
    )
    device.kernel("curved/displaced_normals.cl", "normalise")(
        (count,), (_GROUP,), points=count, sums=sums, normals=normals
    )


def corner_kinds(
    vertices: npt.NDArray[np.float32], normals: npt.NDArray[np.float32], adjacency: Adjacency
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.int32]]:
    """Return the corners of T triangles sorted into K kinds, the same position and normal each.

    Returns
    -------
    offsets : (K + 1,) int32
        Where each kind begins among the members.
    members : (3 T,) int32
        3 triangle + corner.
    """
    corners = adjacency.patches[:, :3].ravel()
    points, ways = weld(vertices), weld(normals)
    _, kind = np.unique((points * (ways.max(initial=0) + 1) + ways)[corners], return_inverse=True)
    members = np.argsort(kind, kind="stable").astype(np.int32)
    offsets = np.concatenate([[0], np.cumsum(np.bincount(kind))]).astype(np.int32)
    return offsets, members
