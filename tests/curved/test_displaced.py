"""Displaced meshes and decals: closed across seams, and refined only where there is something."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import terrain_lod as tl
from support.curved_meshes import CLOSED, bulging, cube, torus
from terrain_lod.curved.decals import Decal, dent, shoot
from terrain_lod.curved.displaced import displace
from terrain_lod.curved.displaced_maps import variation_factors
from terrain_lod.measure.cracks import crack_report
from terrain_lod.tessellation.factors import counts

ROUGH = np.random.default_rng(0).uniform(0, 1, (64, 64)).astype(np.float32)
y, x = np.mgrid[0:64, 0:64] / 31.5 - 1
BOWL = np.maximum(0, 1 - x**2 - y**2).astype(np.float32)


def charted(mesh: tl.Mesh) -> tuple[tl.Mesh, np.ndarray]:
    """Return the mesh with vertices of its own for each triangle, and a random chart for each."""
    corners = mesh.triangles.ravel()
    split = tl.Mesh(
        mesh.vertices[corners],
        mesh.normals[corners],
        np.arange(len(corners), dtype=np.int32).reshape(-1, 3),
    )
    rng = np.random.default_rng(1)
    return split, rng.uniform(-1, 2, (len(corners), 2)).astype(np.float32)


@pytest.mark.parametrize("curved", [True, False])
@pytest.mark.parametrize("make", CLOSED.values(), ids=CLOSED)
def test_closed_where_every_edge_is_a_seam(make, curved: bool) -> None:
    mesh, textures = charted(make())
    factors = np.random.default_rng(2).uniform(1, 9, mesh.triangles.shape)
    found = displace(mesh, ROUGH, textures, factors, scale=0.1, bias=-0.02, curved=curved)
    # the mesh's own texture coordinates stand in, and go along
    mesh = replace(mesh, textures=textures)
    own = displace(mesh, ROUGH, None, factors, scale=0.1, bias=-0.02, curved=curved)
    np.testing.assert_array_equal(own.vertices, found.vertices)
    assert own.textures.shape == (len(own.vertices), 2)
    assert not crack_report(found, closed=True)
    np.testing.assert_allclose(np.linalg.norm(found.normals, axis=1), 1, atol=1e-6)


def test_a_flat_map_moves_a_plane_by_scale_and_bias() -> None:
    mesh = tl.Mesh(
        np.float32([[0, 0, 1], [1, 0, 1], [0, 1, 1]]),
        np.tile(np.float32([0, 0, 1]), (3, 1)),
        np.int32([[0, 1, 2]]),
    )
    found = displace(mesh, np.full((3, 4), 2.0), mesh.vertices[:, :2], 5, scale=0.25, bias=0.125)
    np.testing.assert_array_equal(found.vertices[:, 2], 1.625)
    np.testing.assert_allclose(found.normals, np.tile([0, 0, 1], (27, 1)), atol=1e-6)
    # a slope of the map is a slope of the surface; v runs up, rows run down
    rising = np.repeat(np.linspace(0, 1, 100)[::-1, None], 4, axis=1)
    middle = mesh.vertices[:, :2] * 0.5 + 0.25
    slope = displace(mesh, rising, middle, 9)
    assert np.polyfit(slope.vertices[:, 1], slope.vertices[:, 2], 1)[0] == pytest.approx(
        0.505, 0.01
    )
    assert (slope.normals[:, 1] < -0.4).all()


def test_a_sharp_edge_stays_sharp_and_a_smooth_one_smooth() -> None:
    # nothing moves, and normals are found anew from the triangles
    box = displace(cube(), np.zeros((2, 2)), np.zeros((24, 2)), 5)
    assert np.allclose(np.sort(abs(box.normals), axis=1), [0, 0, 1], atol=1e-6)
    ring = torus(32, 16)
    smooth = displace(ring, np.zeros((2, 2)), np.zeros((len(ring.vertices), 2)), 5)
    places, index = np.unique(smooth.vertices, axis=0, return_inverse=True)
    spread = np.zeros((len(places), 3)) - 2
    np.maximum.at(spread, index.ravel(), smooth.normals)
    np.testing.assert_array_equal(spread[index.ravel()], smooth.normals)


def test_variation_gives_segments_where_the_map_is_not_plane() -> None:
    mesh = torus(24, 12)
    angle = np.arctan2(mesh.vertices[:, 1], mesh.vertices[:, 0])
    textures = np.stack([angle / 7 + 0.5, mesh.vertices[:, 2] / 4 + 0.5], axis=1)
    bump = np.zeros((64, 64))
    bump[24:40, 24:40] = BOWL[::4, ::4]
    factors = variation_factors(mesh, bump, textures, scale=0.3, tolerance=0.005)
    assert (factors >= 1).all()
    assert 0.02 < (factors > 1).mean() < 0.4
    finer = variation_factors(mesh, bump, textures, scale=0.3, tolerance=0.00125)
    grown = finer[factors > 1] / factors[factors > 1]
    assert np.median(grown) == pytest.approx(2, abs=0.1)
    assert (variation_factors(mesh, bump * 0 + 3, textures, tolerance=1e-3) == 1).all()
    assert not crack_report(displace(mesh, bump, textures, factors, scale=0.3), closed=True)


# decals


def shots(mesh: tl.Mesh, count: int, radius: float = 0.2) -> tuple[Decal, ...]:
    eyes = np.random.default_rng(3).normal(size=(3 * count, 3)) * 3 + 0.5
    return shoot(mesh, eyes, 0.5 - eyes, radius, scale=0.1)[:count]


@pytest.mark.parametrize("curved", [False, True])
def test_dents_leave_the_mesh_closed(curved: bool) -> None:
    mesh = bulging(cube())
    found = dent(mesh, shots(mesh, 9), BOWL, 15, curved=curved)
    assert not crack_report(found, closed=True)
    assert found.vertices.max() <= 1.2


def test_rays_leave_decals_on_the_nearest_triangles_and_none_where_they_miss() -> None:
    ahead, away, above = (0, 2, 0), (0, -1, 0), (0, 0, -1)
    origins = [(0.25, -5, 0.5), (0.25, -5, 0.5), (0.25, 0.5, 3)]
    first, second = shoot(cube(), origins, [ahead, away, above], [0.1, 0.2, 0.3], scale=0.5)
    np.testing.assert_allclose(first.point, (0.25, 0, 0.5))
    np.testing.assert_allclose(first.normal, (0, -1, 0))
    np.testing.assert_allclose(second.point, (0.25, 0.5, 1))
    for decal, radius in ((first, 0.1), (second, 0.3)):
        assert abs(np.dot(decal.normal, decal.tangent)) < 1e-12
        assert np.linalg.norm(decal.tangent) == pytest.approx(1)
        assert (decal.radius, decal.scale, decal.bias) == (radius, 0.5, 0.0)
    assert shoot(cube(), origins[0], away, 0.1) == ()
    far = tl.Mesh(cube().vertices, cube().normals, cube().triangles, np.array([1e6, 0, 0]))
    (moved,) = shoot(far, (1e6 + 0.25, -5, 0.5), ahead, 0.1)
    np.testing.assert_allclose(moved.point, (1e6 + 0.25, 0, 0.5))


def test_only_patches_in_reach_are_refined() -> None:
    #  a hit in the middle of one face's triangle, too far from its edges for a radius of 0.1
    decal = Decal((0.7, 0.35, 1.0), (0, 0, 1), (1, 0, 0), radius=0.1, scale=0.05)
    found = dent(cube(), [decal], BOWL, 9)
    inside = len(dent(cube(), [], BOWL, 9).triangles)
    assert inside == 12
    # the eleven others stay whole; this one has edges of 1 and an inside of 9
    assert len(found.triangles) == 11 + counts("triangle", [[1, 1, 1]], [[9]])[1][0]
    # nearer to an edge, both faces there are refined
    near = Decal((0.5, 0.05, 1.0), (0, 0, 1), (1, 0, 0), radius=0.1, scale=0.05)
    assert len(dent(cube(), [near], BOWL, 9).triangles) > 10 + 2 * 60
    # the deepest point is as deep as the map says
    deepest = dent(cube(), [decal], BOWL, 63).vertices
    top = deepest[(abs(deepest[:, :2] - [0.7, 0.35]) < 0.1).all(axis=1) & (deepest[:, 2] > 0.5)]
    assert top[:, 2].min() == pytest.approx(0.95, abs=1e-3)


def test_wrong_arguments() -> None:
    mesh = cube()
    textures = np.zeros((24, 2))
    for call, message in (
        (lambda: displace(mesh, np.zeros(3), textures), "heights of a map of shape"),
        (
            lambda: displace(mesh, ROUGH, textures[:5]),
            r"of shape \(24, 2\), got \(5, 2\)",
        ),
        (lambda: displace(mesh, ROUGH), "got none, and the mesh has none"),
        (lambda: displace(mesh, ROUGH, textures, 0.5), "factor from 1"),
        (lambda: displace(mesh, ROUGH, textures, scale=np.nan), "finite scale"),
        (lambda: variation_factors(mesh, ROUGH, textures, tolerance=0), "tolerance > 0"),
        (lambda: dent(mesh, [], np.full((2, 2), np.nan), 5), "finite heights of a map"),
        (lambda: dent(mesh, [], BOWL, 99), "factor from 1 to 64"),
        (lambda: Decal((0, 0, 0), (0, 0, 2), (1, 0, 0), 1), "normal of length 1"),
        (lambda: Decal((0, 0, 0), (0, 0, 1), (1, 0, 0), 0), "radius > 0"),
        (lambda: Decal((0, 0, np.nan), (0, 0, 1), (1, 0, 0), 1), "finite point"),
        (lambda: Decal((0, 0, 0), (0, np.nan, 1), (1, 0, 0), 1), "finite normal"),
        (lambda: Decal((0, 0, 0), (0, 0, 1), None, 1), r"tangent as \(x, y, z\), got None"),  # type: ignore[arg-type]
        (lambda: dent(mesh, [None], BOWL), "a Decal for each of decals, got None"),  # type: ignore[list-item]
        (lambda: shoot(mesh, (0, 0, 0), (0, 0, 0), 1), "expected directions"),
        (lambda: shoot(mesh, (0, np.nan, 0), (0, 0, 1), 1), "expected finite origins"),
        (lambda: shoot(mesh, (0, 0, 0), (0, np.inf, 1), 1), "expected finite directions"),
        (lambda: shoot(mesh, (9, 9, 9), (0, 0, 1), np.nan), "finite radius"),
        (lambda: shoot(mesh, (0, 0, 0), (0, 0, 1), [1, 2]), r"radius of shape \(1,\)"),
    ):
        with pytest.raises(tl.InputError, match=message):
            call()
