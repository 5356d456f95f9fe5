"""Curved meshes: closed for every formula, sharp where asked, and nothing culled that is seen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import terrain_lod as tl
from support.curved_meshes import CLOSED, bulging, chamfered_cube, cone, cube, torus, welded
from terrain_lod.curved.adjacency import Adjacency
from terrain_lod.curved.creases import split_at_creases
from terrain_lod.curved.patch_factors import (
    CurvatureFactor,
    DistanceFactor,
    LengthFactor,
    OrientationFactor,
    SilhouetteFactor,
    UniformFactor,
)
from terrain_lod.curved.smooth import pn_triangles
from terrain_lod.drawing.graphics import graphics_problem
from terrain_lod.drawing.picture import draw
from terrain_lod.measure.cracks import crack_report

needs_graphics = pytest.mark.skipif(
    graphics_problem() is not None, reason=f"no 3-D pictures tested: {graphics_problem()}"
)

FORMULAS = [
    UniformFactor(4.3),
    DistanceFactor(near=2.0, far=9.0),
    LengthFactor(pixels=12.0),
    OrientationFactor(maximum=9),
    SilhouetteFactor(maximum=9),
    CurvatureFactor(pixels=0.2),
]


def cameras(count: int, seed: int = 1, distance: float = 7.0, size=(240, 180)):
    """Return cameras all around the middle of a mesh."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        eye = rng.normal(size=3)
        eye *= distance * rng.uniform(0.7, 1.5) / np.linalg.norm(eye)
        yield tl.Camera(tuple(eye), tuple(rng.normal(size=3) * 0.2), up=(0.1, 0.2, 1), size=size)


@pytest.mark.parametrize("formula", FORMULAS, ids=lambda formula: formula.header)
@pytest.mark.parametrize("make", CLOSED.values(), ids=CLOSED)
def test_a_closed_mesh_stays_closed(make, formula) -> None:
    mesh = make()
    assert not crack_report(mesh, closed=True)
    for camera in cameras(2):
        smooth = pn_triangles(mesh, lod=formula, camera=camera, cull=False)
        assert not crack_report(smooth, closed=True)


@pytest.mark.parametrize("partitioning", ["fractional_odd", "fractional_even", "integer", "pow2"])
def test_every_partitioning_and_factors_of_ones_own(partitioning: str) -> None:
    mesh = bulging(cube())
    factors = np.random.default_rng(3).uniform(1, 12, mesh.triangles.shape)
    smooth = pn_triangles(mesh, factors, partitioning=partitioning)
    assert not crack_report(smooth, closed=True)
    assert len(smooth.triangles) > 12 * 12


@pytest.mark.parametrize("name", ["cone", "bulging cube", "bulging chamfered cube"])
def test_plain_patches_part_at_split_normals_and_adjacent_edges_close_them(name: str) -> None:
    mesh = CLOSED[name]()
    before = crack_report(pn_triangles(mesh, 5, sharp=False), closed=True)
    assert before.cracks > 100
    assert before.largest_gap > 0.01
    assert not crack_report(pn_triangles(mesh, 5), closed=True)


def test_a_cube_with_three_normals_a_corner_stays_a_cube() -> None:
    smooth = pn_triangles(cube(), 7)
    on_a_face = np.isin(smooth.vertices, [0, 1]).any(axis=1)
    assert on_a_face.all()
    # and its normals are those of its faces: sharp
    assert (np.sort(abs(smooth.normals), axis=1) == [0, 0, 1]).all()


def test_a_smooth_cube_is_made_round_and_a_crease_angle_keeps_it_sharp() -> None:
    mesh = welded(cube())
    round_ = pn_triangles(mesh, 7)
    assert np.isin(round_.vertices, [0, 1]).any(axis=1).mean() < 0.5
    sharp = pn_triangles(mesh, 7, sharp=45)
    assert np.isin(sharp.vertices, [0, 1]).any(axis=1).all()
    assert not crack_report(round_, closed=True)
    assert not crack_report(sharp, closed=True)


def test_creases_split_vertices_into_their_smooth_parts() -> None:
    # a cube's corners are of three faces; across 89 degrees none is joined, across 91 all are
    mesh = welded(cube())
    assert len(split_at_creases(mesh, 89).vertices) == 24
    assert len(split_at_creases(mesh, 91).vertices) == 8
    # the side of a cone is smooth, its rim is not: rim twice, middle of the base, apex
    split = split_at_creases(welded(cone(12)), 60)
    assert len(split.vertices) == 12 + 12 + 1 + 1
    with pytest.raises(tl.InputError, match="0 to 180"):
        split_at_creases(mesh, 200)


