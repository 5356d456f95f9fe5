"""The doctor's checks of what displaced meshes and decals need besides their points."""

from __future__ import annotations

from functools import cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..curved.adjacency import Adjacency
from ..curved.decals import reach_on_device
from ..curved.displaced_normals import corner_kinds, renew_normals_on_device
from ..curved.pn import DevicePatchMesh
from ..device.device import Device
from ..device.layout import DECAL, NET_VECTORS
from ..mesh.mesh import Mesh
from ..reference.curved import displaced
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from ..tessellation.tessellator import tessellate
from .checkup import Check, largest_difference

_NORMALS: Final = 1e-5
# nearer to being reached, or not, than this may go either way
_DECIDED: Final = 1e-5


@cache
def _octahedron() -> Mesh:
    """Return a closed mesh of eight triangles; one pair shares no vertices with the others."""
    points = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])
    triangles = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5)]
    vertices = np.concatenate([points, points[[0, 3, 5]]]).astype(np.float32)
    normals = vertices.copy()
    normals[6:] = np.array([1, -1, -1]) / np.sqrt(3)
    return Mesh(vertices, normals, np.array([*triangles, (6, 7, 8)], np.int32))


def check_displaced_normals(device: Device) -> Check:
    """Return the worst difference of a normal, on smooth edges, sharp ones and inside."""
    mesh, random, partitioning = _octahedron(), np.random.default_rng(11), "fractional_odd"
    adjacency = Adjacency.of(mesh)
    of_edge = random.uniform(1, 7, len(adjacency.sides)).astype(np.float32)
    edge, inside = of_edge[adjacency.edges], np.full((len(mesh.triangles), 1), 4, np.float32)
    pattern = tessellate("triangle", edge, inside, partitioning=partitioning, device=device)
    # the same bits from both sides: whole numbers of 2^-16, moved by their place alone
    patch = np.repeat(np.arange(len(mesh.triangles)), np.diff(pattern.point_offsets))
    u, v = pattern.points.T.astype(np.int64)
    weights = np.stack([u, v, 2**16 - u - v], axis=1)[:, :, None]
    corners = mesh.triangles[patch]
    places = (weights * mesh.vertices[corners].astype(np.int64)).sum(axis=1) / 2.0**16
    moved = (places * (1 + 0.2 * np.sin(5 * places.sum(axis=1, keepdims=True)))).astype(np.float32)
    before = ((weights / 2.0**16) * mesh.normals[corners]).sum(axis=1).astype(np.float32)
    on_device = DevicePattern(
        device.array(pattern.points),
        device.array(pattern.triangles),
        device.array(pattern.point_offsets.astype(np.uint32)),
        device.array(pattern.triangle_offsets.astype(np.uint32)),
    )
    normals = device.array(before)
    renew_normals_on_device(
        DevicePatchMesh.upload(mesh.vertices, mesh.normals, adjacency, device),
        corner_kinds(mesh.vertices, mesh.normals, adjacency),
        DeviceFactors(device.array(edge), device.array(inside)),
        partitioning,
        on_device,
        device.array(moved),
        normals,
    )
    expected = displaced.renewed_normals(moved, before, pattern.triangles)
    return Check(largest_difference(normals.host(), expected), _NORMALS, "of length 1")


def check_decal_reach(device: Device) -> Check:
    """Return how many edges and insides are refined, or not, that should not be."""
    mesh, random = _octahedron(), np.random.default_rng(12)
    adjacency, count = Adjacency.of(mesh), len(mesh.triangles)
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    nets = np.zeros((count, NET_VECTORS, 3), np.float32)
    nets[:, :3], nets[:, 3:10] = corners, random.normal(size=(count, 7, 3)) * 0.05
    lengths = np.linalg.norm(nets.astype(np.float64), axis=-1)
    bulges = lengths[:, 3:9].max(axis=1) / 3 + lengths[:, 9] / 27
    wrong, patches = 0, DevicePatchMesh.upload(mesh.vertices, mesh.normals, adjacency, device)
    for _ in range(40):
        decals = np.zeros(2, DECAL)
        decals["point"] = random.uniform(-0.7, 0.7, (2, 3))
        decals["radius"] = random.uniform(0.02, 0.3, 2)
        found = reach_on_device(patches, device.array(nets), decals, 9.0, 2.0)
        edges, above = displaced.reached(corners, adjacency.edges, bulges, decals)
        insides = np.maximum(edges[adjacency.edges].max(axis=1), above)
        wrong += _unlike(found.edge.host(), edges[adjacency.edges])
        wrong += _unlike(found.inside.host()[:, 0], insides)
    return Check(float(wrong), 0.0, "factors")


def _unlike(factors: npt.NDArray[np.float32], reach: npt.NDArray[Any]) -> int:
    differ = factors != np.where(reach > 0, 9.0, 2.0)
    return int(np.count_nonzero(differ & (np.abs(reach) > _DECIDED)))
