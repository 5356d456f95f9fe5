"""Displacement decals: dents where something hit a mesh, and segments only where they reach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import each, finite, flag, list_of, one_of, positive
from ..camera.camera import Point, point
from ..device import layout
from ..device.device import Device, DeviceArray
from ..errors import InputError
from ..mesh.mesh import Mesh
from ..mesh.queries import MeshQueries
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from .displaced import moved_mesh
from .displaced_maps import checked_map
from .patch_factors import checked_factor
from .patched_mesh import PatchedMesh, require_curvable
from .pn import DevicePatchMesh

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
    factor: float = 15.0,
    *,
    elsewhere: float = 1.0,
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
        as the map has samples along a triangle.
    elsewhere : float, optional
        Segments of all others.
    curved : bool, optional
        Dent the PN-triangles. By default what no decal reaches keeps its plane triangles.
    partitioning : {"fractional_odd", "fractional_even", "integer", "pow2"}, optional
    device : Device, optional

    Returns
    -------
    Mesh
        Closed where `mesh` is. Normals are those of the dented surface, split where the mesh's are.

    Raises
    ------
    InputError
        If the mesh is not sound, a decal is no Decal, the map is no finite raster, or a factor
        is out of range.
    DeviceMemoryError
        If the device cannot hold the mesh.

    Notes
    -----
    *DirectX 11 tessellation*, slides of 2010: decal tessellation, displacement adaptive.
    """
    require_curvable(mesh)
    one_of("partitioning", partitioning, layout.PARTITIONINGS)
    factor, elsewhere = checked_factor("factor", factor), checked_factor("elsewhere", elsewhere)
    plane = not flag("curved", curved)
    raster = checked_map(depths)
    records = np.array(
        [decal.record(mesh.origin) for decal in list_of("decals", decals, Decal)], layout.DECAL
    )
    device = Device.of(device)
    with device.timed() as timeline:
        base = PatchedMesh.upload(mesh, device, plane=plane)
        factors = reach_on_device(base.patches, base.nets, records, factor, elsewhere)

        def move(_: DevicePattern, positions: DeviceArray) -> None:
            dent_on_device(positions, records, raster)

        return moved_mesh(base, factors, partitioning, move, timeline)


def reach_on_device(
    mesh: DevicePatchMesh,
    nets: DeviceArray,
    decals: npt.NDArray[np.void],
    factor: float,
    elsewhere: float,
) -> DeviceFactors:
    """Return `factor` for edges and insides that any ``layout.DECAL`` record reaches.

    An edge, if the hit is within the radius of it. An inside, if one of its edges is reached, or if
    the hit is above the triangle, and within the radius of its plane.
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
        nets=nets,
        reached=reached,
    )
    device.kernel("curved/decal_reach.cl", "patches")(
        (count,),
        (_GROUP,),
        triangles=count,
        decal_count=len(decals),
        factor=factor,
        elsewhere=elsewhere,
        decals=hits,
        edges=mesh.edges,
        reached=reached,
        nets=nets,
        edge_factors=made.edge,
        inside_factors=made.inside,
    )
    return made


def dent_on_device(
    positions: DeviceArray, decals: npt.NDArray[np.void], depths: npt.NDArray[np.float32]
) -> None:
    """Move (N, 3) `positions` by all of the ``layout.DECAL`` records."""
    if not len(decals):
        return
    device, count = positions.device, positions.shape[0]
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
        positions=positions,
    )


def _point(vector: Array) -> Point:
    x, y, z = vector.tolist()
    return x, y, z
