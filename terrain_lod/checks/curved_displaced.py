"""Checks of the kernels of displaced meshes and of decals."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..curved.adjacency import Adjacency
from ..curved.decals import dent_on_device, reach_on_device, views_on_device
from ..curved.displaced import displace_on_device, dominant_edges, shared_normals
from ..curved.displaced_normals import corner_kinds, renew_normals_on_device
from ..curved.patched_mesh import PatchedMesh
from ..curved.pn import DevicePatchMesh
from ..device.device import Device
from ..device.layout import DECAL, FIXED_ONE, NET_VECTORS, PARTITIONINGS
from ..mesh.mesh import Mesh
from ..mesh.vertices import DeviceVertices
from ..reference.curved import displaced
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from ..tessellation.tessellator import tessellate
from .check import Bound, Check, Difference
from .curved_pn import Sheet, hard_sheets, sheets
from .tessellation import points_alone

_MOVED: Final = Bound(
    "displacement",
    "units",
    "2e-6",
    "a unit direction times a bilinear height of up to 0.6; a texture coordinate of up to 2 is "
    "rounded to 2^-23 of it before it picks the height among nine",
)


def _displaced(case: Sheet, device: Device) -> Iterator[Difference]:
    """Compare inside, on edges and at corners."""
    random, mesh, patches = np.random.default_rng(9), case.mesh, len(case.mesh.triangles)
    # inside, the three edges, the three corners
    third, half = FIXED_ONE // 3, FIXED_ONE // 2
    u = np.tile([third, 0, half, half, FIXED_ONE, 0, 0], patches)
    v = np.tile([third, half, 0, half, 0, FIXED_ONE, 0], patches)
    pattern = points_alone(np.stack([u, v], axis=1), patches, device)
    heights = random.uniform(size=(9, 7)).astype(np.float32)
    textures = random.uniform(-1, 2, (len(mesh.vertices), 2)).astype(np.float32)
    shared = shared_normals(mesh.vertices, mesh.normals)
    positions = device.zeros((len(u), 3), np.float32)
    base = PatchedMesh(mesh, case.adjacency, case.upload(device), device.array(case.nets))
    displace_on_device(base, heights, textures, pattern, positions, scale=0.5, bias=0.1)
    dominant, expected = dominant_edges(case.adjacency), np.empty((len(u), 3))
    surface = case.surface[1], shared.astype(np.float64), textures.astype(np.float64)
    for i, (a, b) in enumerate(zip(u, v, strict=True)):
        weights = np.array([a, b, FIXED_ONE - a - b]) / FIXED_ONE
        patch = case.adjacency.patches[i // 7], dominant[i // 7]
        direction, (x, y) = displaced.displacement(*patch, *surface, weights)
        height = displaced.bilinear(heights, x % 1.0, y % 1.0, repeats=True)
        expected[i] = direction * (0.1 + 0.5 * height)
    yield _MOVED.met_by(positions.host(), expected, 2e-6)


DISPLACED: Final = Check(_displaced, sheets, hard_sheets)

_DENTED: Final = Bound(
    "position under decals",
    "units",
    "2e-6 of the size of all",
    "as of displacement, for each of five decals in turn",
)

_TURNED: Final = Bound(
    "normal under decals",
    "of length 1",
    "2e-4",
    "slopes of up to 1.3 are differences of depths, a seventh of them apart, whose places are "
    "rounded; where the surface all but folds, a hundredth is left to divide by",
)


def _decals(size: float, device: Device) -> Iterator[Difference]:
    random = np.random.default_rng(10)
    positions = (size * random.uniform(-1, 1, (500, 3))).astype(np.float32)
    depths = random.uniform(size=(6, 8)).astype(np.float32)
    records = np.zeros(5, DECAL)
    for record in records:
        normal = random.normal(size=3)
        tangent = np.cross(normal, random.normal(size=3))
        record["point"] = size * random.uniform(-1, 1, 3)
        record["normal"] = normal / np.linalg.norm(normal)
        record["tangent"] = tangent / np.linalg.norm(tangent)
        record["radius"], record["scale"], record["bias"] = 0.9 * size, 0.3 * size, 0.1 * size
    normals = random.normal(size=(500, 3))
    normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)
    found = DeviceVertices(device.array(positions), device.array(normals))
    dent_on_device(found, records, depths)
    expected = [
        displaced.dented(position, normal, records, depths)
        for position, normal in zip(positions.astype(float), normals.astype(float), strict=True)
    ]
    moved, turned = (np.array(each) for each in zip(*expected, strict=True))
    yield _DENTED.met_by(found.positions.host(), moved, 2e-6 * size)
    yield _TURNED.met_by(found.normals.host(), turned, 2e-4)


DECALS: Final = Check(
    _decals,
    lambda: {"points within 1 unit": 1.0},
    lambda: {f"points within {size:g} units": size for size in (1e-6, 1e6)},
)

_NORMALS: Final = Bound(
    "renewed normal",
    "of length 1",
    "1e-5",
    "triangles' areas of 32-bit differences, added in one order, and made of length 1",
)


@cache
def _octahedron() -> Mesh:
    """Return a closed mesh of eight triangles; one pair shares no vertices with the others."""
    points = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])
    triangles = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5)]
    vertices = np.concatenate([points, points[[0, 3, 5]]]).astype(np.float32)
    normals = vertices.copy()
    normals[6:] = np.array([1, -1, -1]) / np.sqrt(3)
    return Mesh(vertices, normals, np.array([*triangles, (6, 7, 8)], np.int32))


def _normals(partitioning: str, device: Device) -> Iterator[Difference]:
    """Compare on smooth edges, sharp ones and inside."""
    mesh, random = _octahedron(), np.random.default_rng(11)
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
    yield _NORMALS.met_by(normals.host(), expected, 1e-5)


NORMALS: Final = Check(
    _normals,
    lambda: {"octahedron, fractional_odd": "fractional_odd"},
    lambda: {f"octahedron, {name}": name for name in PARTITIONINGS if name != "fractional_odd"},
)

_REACHED: Final = Bound(
    "factors under decals",
    "factors",
    "exact, but for those within 1e-5 of being reached",
    "a distance of a dozen roundings decides",
)


def _reach(together: int, device: Device) -> Iterator[Difference]:
    mesh, random = _octahedron(), np.random.default_rng(12)
    adjacency, count = Adjacency.of(mesh), len(mesh.triangles)
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    nets = np.zeros((count, NET_VECTORS, 3), np.float32)
    nets[:, :3], nets[:, 3:10] = corners, random.normal(size=(count, 7, 3)) * 0.05
    lengths = np.linalg.norm(nets.astype(np.float64), axis=-1)
    bulges = lengths[:, 3:9].max(axis=1) / 3 + lengths[:, 9] / 27
    wrong, patches = 0, DevicePatchMesh.upload(mesh.vertices, mesh.normals, adjacency, device)
    for _ in range(80 // together):
        decals = np.zeros(together, DECAL)
        decals["point"] = random.uniform(-0.7, 0.7, (together, 3))
        decals["radius"] = random.uniform(0.02, 0.3, together)
        in_view = random.uniform(size=count) < 0.7
        found = reach_on_device(
            patches,
            device.array(nets),
            decals,
            device.array(np.full(len(adjacency.sides), 9.0, np.float32)),
            2.0,
            device.array(in_view.astype(np.int32)),
        )
        edges, above = displaced.reached(corners, adjacency.edges, bulges, decals, in_view)
        insides = np.maximum(edges[adjacency.edges].max(axis=1), above)
        wrong += _unlike(found.edge.host(), edges[adjacency.edges])
        wrong += _unlike(found.inside.host()[:, 0], insides)
    yield _REACHED.met_by(wrong, 0)


def _unlike(factors: npt.NDArray[np.float32], reach: npt.NDArray[Any]) -> int:
    differ = factors != np.where(reach > 0, 9.0, 2.0)
    return int(np.count_nonzero(differ & (np.abs(reach) > 1e-5)))


_SEEN: Final = Bound(
    "patches in view and decals seen",
    "of them",
    "exact, but for those within 1e-4 of being the other",
    "as patches are culled, and reached",
)


def _views(case: Sheet, device: Device) -> Iterator[Difference]:
    random, nets, depths = np.random.default_rng(13), case.nets, np.array([[0, 1]], np.float32)
    decals = np.zeros(6, DECAL)
    chosen = random.integers(len(case.mesh.vertices), size=6)
    decals["point"], decals["radius"] = case.mesh.vertices[chosen], 0.1 * case.scale
    decals["normal"], decals["tangent"], decals["scale"] = (0, 0, 1), (1, 0, 0), 0.05 * case.scale
    lengths = np.linalg.norm(nets.astype(np.float64), axis=-1)
    bulges = lengths[:, 3:9].max(axis=1) / 3 + lengths[:, 9] / 27
    moves = decals["scale"].astype(np.float64)
    for view in (case.view, case.view_below):
        found = views_on_device(device.array(nets), decals, depths, view, 0.0)
        expected = displaced.seen(case.controls, bulges, decals, moves, view, 0.0)
        for one, sure in zip((found[0].host(), found[1]), expected, strict=True):
            unlike = (one > 0) != (sure > 0)
            yield _SEEN.met_by(np.count_nonzero(unlike & (np.abs(sure) > 1e-4 * case.scale)), 0)


VIEWS: Final = Check(_views, sheets, dict)
REACH: Final = Check(_reach, lambda: {"2 decals": 2}, lambda: {"1 decal": 1, "33 decals": 33})