def test_wound_like_the_mesh_and_normals_of_the_surface() -> None:
    mesh = torus(48, 24)
    smooth = pn_triangles(mesh, 3)
    a, b, c = (smooth.vertices[smooth.triangles[:, k]] for k in range(3))
    across = np.cross(b - a, c - a)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    mean = smooth.normals[smooth.triangles].mean(axis=1)
    assert np.einsum("ij,ij->i", across, mean).min() > 0.9


def test_quadratic_normals_follow_an_s_and_linear_ones_do_not() -> None:
    # both ends lean the same way, so that the surface must lean the other way in between
    lean = np.array([-0.6, 0, 0.8])
    mesh = tl.Mesh(
        np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]]),
        np.tile(lean, (3, 1)).astype(np.float32),
        np.int32([[0, 1, 2]]),
    )
    middle = {}
    for kind in ("quadratic", "linear"):
        smooth = pn_triangles(mesh, 2, normals=kind, partitioning="integer")
        vertex = np.argmin(np.linalg.norm(smooth.vertices[:, :2] - [0.5, 0], axis=1))
        middle[kind] = smooth.normals[vertex]
    np.testing.assert_allclose(middle["linear"], lean, atol=1e-6)
    assert middle["quadratic"][0] > middle["linear"][0] + 0.1


def test_the_origin_goes_along() -> None:
    mesh = torus()
    far = tl.Mesh(mesh.vertices, mesh.normals, mesh.triangles, np.array([5e5, 4e6, 9.0]), "EPSG:1")
    smooth = pn_triangles(far, 3)
    np.testing.assert_array_equal(smooth.origin, far.origin)
    assert smooth.crs == "EPSG:1"
    assert repr(smooth) == f"CurvedMesh({len(smooth.vertices)} vertices, 3328 triangles)"
    # and cameras are in the world
    camera = tl.Camera((5e5 + 9, 4e6, 9), tuple(far.origin))
    near = tl.Camera((9, 0, 0), (0, 0, 0))
    lod = DistanceFactor(near=3, far=12)
    found, expected = (
        pn_triangles(one, lod=lod, camera=view) for one, view in ((far, camera), (mesh, near))
    )
    assert len(found.triangles) == len(expected.triangles)


@pytest.mark.parametrize("partitioning", ["fractional_odd", "semi_uniform"])
def test_texture_coordinates_go_along(partitioning: str) -> None:
    mesh = torus()
    smooth = pn_triangles(mesh, 4.3, partitioning=partitioning, sharp=30)
    # a triangle's own plane carries its positions over
    flat = smooth.interpolate(mesh.vertices)
    np.testing.assert_array_equal(smooth.interpolate(np.full(len(mesh.vertices), 7.5)), 7.5)
    at_corners = (smooth.points.max(axis=1) == 65536) | (smooth.points.sum(axis=1) == 0)
    np.testing.assert_array_equal(flat[at_corners], smooth.vertices[at_corners])
    assert np.linalg.norm(flat - smooth.vertices, axis=1).max() < 0.3
    # and both sides of an edge agree to the bit
    assert not crack_report(replace(smooth, vertices=flat), closed=True)
    with pytest.raises(tl.InputError, match="expected values for 128 vertices"):
        smooth.interpolate(np.zeros((5, 2)))
    # the mesh's own are there at once
    assert smooth.textures is None
    pairs = np.random.default_rng(2).uniform(size=(len(mesh.vertices), 2)).astype(np.float32)
    own = pn_triangles(replace(mesh, textures=pairs), 4.3, partitioning=partitioning, sharp=30)
    np.testing.assert_array_equal(own.textures, smooth.interpolate(pairs))


@pytest.mark.parametrize("partitioning", ["fractional_odd", "integer"])
@pytest.mark.parametrize("pixels", [0.25, 2.0])
def test_curvature_keeps_edges_within_the_pixels_asked_for(pixels: float, partitioning) -> None:
    mesh = torus()
    # so far away that the perspective stretches by 3 % at most
    camera = tl.Camera((20, -25, 15), (0, 0, 0), fov=16, size=(1600, 1200))
    lod = CurvatureFactor(pixels=pixels)
    smooth = pn_triangles(mesh, lod=lod, camera=camera, partitioning=partitioning, cull=False)
    exact = pn_triangles(mesh, 64, partitioning="integer")
    worst, wanted = 0.0, 0
    for triangle in range(len(mesh.triangles)):
        polyline, curve = (edge_pixels(one, triangle, camera) for one in (smooth, exact))
        worst = max(worst, *(off_polyline(point, polyline) for point in curve))
        wanted += len(polyline) - 1
    assert 0.2 * pixels < worst < 1.05 * pixels
    assert wanted < 64 * len(mesh.triangles) / 4


def edge_pixels(mesh, triangle: int, camera: tl.Camera) -> np.ndarray:
    """Return the points along the edge v = 0 of a triangle, in pixels."""
    begin, end = mesh.point_offsets[triangle : triangle + 2]
    on_edge = begin + np.flatnonzero(mesh.points[begin:end, 1] == 0)
    along = on_edge[np.argsort(mesh.points[on_edge, 0])]
    return camera.project(mesh.vertices[along])[0]


