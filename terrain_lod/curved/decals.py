"""Displacement decals: dents where something hit a mesh, and segments only where they reach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..arguments import each, finite, flag, list_of, one_of, positive
from ..camera.camera import Camera, Point, point
from ..device import layout
from ..device.device import Device, DeviceArray
from ..errors import InputError
from ..mesh.mesh import Mesh
from ..mesh.queries import MeshQueries
from ..mesh.vertices import DeviceVertices
from ..tessellation.factors import DeviceFactors
from ..tessellation.tessellator import tessellate_device
from .displaced_maps import checked_map
from .patch_factors import EdgeFactor, UniformFactor, checked_factor
from .patched_mesh import PatchedMesh, require_curvable
from .pn import KEEP_ALL, DevicePatchMesh, edge_factors_on_device, evaluate_on_device
from .smooth import back_cosine_of, diagonal_of, from_device, view_for

_GROUP: Final = 64
_RUN: Final = 32  # points that a CPU asks together which decals are near

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Decal:
    """A dent in the tangent plane of a hit.

    Parameters
    ----------
    point : (float, float, float)
        What was hit, in the world.
    normal, tangent : (float, float, float)
        Of the surface there, unit length: out of it, and along the map's rows.
    radius : float
        How far the dent reaches; the depth map spans twice of it.
    scale, bias : float, optional
        Points go ``bias + scale * depth`` into the surface, in world units.
    """

    point: Point
    normal: Point
    tangent: Point
    radius: float
    scale: float = 1.0
    bias: float = 0.0

    def __post_init__(self) -> None:
        for name, check in (("radius", positive), ("scale", finite), ("bias", finite)):
            object.__setattr__(self, name, check(name, getattr(self, name)))
        for name in ("point", "normal", "tangent"):
            object.__setattr__(self, name, point(name, getattr(self, name)))
        for name in ("normal", "tangent"):
            if not abs(np.linalg.norm(getattr(self, name)) - 1) < 1e-3:
                raise InputError(f"expected a {name} of length 1, got {getattr(self, name)}")

    def record(self, origin: Array) -> npt.NDArray[np.void]:
        """Return the ``layout.DECAL`` record relative to `origin`."""
        record = np.zeros((), layout.DECAL)
        record["point"] = np.subtract(self.point, origin)
        for name in ("normal", "tangent", "radius", "scale", "bias"):
            record[name] = getattr(self, name)
        return record


def shoot(
    mesh: Mesh,
    origins: npt.ArrayLike,
    directions: npt.ArrayLike,
    radius: float | npt.ArrayLike,
    *,
    scale: float | npt.ArrayLike = 1.0,
    bias: float | npt.ArrayLike = 0.0,
    device: Device | None = None,
) -> tuple[Decal, ...]:
    """Return decals where rays first hit a mesh.

    Parameters
    ----------
    mesh : Mesh
    origins, directions : (N, 3) array_like
        Where the rays begin in the world and where they go; one of either serves all.
    radius, scale, bias : float or (N,) array_like
        Of the decals, one for all or one a ray.
    device : Device, optional

    Returns
    -------
    tuple of Decal
        In the order of the rays; those that miss leave none.

    Raises
    ------
    InputError
        If the rays or numbers are not such, not finite, or a direction is zero; if the mesh is not
        sound.
    DeviceError
        If the device has no 64-bit floats.
    DeviceMemoryError
        If the device cannot hold the mesh and the lists of its triangles.
    """
    hits = MeshQueries(mesh, device=device).cast(origins, directions)
    numbers = {
        name: each(name, values, (len(hits),))
        for name, values in (("radius", radius), ("scale", scale), ("bias", bias))
    }
    return tuple(
        Decal(
            _point(hits.position[ray]),
            _point(hits.normal[ray]),
            _along_horizon(hits.normal[ray]),
            **{name: float(values[ray]) for name, values in numbers.items()},
        )
        for ray in np.flatnonzero(hits.hit)
    )


def _along_horizon(normal: Array) -> Point:
    """Return a tangent along the horizon, where there is one across `normal`."""
    level = np.cross([0, 0, 1], normal)
    tangent = level if np.linalg.norm(level) > 1e-6 else np.array([1.0, 0.0, 0.0])
    tangent = tangent - normal * (tangent @ normal)
    return _point(tangent / np.linalg.norm(tangent))


def dent(
    mesh: Mesh,
    decals: Sequence[Decal],
    depths: npt.ArrayLike,
    factor: float | None = None,
    *,
    elsewhere: float = 1.0,
    lod: EdgeFactor | None = None,
    camera: Camera | None = None,
    cull: bool = True,
    back_faces: float | None = None,
    curved: bool = False,
    partitioning: str = "fractional_odd",
    device: Device | None = None,
) -> Mesh:
    """Press decals into a mesh, tessellating only the patches that they reach.

    Parameters
    ----------
    mesh : Mesh
    decals : sequence of Decal
        Any number; where they overlap, their depths add up.
    depths : (R, C) array_like
        The map that they share; bilinear, its first row at the top.
    factor : float, optional
        Segments where a decal reaches an edge, or the inside of a triangle, 1 to 64; about as many
        as the map has samples along a triangle. Defaults to 15.
    elsewhere : float, optional
        Segments of all others.
    lod : EdgeFactor, optional
        A formula for the segments where decals reach, instead.
    camera : Camera, optional
        Where detail is wanted.
    cull : bool, optional
        Refine nothing that is out of the camera's view.
    back_faces : float, optional
        Refine no decal all of whose patches are turned away from the camera, by more than this
        cosine: 0 refines the least. For closed meshes; by default all are refined. Decals that
        raise the surface are refined all the same, since they may show over its outline.
    curved : bool, optional
        Dent the PN-triangles. By default what no decal reaches keeps its plane triangles.
    partitioning : {"fractional_odd", "fractional_even", "integer", "pow2"}, optional
    device : Device, optional

    Returns
    -------
    Mesh
        Closed where `mesh` is. What is not refined is there, with `elsewhere` segments. Normals are
        those of the mesh, turned as the dents turn its surface, and split where the mesh's are.

    Raises
    ------
    InputError
        If the mesh is not sound, a decal is no Decal, the map is no finite raster, a factor
        is out of range, or there is no camera to look through.
    DeviceMemoryError
        If the device cannot hold the mesh.

    Notes
    -----
    *DirectX 11 tessellation*, slides of 2010: decal tessellation, displacement adaptive,
    back-face culling.
    """
    require_curvable(mesh)
    one_of("partitioning", partitioning, layout.PARTITIONINGS)
    elsewhere, plane = checked_factor("elsewhere", elsewhere), not flag("curved", curved)
    back_cosine = back_cosine_of(back_faces, camera)
    view = view_for(mesh, factor, lod, camera)
    if lod is None:
        lod = UniformFactor(checked_factor("factor", 15.0 if factor is None else factor))
    raster = checked_map(depths)
    records = np.array(
        [decal.record(mesh.origin) for decal in list_of("decals", decals, Decal)], layout.DECAL
    )
    device = Device.of(device)
    with device.timed() as timeline:
        base = PatchedMesh.upload(mesh, device, plane=plane)
        segments = edge_factors_on_device(base.patches, lod, diagonal_of(mesh), view)
        in_view, reaching = device.array(np.ones(base.patches.count, np.int32)), records
        if flag("cull", cull) and camera is not None and len(records):
            in_view, seen = views_on_device(base.nets, records, raster, view, back_cosine)
            reaching = records[seen]
        factors = reach_on_device(base.patches, base.nets, reaching, segments, elsewhere, in_view)
        pattern = tessellate_device(
            "triangle", factors.edge, factors.inside, partitioning, clockwise=True
        )
        vertices = evaluate_on_device(base.nets, pattern, linear_normals=plane)
        dent_on_device(vertices, records, raster)
        return from_device(base.mesh, pattern, vertices, timeline)


def views_on_device(
    nets: DeviceArray,
    decals: npt.NDArray[np.void],
    depths: npt.NDArray[np.float32],
    view: npt.NDArray[Any],
    back_cosine: float | None,
) -> tuple[DeviceArray, npt.NDArray[np.bool_]]:
    """Return which patches are in view, (T,) int32, and which ``layout.DECAL`` records, (D,) bool.

    A decal is, where a patch that it reaches is in view and not turned away by `back_cosine`; and
    one that may raise the surface, wherever its patches are turned.
    """
    device, count = nets.device, nets.shape[0]
    ends = decals["bias"] + decals["scale"] * np.array([[depths.min()], [depths.max()]])
    in_view, seen = device.empty(count, np.int32), device.zeros(len(decals), np.int32)
    raises = bool((ends < 0).any())
    device.kernel("curved/decal_reach.cl", "views")(
        (count,),
        (_GROUP,),
        triangles=count,
        decal_count=len(decals),
        view=view,
        back_cosine=KEEP_ALL if back_cosine is None or raises else back_cosine,
        decals=device.array(decals),
        moves=device.array(np.abs(ends).max(axis=0).astype(np.float32)),
        nets=nets,
        in_view=in_view,
        seen=seen,
    )
    return in_view, seen.host() > 0


def reach_on_device(
    mesh: DevicePatchMesh,
    nets: DeviceArray,
    decals: npt.NDArray[np.void],
    segments: DeviceArray,
    elsewhere: float,
    in_view: DeviceArray,
) -> DeviceFactors:
    """Return factors of edges and insides, more of them where ``layout.DECAL`` records reach.

    An edge is reached, if the hit is within the radius of it, and one of its patches in view. An
    inside, if one of its edges is reached, or if the hit is above the triangle, and within the
    radius of its plane.

    Parameters
    ----------
    segments : DeviceArray, (E,) float32
        Of edges that are reached; insides take the most of theirs.
    elsewhere : float
        Of all others.
    in_view : DeviceArray, (T,) int32
    """
    device, count, edges = mesh.device, mesh.count, mesh.sides.shape[0]
    made = DeviceFactors(device.empty((count, 3), np.float32), device.empty((count, 1), np.float32))
    reached = device.zeros(edges, np.int32)
    # no array is empty on a device
    hits = device.array(decals if len(decals) else np.zeros(1, layout.DECAL))
    device.kernel("curved/decal_reach.cl", "edges")(
        (edges,),
        (_GROUP,),
        edge_count=edges,
        decal_count=len(decals),
        decals=hits,
        sides=mesh.sides,
        in_view=in_view,
        nets=nets,
        reached=reached,
    )
    device.kernel("curved/decal_reach.cl", "patches")(
        (count,),
        (_GROUP,),
        triangles=count,
        decal_count=len(decals),
        elsewhere=elsewhere,
        decals=hits,
        factors=segments,
        in_view=in_view,
        edges=mesh.edges,
        reached=reached,
        nets=nets,
        edge_factors=made.edge,
        inside_factors=made.inside,
    )
    return made


def dent_on_device(
    vertices: DeviceVertices, decals: npt.NDArray[np.void], depths: npt.NDArray[np.float32]
) -> None:
    """Move vertices by all of the ``layout.DECAL`` records, and turn their normals."""
    if not len(decals):
        return
    device, count = vertices.positions.device, vertices.positions.shape[0]
    run = 1 if device.is_gpu else _RUN
    device.kernel("curved/decals.cl", "decals", RUN=run)(
        (-(-count // run),),
        (_GROUP,),
        points=count,
        decal_count=len(decals),
        decals=device.array(decals),
        depths=device.array(depths),
        rows=depths.shape[0],
        columns=depths.shape[1],
        positions=vertices.positions,
        normals=vertices.normals,
    )


def _point(vector: Array) -> Point:
    x, y, z = vector.tolist()
    return x, y, z
