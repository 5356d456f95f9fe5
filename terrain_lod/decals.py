"""Displacement decals: dents where something hit a mesh, and segments only where they reach."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from . import layout
from .adjacency import EDGE_ENDS, Adjacency
from .arguments import finite, one_of, positive
from .buffers import DeviceFactors
from .camera import Point
from .device import Device, DeviceArray
from .displaced import checked_map, plane_patches, resurfaced_normals
from .errors import InputError
from .mesh import Mesh
from .patch_factors import checked_factor
from .pn import DevicePatchMesh, evaluate_on_device, nets_on_device
from .smooth import require_curvable, unit_normals
from .tessellator import tessellate_device

_GROUP: Final = 64

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
        positive("radius", self.radius)
        finite("scale", self.scale)
        finite("bias", self.bias)
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
    eye: Point,
    direction: Point,
    radius: float,
    *,
    scale: float = 1.0,
    bias: float = 0.0,
) -> Decal | None:
    """Return the decal where a ray first hits a mesh, or None where it misses.

    Parameters
    ----------
    mesh : Mesh
    eye, direction : (float, float, float)
        Where the ray begins in the world, and where it goes.
    radius, scale, bias : float
        Of the decal.

    Notes
    -----
    T. Möller, B. Trumbore: *Fast, Minimum Storage Ray/Triangle Intersection*, 1997.
    """
    start = np.subtract(eye, mesh.origin)
    ray = np.asarray(direction, np.float64)
    if not np.isfinite(start).all() or not np.linalg.norm(ray) > 0:
        raise InputError(f"expected a ray from a finite point, got {eye} along {direction}")
    ray = ray / np.linalg.norm(ray)
    a, b, c = (mesh.vertices[mesh.triangles[:, k]].astype(np.float64) for k in range(3))
    across = np.cross(np.broadcast_to(ray, a.shape), c - a)
    determinant = np.einsum("ij,ij->i", b - a, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        u = np.einsum("ij,ij->i", start - a, across) / determinant
        along = np.cross(start - a, b - a)
        v = along @ ray / determinant
        distance = np.einsum("ij,ij->i", c - a, along) / determinant
        # not where the ray runs along the triangle: nothing is above or below NaN
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (distance > 0)
    if not hit.any():
        return None
    first = int(np.argmin(np.where(hit, distance, np.inf)))
    normal = np.cross(b[first] - a[first], c[first] - a[first])
    normal /= np.linalg.norm(normal)
    # along the horizon, where there is one
    level = np.cross([0, 0, 1], normal)
    tangent = level if np.linalg.norm(level) > 1e-6 else np.array([1.0, 0.0, 0.0])
    tangent = tangent - normal * (tangent @ normal)
    tangent /= np.linalg.norm(tangent)
    point = start + distance[first] * ray + mesh.origin
    return Decal(_point(point), _point(normal), _point(tangent), radius, scale, bias)


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
        Segments where a decal reaches an edge, or the inside of a triangle, 1 to 64.
    elsewhere : float, optional
        Segments of all others.
    curved : bool, optional
        Dent the PN-triangles instead of the plane ones.
    partitioning : {"fractional_odd", "fractional_even", "integer", "pow2"}, optional
    device : Device, optional

    Returns
    -------
    Mesh
        Closed where `mesh` is. Normals are those of the dented surface, split where the mesh's are.

    Raises
    ------
    InputError
        If the mesh is not sound, the map is no finite raster, or a factor is out of range.
    DeviceMemoryError
        If the device cannot hold the mesh.

    Notes
    -----
    *DirectX 11 tessellation*, slides of 2010: decal tessellation, displacement adaptive.
    """
    require_curvable(mesh)
    one_of("partitioning", partitioning, layout.PARTITIONINGS)
    checked_factor("factor", factor), checked_factor("elsewhere", elsewhere)
    raster = checked_map(depths)
    adjacency = Adjacency.of(mesh)
    device = device or Device.open()
    with device.timed() as timeline:
        patches = DevicePatchMesh.upload(
            mesh.vertices, unit_normals(mesh.normals), adjacency, device
        )
        nets = nets_on_device(patches if curved else plane_patches(patches, adjacency))
        edges, insides = reached(mesh, adjacency, _bulges(nets), decals)
        factors = DeviceFactors(
            *(
                device.array(np.where(reach, factor, elsewhere).astype(np.float32))
                for reach in (edges, insides)
            )
        )
        pattern = tessellate_device(
            "triangle", factors.edge, factors.inside, partitioning, clockwise=True
        )
        vertices = evaluate_on_device(nets, pattern)
        records = np.array([decal.record(mesh.origin) for decal in decals], layout.DECAL)
        dent_on_device(vertices.positions, records, raster)
        dented, before = vertices.positions.host(), vertices.normals.host()
        triangles = pattern.primitives.host()
    normals = resurfaced_normals(dented, before, triangles)
    return replace(
        mesh,
        vertices=dented,
        normals=normals,
        triangles=triangles,
        patches=None,
        timings=timeline.seconds,
    )


