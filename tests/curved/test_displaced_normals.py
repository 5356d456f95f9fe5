"""Normals of displaced surfaces, and which patches decals reach: on the device as in float64."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

from support.curved_meshes import CLOSED, cube, torus
from terrain_lod.camera.camera import Camera
from terrain_lod.curved.adjacency import Adjacency
from terrain_lod.curved.decals import (
    Decal,
    dent,
    dent_on_device,
    shoot,
)
from terrain_lod.curved.displaced import displace
from terrain_lod.curved.displaced_maps import variation_factors
from terrain_lod.curved.displaced_normals import corner_kinds
from terrain_lod.curved.patch_factors import (
    CurvatureFactor,
    DistanceFactor,
    LengthFactor,
    SilhouetteFactor,
)
from terrain_lod.curved.smooth import pn_triangles
from terrain_lod.device.device import Device
from terrain_lod.device.layout import DECAL
from terrain_lod.drawing.render import render
from terrain_lod.errors import InputError
from terrain_lod.measure.cracks import crack_report
from terrain_lod.mesh.mesh import Mesh
from terrain_lod.mesh.open_edges import weld
from terrain_lod.mesh.vertices import DeviceVertices
from terrain_lod.reference.curved import displaced as reference

WAVES = np.sin(np.arange(32) / 32 * 4 * np.pi)[:, None] * np.cos(np.arange(32) / 32 * 4 * np.pi)
y, x = np.mgrid[0:64, 0:64] / 31.5 - 1
BOWL = np.maximum(0, 1 - x**2 - y**2).astype(np.float32)


def angles(a, b):
    """Degrees between rows of unit vectors."""
    return np.degrees(np.arccos(np.clip((a * b).sum(axis=1), -1, 1)))


@pytest.mark.parametrize("partitioning", ["fractional_odd", "fractional_even", "integer", "pow2"])
@pytest.mark.parametrize("name", CLOSED)
def test_normals_are_those_of_the_displaced_triangles(name, partitioning):
    mesh = CLOSED[name]()
    textures = mesh.vertices[:, :2] * 0.3
    factors = np.random.default_rng(4).uniform(1, 7, mesh.triangles.shape)
    found = displace(mesh, WAVES, textures, factors, scale=0.1, partitioning=partitioning)
    still = pn_triangles(mesh, factors, partitioning=partitioning)
    expected = reference.renewed_normals(found.vertices, still.normals, found.triangles)
    # slivers between points that rounding alone keeps apart have any direction
    assert np.quantile(angles(found.normals, expected), 0.999) < 0.1
    np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1, atol=1e-6)


def test_smooth_edges_have_one_normal_and_sharp_ones_their_own():
    ring = torus(16, 8)
    found = displace(ring, WAVES, ring.vertices[:, :2] * 0.2, 6.3, scale=0.2)
    points = weld(found.vertices)
    _, first = np.unique(points, return_index=True)
    np.testing.assert_array_equal(found.normals, found.normals[first[points]])
    box = displace(cube(), WAVES, cube().vertices[:, :2], 5, scale=0.05, curved=False)
    corner = np.linalg.norm(box.vertices - box.vertices.max(axis=0), axis=1) < 0.2
    assert len(np.unique(np.round(box.normals[corner], 1), axis=0)) >= 3


def test_normals_converge_to_those_of_the_true_surface():
    #  a wave of height along the unit sphere's own normal has a normal in closed form
    from scipy.spatial import ConvexHull

    i = np.arange(1500) + 0.5
    polar, turn = np.arccos(1 - 2 * i / len(i)), np.pi * (1 + 5**0.5) * i
    points = np.stack(
        [np.cos(turn) * np.sin(polar), np.sin(turn) * np.sin(polar), np.cos(polar)], axis=1
    )
    hull = ConvexHull(points).simplices
    inwards = (np.cross(*(points[hull[:, k]] - points[hull[:, 0]] for k in (1, 2))) * points[
        hull[:, 0]]).sum(axis=1) < 0  # fmt: skip
    hull[inwards] = hull[inwards][:, ::-1]
    sphere = Mesh(points.astype(np.float32), points.astype(np.float32), hull.astype(np.int32))
    # height rises with z alone: h = 0.2 z, through a map that is linear between its middle rows
    heights = np.repeat(np.linspace(1, 0, 256)[:, None], 4, axis=1)
    textures = np.stack([np.zeros(len(points)), points[:, 2] * 0.25 + 0.5], axis=1)
    slope = 0.25 * 256 / 255  # of the height along z
    found = displace(sphere, heights, textures, 9, scale=0.4, bias=-0.2)
    away = found.vertices.astype(np.float64)
    away /= np.linalg.norm(away, axis=1, keepdims=True)
    radius = 1 + 0.4 * (slope * away[:, 2] + 0.5) - 0.2
    up = np.array([0, 0, 1]) - away * away[:, 2:]
    true = away - 0.4 * slope * up / radius[:, None]
    true /= np.linalg.norm(true, axis=1, keepdims=True)
    assert np.median(angles(found.normals, true)) < 0.5
    assert np.quantile(angles(found.normals, true), 0.99) < 3


CAMERA = Camera((5, -6, 4), (0, 0, 0), fov=50, size=(320, 240))


@pytest.mark.parametrize(
    "lod", [DistanceFactor(5, 12), LengthFactor(12), SilhouetteFactor(), CurvatureFactor(0.2)]
)
@pytest.mark.parametrize("name", ["cube", "cone", "torus", "bulging cube"])
def test_closed_with_factors_by_formula(name, lod):
    mesh = CLOSED[name]()
    textures = np.random.default_rng(7).uniform(-1, 2, (len(mesh.vertices), 2))
    found = displace(mesh, WAVES, textures, scale=0.1, lod=lod, camera=CAMERA)
    assert not crack_report(found, closed=True)
    # a cube's edges are straight before they are displaced
    straight = isinstance(lod, CurvatureFactor) and name == "cube"
    assert straight == (len(found.triangles) < 2 * len(mesh.triangles))


def test_formulas_need_a_camera_and_stand_alone():
    mesh = cube()
    textures = mesh.vertices[:, :2]
    with pytest.raises(InputError, match="DistanceFactor needs a camera, got none"):
        displace(mesh, WAVES, textures, lod=DistanceFactor())
    with pytest.raises(InputError, match="a factor or a lod, got both"):
        displace(mesh, WAVES, textures, 3, lod=DistanceFactor(), camera=CAMERA)


def test_maps_repeat_without_end_and_coordinates_have_one():
    mesh = cube()
    textures = np.float32([0.0, -1e-9]) + np.round(mesh.vertices[:, :2])
    expected = displace(mesh, WAVES, textures, 5, scale=0.1)
    for turns in (1, -3, 1000):
        found = displace(mesh, WAVES, textures + turns, 5, scale=0.1)
        np.testing.assert_allclose(found.vertices, expected.vertices, atol=2e-4)
    with pytest.raises(InputError, match="texture coordinates within 1048576"):
        displace(mesh, WAVES, textures + 2.0**21)


def test_factors_from_a_map_do_not_depend_on_how_many_are_asked_together(monkeypatch):
    mesh = torus(16, 8)
    textures = mesh.vertices[:, :2] * 0.2
    expected = variation_factors(mesh, WAVES, textures, scale=0.2, tolerance=0.01)
    monkeypatch.setattr("terrain_lod.curved.displaced_maps._SAMPLED_TOGETHER", 7)
    found = variation_factors(mesh, WAVES, textures, scale=0.2, tolerance=0.01)
    np.testing.assert_array_equal(found, expected)
    assert found.max() > 2


def test_corners_of_a_kind_share_position_and_normal():
    mesh = cube()
    adjacency = Adjacency.of(mesh)
    offsets, members = corner_kinds(mesh.vertices, mesh.normals, adjacency)
    assert len(offsets) - 1 == 24
    assert sorted(members.tolist()) == list(range(36))
    for begin, end in itertools.pairwise(offsets):
        vertices = mesh.triangles.ravel()[members[begin:end]]
        assert len(np.unique(mesh.vertices[vertices], axis=0)) == 1
        assert len(np.unique(mesh.normals[vertices], axis=0)) == 1


# decals


def hits(mesh, count, radius):
    random = np.random.default_rng(5)
    eyes, targets = random.normal(size=(2, 3 * count, 3)) * [[[6]], [[2]]]
    found = shoot(mesh, eyes, targets - eyes, radius, scale=0.05)[:count]
    assert len(found) == count
    return found


def test_many_decals_leave_a_mesh_closed_and_what_they_miss_untouched():
    mesh = torus(24, 12)
    decals = hits(mesh, 300, 0.15)
    found = dent(mesh, decals, BOWL, 7, curved=True)
    assert not crack_report(found, closed=True)
    still = dent(mesh, [], BOWL, 7, curved=True)
    assert len(still.triangles) == len(mesh.triangles)
    far = np.array([np.subtract(decal.point, 0) for decal in decals])
    away = np.linalg.norm(mesh.vertices[:, None] - far, axis=2).min(axis=1) > 0.15
    kept = set(map(tuple, found.vertices.tolist()))
    assert away.any()
    assert all(tuple(vertex) in kept for vertex in mesh.vertices[away].tolist())


@pytest.mark.parametrize("count", [1, 31, 32, 33, 100])
def test_points_asked_together_move_as_each_alone(count):
    random = np.random.default_rng(6)
    positions = random.uniform(-1, 1, (count, 3)).astype(np.float32)
    records = np.zeros(7, DECAL)
    records["point"] = random.uniform(-1, 1, (7, 3))
    records["normal"], records["tangent"] = (0, 0, 1), (1, 0, 0)
    records["radius"], records["scale"] = 0.4, 0.2

    def dented(positions):
        device, normals = Device.open(), np.full(positions.shape, 0.6, np.float32)
        vertices = DeviceVertices(device.array(positions), device.array(normals))
        dent_on_device(vertices, records, BOWL)
        return np.concatenate([vertices.positions.host(), vertices.normals.host()], axis=1)

    for position, found in zip(positions, dented(positions), strict=True):
        np.testing.assert_array_equal(dented(position[None])[0], found)


def test_normals_are_those_of_the_dented_triangles():
    mesh = torus(48, 24)
    decals = hits(mesh, 12, 0.4)
    found = dent(mesh, decals, BOWL, 25, curved=True)
    expected = reference.renewed_normals(found.vertices, found.normals, found.triangles)
    away = np.linalg.norm(found.vertices[:, None] - [decal.point for decal in decals], axis=2).min(
        axis=1
    )
    # a bowl's rim has an edge, where triangles take the mean of both sides
    smooth = (away < 0.3) | (away > 0.5)
    assert np.median(angles(found.normals, expected)[smooth]) < 3
    assert np.median(angles(found.normals, expected)[away < 0.3]) < 3


def test_normals_where_refined_patches_end_are_the_same_on_both_sides():
    mesh = torus(24, 12)
    decals = hits(mesh, 9, 0.3)
    few, all_of_it = dent(mesh, decals, BOWL, 9), dent(mesh, decals, BOWL, 9, elsewhere=9)
    known = {
        tuple(at): normal
        for at, normal in zip(all_of_it.vertices.tolist(), all_of_it.normals, strict=True)
    }
    found = [
        (normal, known[tuple(at)])
        for at, normal in zip(few.vertices.tolist(), few.normals, strict=True)
        if tuple(at) in known
    ]
    assert len(found) > 0.9 * len(few.vertices)
    np.testing.assert_allclose(*map(np.array, zip(*found, strict=True)), atol=1e-6)


@pytest.mark.parametrize("lod", [None, LengthFactor(pixels=20)], ids=["factor", "lod"])
def test_a_camera_refines_less_and_shows_the_same(lod):
    mesh = torus(24, 12)
    decals = hits(mesh, 40, 0.3)
    saved = 0
    for eye in ((7, 0, 1), (0, 4, 5), (3, 3, 0.2)):
        camera = Camera(eye, (2, 1, 0), fov=40, size=(320, 240), near=0.01)
        how = {"lod": lod, "camera": camera}
        whole = dent(mesh, decals, BOWL, cull=False, **how)
        some = dent(mesh, decals, BOWL, back_faces=0, **how)
        assert not crack_report(some, closed=True)
        saved += len(whole.triangles) - len(some.triangles)
        one, other = (render(each, camera=camera, style="plain") for each in (whole, some))
        np.testing.assert_array_equal(one, other)
    assert saved > (0.4 if lod is None else 0.1) * 3 * len(whole.triangles)


def test_raised_decals_are_refined_wherever_they_are():
    mesh, camera = torus(24, 12), Camera((7, 0, 1), (0, 0, 0), near=0.01)
    up, down = (hits(mesh, 20, 0.3) for _ in range(2))
    up = [replace(decal, scale=-0.05) for decal in up]
    counts = [
        len(dent(mesh, decals, BOWL, camera=camera, back_faces=0).triangles)
        for decals in (up, down)
    ]
    assert counts[0] > counts[1]


def test_a_dented_displaced_mesh_stays_closed():
    ring = torus(12, 6)
    moved = displace(ring, WAVES, ring.vertices[:, :2] * 0.2, 3, scale=0.1)
    (decal,) = shoot(moved, (6, 0, 0.1), (-1, 0, 0), 0.5, scale=0.2)
    assert not crack_report(dent(moved, [decal], BOWL, 5), closed=True)


def two_cubes_at_an_edge():
    one = cube()
    vertices = np.concatenate([one.vertices, one.vertices + np.float32([1, 1, 0])])
    triangles = np.concatenate([one.triangles, one.triangles + np.int32(24)])
    return Mesh(vertices, np.concatenate([one.normals, one.normals]), triangles)


def needles():
    vertices = np.float32([[0, 0, 0], [1e3, 0, 0], [0, 1e-3, 0], [0, 0, 1]])
    lengths = np.maximum(np.linalg.norm(vertices, axis=1, keepdims=True), np.float32(1e-9))
    triangles = np.int32([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])
    return Mesh(vertices, vertices / lengths, triangles)


def ring_with_normals(change):
    mesh = torus(12, 6)
    change(mesh.normals)
    return mesh


def cube_with_triangles_without_area():
    mesh = cube()
    return Mesh(mesh.vertices, mesh.normals, np.int32([*mesh.triangles, (0, 0, 1), (2, 2, 2)]))


HARD = {
    "four faces at an edge": two_cubes_at_an_edge,
    "needles": needles,
    "zero normals": lambda: ring_with_normals(lambda normals: normals[::3].fill(0)),
    "opposite normals": lambda: ring_with_normals(lambda normals: np.negative(*[normals[::2]] * 2)),
    "no area": cube_with_triangles_without_area,
}


@pytest.mark.parametrize("curved", [True, False])
@pytest.mark.parametrize("name", HARD)
def test_hard_cases_stay_closed_and_finite(name, curved):
    mesh, random = HARD[name](), np.random.default_rng(8)
    textures = random.uniform(-1, 2, (len(mesh.vertices), 2))
    factors = random.uniform(1, 9, mesh.triangles.shape)
    decal = Decal(tuple(mesh.vertices[3].tolist()), (0, 0, 1), (1, 0, 0), 0.5, scale=0.2)
    for found in (
        displace(mesh, WAVES, textures, factors, scale=0.1, curved=curved),
        dent(mesh, [decal], BOWL, 9, curved=curved),
    ):
        assert not crack_report(found, closed=True)
        assert np.isfinite(found.vertices).all()
        np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1, atol=1e-6)
