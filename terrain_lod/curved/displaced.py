"""Displaced meshes: a map of heights along the normals of any mesh, closed across its seams."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ..arguments import finite, flag, one_of
from ..camera.camera import Camera
from ..device import layout
from ..device.device import Device, DeviceArray
from ..mesh.mesh import Mesh
from ..mesh.open_edges import weld
from ..tessellation.pattern import DevicePattern
from ..tessellation.tessellator import tessellate_device
from .adjacency import EDGE_ENDS, Adjacency
from .displaced_maps import checked_map, checked_textures
from .displaced_normals import corner_kinds, renew_normals_on_device
from .patch_factors import EdgeFactor
from .patched_mesh import PatchedMesh, require_curvable
from .pn import evaluate_on_device, patch_factors_on_device
from .smooth import diagonal_of, edge_factors, from_device, view_for


def displace(
    mesh: Mesh,
    heights: npt.ArrayLike,
    textures: npt.ArrayLike | None = None,
    factor: float | npt.ArrayLike | None = None,
    *,
    scale: float = 1.0,
    bias: float = 0.0,
    lod: EdgeFactor | None = None,
    camera: Camera | None = None,
    curved: bool = True,
    partitioning: str = "fractional_odd",
    device: Device | None = None,
) -> Mesh:
    """Tessellate a mesh and move its points along their normals by a map of heights.

    Parameters
    ----------
    mesh : Mesh
    heights : (R, C) array_like
        The map; bilinear between its samples, which stand in the middles of its cells, and repeated
        without end.
    textures : (V, 2) array_like, optional
        Texture coordinates of the mesh's vertices: u to the right, v up, (0, 0) the lower left
        corner of the map, whose last row is the lowest. Defaults to the mesh's own.
    factor : float or (T, 3) array_like, optional
        Segments along the edges, as for :func:`terrain_lod.pn_triangles`;
        :func:`terrain_lod.curved.variation_factors` finds those that the map needs. Defaults to 5.
    scale, bias : float, optional
        Points move by ``bias + scale * height``, in world units.
    lod : EdgeFactor, optional
        A formula for the segments instead, asked about the surface that is not yet displaced.
    camera : Camera, optional
        Where detail is wanted. Nothing is culled.
    curved : bool, optional
        Displace the PN-triangles, or the plane ones.
    partitioning : {"fractional_odd", "fractional_even", "integer", "pow2"}, optional
    device : Device, optional

    Returns
    -------
    Mesh
        Closed where `mesh` is, whatever its texture's seams and split normals: what meets there
        takes its texture coordinates from one side and its direction from the mean of both. Normals
        are those of the displaced surface, and split where the mesh's are.

    Raises
    ------
    InputError
        If the mesh is not sound, the map is no finite raster, or there is not one pair of finite
        texture coordinates a vertex; if a factor is out of range, or a formula needs a camera.
    DeviceMemoryError
        If the device cannot hold the mesh.

    Notes
    -----
    J. McDonald: *Tessellation on Any Budget*, GDC 2011, for dominant edges and corners.
    """
    require_curvable(mesh)
    one_of("partitioning", partitioning, layout.PARTITIONINGS)
    scale, bias, plane = finite("scale", scale), finite("bias", bias), not flag("curved", curved)
    raster, coordinates = checked_map(heights), checked_textures(textures, mesh)
    view = view_for(mesh, factor, lod, camera)
    device = Device.of(device)
    with device.timed() as timeline:
        base = PatchedMesh.upload(mesh, device, plane=plane)
        of_edges = edge_factors(base.patches, base.adjacency, factor, lod, diagonal_of(mesh), view)
        factors = patch_factors_on_device(
            base.patches, base.nets, of_edges, view, cull=False, back_cosine=None
        )

        pattern = tessellate_device(
            "triangle", factors.edge, factors.inside, partitioning, clockwise=True
        )
        vertices = evaluate_on_device(base.nets, pattern)
        positions, normals = vertices.positions, vertices.normals
        displace_on_device(base, raster, coordinates, pattern, positions, scale=scale, bias=bias)
        kinds = corner_kinds(base.mesh.vertices, base.mesh.normals, base.adjacency)
        renew_normals_on_device(
            base.patches, kinds, factors, partitioning, pattern, positions, normals
        )
        return from_device(base.mesh, pattern, vertices, timeline)


def displace_on_device(
    base: PatchedMesh,
    heights: npt.NDArray[np.float32],
    textures: npt.NDArray[np.float32],
    pattern: DevicePattern,
    positions: DeviceArray,
    *,
    scale: float,
    bias: float,
) -> None:
    """Move the (N, 3) `positions` of a pattern's points by a map of heights."""
    mesh, device = base.patches, base.patches.device
    group = device.group_size(32)
    shared = shared_normals(base.mesh.vertices, base.mesh.normals)
    groups = device.runs(mesh.count)
    device.kernel("curved/displaced.cl", "displaced", GROUP=group)(
        (groups * group,),
        (group,),
        patch_count=mesh.count,
        patches=mesh.patches,
        dominant=device.array(dominant_edges(base.adjacency)),
        normals=mesh.normals,
        shared=device.array(shared),
        textures=device.array(textures),
        heights=device.array(heights),
        rows=heights.shape[0],
        columns=heights.shape[1],
        scale=scale,
        bias=bias,
        point_offsets=pattern.point_offsets,
        points=pattern.points,
        positions=positions,
    )


def dominant_edges(adjacency: Adjacency) -> npt.NDArray[np.int32]:
    """Return the vertices that speak for the ends of each patch's edges; (T, 6) int32.

    Those of the edge's first side, in the direction of the patch's own edge.
    """
    corners = adjacency.patches[:, : layout.PATCH_ADJACENT]
    corner_points = adjacency.patches[:, layout.PATCH_DOMINANT :]
    ends = corners[:, EDGE_ENDS].reshape(-1, 2)
    points = corner_points[:, EDGE_ENDS].reshape(-1, 2)
    first = adjacency.sides[adjacency.edges.ravel(), 0]
    same_way = points[first, 0] == points[:, 0]
    chosen = np.where(same_way[:, None], ends[first], ends[first][:, ::-1])
    return np.ascontiguousarray(chosen.reshape(-1, 6), np.int32)


def shared_normals(
    vertices: npt.NDArray[np.float32], normals: npt.NDArray[np.float32]
) -> npt.NDArray[np.float32]:
    """Return the mean of the different normals at each vertex's position; (V, 3) unit length.

    Where they cancel, the first of them.
    """
    points = weld(vertices)
    kinds = weld(normals)
    _, chosen = np.unique(points * (kinds.max(initial=0) + 1) + kinds, return_index=True)
    sums = np.stack(
        [np.bincount(points[chosen], normals[chosen, axis].astype(float)) for axis in range(3)], 1
    )
    lengths = np.linalg.norm(sums, axis=1)
    _, first = np.unique(points, return_index=True)
    lost = lengths < 1e-6
    sums[lost] = normals[first[lost]]
    lengths[lost] = 1.0
    mean: npt.NDArray[np.float32] = (sums / lengths[:, None]).astype(np.float32)[points]
    return mean