def off_polyline(point: np.ndarray, polyline: np.ndarray) -> float:
    """Return the distance of a point from a polyline."""
    starts, along = polyline[:-1], np.diff(polyline, axis=0)
    squares = np.maximum((along**2).sum(axis=1), 1e-12)
    t = np.clip(((point - starts) * along).sum(axis=1) / squares, 0, 1)
    return float(np.linalg.norm(starts + t[:, None] * along - point, axis=1).min())


# culling


def test_nothing_in_view_is_culled_and_what_is_behind_is() -> None:
    mesh = torus()
    for camera in cameras(8, distance=3.5):
        kept = {row.tobytes() for row in pn_triangles(mesh, 3, camera=camera).vertices}
        everything = pn_triangles(mesh, 3).vertices
        pixels, depth = camera.project(everything)
        seen = (depth >= camera.near) & (pixels >= 0).all(axis=1)
        seen &= (pixels <= camera.size).all(axis=1)
        assert all(row.tobytes() in kept for row in everything[seen])
    away = tl.Camera((0, 20, 0), (0, 21, 0))
    assert not len(pn_triangles(mesh, 3, camera=away).triangles)


def kept_triangles(whole, camera: tl.Camera, mesh: tl.Mesh, factors) -> np.ndarray:
    """Return which triangles of a curved mesh are left when patches turned away are not drawn."""
    front = pn_triangles(mesh, factors, camera=camera, back_faces=0.0, cull=False)
    patch = np.searchsorted(whole.point_offsets, whole.triangles[:, 0], side="right") - 1
    kept = (np.diff(front.point_offsets) > 0)[patch]
    assert kept.sum() == len(front.triangles)
    return kept


@needs_graphics
@pytest.mark.parametrize("name", ["torus", "cone", "chamfered cube", "bulging chamfered cube"])
def test_leaving_out_patches_that_are_turned_away_changes_no_pixel(name: str) -> None:
    mesh = CLOSED[name]()
    whole = pn_triangles(mesh, 5)
    # colours by position alone: outside the outline, but nearer to it than the steps that corners
    # are rounded to, rasterisers may draw either patch there
    alike = replace(whole, normals=np.tile(np.float32([0, 0, 1]), (len(whole.normals), 1)))
    left_out = 0
    for camera in cameras(4):
        kept = kept_triangles(whole, camera, mesh, 5)
        left_out += np.count_nonzero(~kept)
        # all of the vertices, so that haze and clipping planes are the same
        part = replace(alike, triangles=whole.triangles[kept])
        np.testing.assert_array_equal(draw(alike, camera), draw(part, camera))
    assert left_out > 0.05 * 4 * len(whole.triangles)


@pytest.mark.parametrize("factor", [1, 1.5, 3, 5, 8])
@pytest.mark.parametrize("name", ["torus", "cone", "bulging cube", "bulging chamfered cube"])
def test_no_triangle_that_faces_the_eye_is_left_out(name: str, factor: float) -> None:
    mesh = CLOSED[name]()
    whole = pn_triangles(mesh, factor)
    a, b, c = (whole.vertices[whole.triangles[:, k]].astype(np.float64) for k in range(3))
    normals = np.cross(b - a, c - a)
    left_out = 0
    for camera in cameras(40, distance=4.0):
        kept = kept_triangles(whole, camera, mesh, factor)
        away = np.einsum("ij,ij->i", normals, a - camera.eye)
        # but for rounding, where a point is snapped to 16.16 and a triangle has next to no area
        assert away[~kept].min(initial=0) > -1e-7
        left_out += np.count_nonzero(~kept)
    assert left_out > 0.15 * 40 * len(whole.triangles)


def test_a_threshold_keeps_more() -> None:
    mesh, camera = torus(64, 32), tl.Camera((9, 3, 5), (0, 0, 0))
    counts = [
        len(pn_triangles(mesh, 3, camera=camera, back_faces=cosine).triangles)
        for cosine in (0.0, 0.2, 0.9)
    ]
    everything = len(pn_triangles(mesh, 3).triangles)
    assert counts == sorted(counts)
    assert counts[0] < 0.7 * everything
    assert counts[-1] > 0.9 * everything