def dent_on_device(
    positions: DeviceArray, decals: npt.NDArray[np.void], depths: npt.NDArray[np.float32]
) -> None:
    """Move (N, 3) `positions` by all of the ``layout.DECAL`` records."""
    if not len(decals):
        return
    device, count = positions.device, positions.shape[0]
    device.kernel("decals.cl", "decals")(
        (count,),
        (_GROUP,),
        points=count,
        decal_count=len(decals),
        decals=device.array(decals),
        depths=device.array(depths),
        rows=depths.shape[0],
        columns=depths.shape[1],
        positions=positions,
    )


def reached(
    mesh: Mesh, adjacency: Adjacency, bulges: Array, decals: Sequence[Decal]
) -> tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]]:
    """Return which edges (T, 3) and insides (T, 1) of triangles any decal reaches.

    An edge, if its distance to the hit is within the radius. The inside, if one of its edges is, or
    if the hit is within the radius of the triangle's plane, and above the triangle. The (T,)
    `bulges` are how far curved patches may leave their planes: they add to the radius.
    """
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    starts, ends = corners[:, EDGE_ENDS[:, 0]], corners[:, EDGE_ENDS[:, 1]]
    along = ends - starts
    squares = np.maximum((along**2).sum(axis=-1), np.finfo(np.float64).tiny)
    planes = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.maximum(np.linalg.norm(planes, axis=1, keepdims=True), np.finfo(np.float64).tiny)
    planes = planes / areas
    edges, above = np.zeros(starts.shape[:2], bool), np.zeros(len(corners), bool)
    for decal in decals:
        hit = np.subtract(decal.point, mesh.origin)
        t = np.clip(((hit - starts) * along).sum(axis=-1) / squares, 0, 1)[..., None]
        distances = np.linalg.norm(starts + t * along - hit, axis=-1)
        edges |= distances <= (decal.radius + bulges)[:, None]
        height = np.abs(((hit - corners[:, 0]) * planes).sum(axis=-1))
        sides = (np.cross(along, hit - starts) * planes[:, None]).sum(axis=-1)
        above |= (height <= decal.radius + bulges) & (sides >= 0).all(axis=1)
    # both sides of an edge refine it if one does
    of_edge = np.zeros(len(adjacency.sides), bool)
    np.logical_or.at(of_edge, adjacency.edges, edges)
    shared = of_edge[adjacency.edges]
    return shared, (shared.any(axis=1) | above)[:, None]


def _bulges(nets: DeviceArray) -> Array:
    """Return how far patches may leave their plane triangles; (T,).

    The lifts enter with weights of no more than uv + vw + wu <= 1/3, the middle with uvw <= 1/27.
    """
    lengths = np.linalg.norm(nets.host().astype(np.float64), axis=-1)
    found: Array = lengths[:, 3:9].max(axis=1) / 3 + lengths[:, 9] / 27
    return found


def _point(vector: Array) -> Point:
    x, y, z = vector.tolist()
    return x, y, z