# bad input


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"factor": 0.5}, "factor from 1 to 64"),
        ({"factor": float("nan")}, "finite factor"),
        ({"factor": np.ones((2, 3))}, "shape"),
        ({"factor": np.zeros((12, 3))}, "factor from 1 to 64, got 0"),
        ({"factor": 3, "lod": UniformFactor(3)}, "both"),
        ({"lod": LengthFactor()}, "needs a camera"),
        ({"normals": "cubic"}, "unknown normals"),
        ({"partitioning": "odd"}, "unknown partitioning"),
        ({"back_faces": 0.2}, "needs a camera"),
        ({"back_faces": 2.0, "camera": tl.Camera((9, 0, 0), (0, 0, 0))}, "from 0 to below 1"),
        ({"sharp": -3.0}, "0 to 180"),
    ],
)
def test_wrong_arguments(change, message: str) -> None:
    with pytest.raises(tl.InputError, match=message):
        pn_triangles(cube(), **change)


def test_wrong_meshes() -> None:
    mesh = cube()
    broken = mesh.vertices.copy()
    broken[3, 1] = np.nan
    for vertices, normals, triangles, message in (
        (broken, mesh.normals, mesh.triangles, "finite positions"),
        (mesh.vertices, broken, mesh.triangles, "finite normals"),
        (mesh.vertices, mesh.normals, mesh.triangles + 20, "among its 24 vertices"),
        (mesh.vertices, mesh.normals, mesh.triangles[:0], "empty mesh"),
    ):
        with pytest.raises(tl.InputError, match=message):
            pn_triangles(tl.Mesh(vertices, normals, triangles), 3)


@pytest.mark.parametrize(
    "make",
    [
        lambda: LengthFactor(pixels=0),
        lambda: CurvatureFactor(pixels=-1),
        lambda: DistanceFactor(near=5, far=5),
        lambda: DistanceFactor(near=-1),
        lambda: SilhouetteFactor(cosine=0),
        lambda: OrientationFactor(minimum=9, maximum=5),
        lambda: UniformFactor(65),
    ],
)
def test_wrong_formulas(make) -> None:
    with pytest.raises(tl.InputError, match="expected"):
        make()


# semi-uniform patterns


@pytest.mark.parametrize("formula", FORMULAS, ids=lambda formula: formula.header)
@pytest.mark.parametrize("make", CLOSED.values(), ids=CLOSED)
def test_semi_uniform_patterns_close_a_mesh_too(make, formula) -> None:
    (camera,) = cameras(1)
    smooth = pn_triangles(
        make(), lod=formula, camera=camera, cull=False, partitioning="semi_uniform"
    )
    assert not crack_report(smooth, closed=True)


def test_own_levels_at_every_edge_are_closed_and_whole_ones_are_on_the_surface() -> None:
    mesh = bulging(chamfered_cube())
    factors = np.random.default_rng(5).uniform(1, 16, mesh.triangles.shape)
    assert not crack_report(pn_triangles(mesh, factors, partitioning="semi_uniform"), closed=True)
    # a level of two is a factor of four
    dyadic = pn_triangles(mesh, 4, partitioning="semi_uniform")
    uniform = pn_triangles(mesh, 4, partitioning="integer")
    assert len(dyadic.triangles) == 16 * len(mesh.triangles)
    on_edges = {row.tobytes() for row in uniform.vertices}
    common = sum(row.tobytes() in on_edges for row in dyadic.vertices)
    assert common >= 12 * len(mesh.triangles)


def test_levels_between_whole_ones_grow_without_a_jump() -> None:
    mesh = torus()

    def surface(factor: float):
        return pn_triangles(mesh, factor, partitioning="semi_uniform")

    # the vertices just above a whole level lie on the triangles of that level ...
    low, above = surface(4.0), surface(4.0001)
    assert len(above.triangles) == 4 * len(low.triangles)
    assert distance(above, low) < 1e-5
    # ... where the next level's are off by much
    assert distance(surface(8.0), low) > 0.01
    # and just below a whole level they are nearly that level's
    assert np.abs(surface(7.9999).vertices - surface(8.0).vertices).max() < 1e-5


def test_edges_beside_finer_patches_come_and_go_without_a_jump() -> None:
    mesh = torus()
    adjacency = Adjacency.of(mesh)
    levels = np.random.default_rng(4).integers(0, 4, len(adjacency.sides)).astype(float)

    def surface(more: float):
        factors = (2 ** (levels + more))[adjacency.edges]
        return pn_triangles(mesh, factors, partitioning="semi_uniform")

    # every edge has twice the segments, and nothing is elsewhere
    low, above = surface(0.0), surface(1e-4)
    assert len(above.triangles) > 1.5 * len(low.triangles)
    assert max(distance(above, low), distance(low, above)) < 2e-4
    assert distance(surface(0.5), low) > 0.02
    assert not crack_report(above, closed=True)
    assert not crack_report(surface(0.5), closed=True)


def distance(points: tl.Mesh, surface: tl.Mesh) -> float:
    """Return how far the vertices of one mesh are from the triangles of another, at most."""
    found = points.to_pyvista().compute_implicit_distance(surface.to_pyvista())
    return float(np.abs(found["implicit_distance"]).max())
