"""Parametric surfaces and curves: seams, poles, and what is refused."""

import numpy as np
import pytest

from terrain_lod.curved.curves import CURVES, curve
from terrain_lod.curved.surfaces import SURFACES, surface
from terrain_lod.device.device import Device
from terrain_lod.device.layout import FIXED_ONE, PARTITIONINGS
from terrain_lod.device.sources import KERNELS
from terrain_lod.errors import InputError
from terrain_lod.measure.cracks import crack_report
from terrain_lod.reference.curved import surfaces as reference
from terrain_lod.tessellation.tessellator import tessellate

every_surface = pytest.mark.parametrize("name", SURFACES)
every_curve = pytest.mark.parametrize("name", CURVES)
CLOSED = ("sphere", "torus", "superquadric")


def coordinates(patches, factor, partitioning="fractional_odd"):
    """Return u and v of every vertex, over all patches."""
    across, down = patches
    factors = (np.full((across * down, width), factor) for width in (4, 2))
    pattern = tessellate("quad", *factors, partitioning=partitioning)
    patch = np.repeat(np.arange(across * down), np.diff(pattern.point_offsets))
    u, v = pattern.points.T / FIXED_ONE
    return (patch % across + u) / across, (patch // across + v) / down


@every_surface
@pytest.mark.parametrize("partitioning", PARTITIONINGS)
@pytest.mark.parametrize("factor", [1.7, 6])
def test_seams_close_to_the_bit(name, partitioning, factor):
    mesh = surface(name, patches=(7, 3), factor=factor, partitioning=partitioning)
    u, v = (np.rint(x * 2**32) for x in coordinates((7, 3), factor, partitioning))
    row = SURFACES[name]
    if "u" in row.closed:
        ends = mesh.vertices[u == 0], mesh.vertices[u == 2**32]
        order = np.argsort(v[u == 0]), np.argsort(v[u == 2**32])
        back = -1 if row.twisted else 1
        np.testing.assert_array_equal(ends[0][order[0]], ends[1][order[1]][::back])
    if "v" in row.closed:
        ends = mesh.vertices[v == 0], mesh.vertices[v == 2**32]
        order = np.argsort(u[v == 0]), np.argsort(u[v == 2**32])
        np.testing.assert_array_equal(ends[0][order[0]], ends[1][order[1]])


@every_surface
def test_surfaces_are_watertight(name):
    factor, patches = 5, (6, 4)
    report = crack_report(surface(name, patches=patches, factor=factor), closed=name in CLOSED)
    # a one-sided surface has neighbours that face opposite ways at one seam, and no crack
    assert report.unbalanced == (patches[1] * factor if SURFACES[name].twisted else 0)
    assert report.cracks == report.t_junctions == 0


@pytest.mark.parametrize("name", CLOSED)
def test_closed_surfaces_face_outwards(name):
    mesh = surface(name)
    corners = mesh.vertices[mesh.triangles].astype(float)
    assert np.linalg.det(corners).sum() > 1


@every_surface
def test_triangles_turn_with_the_normals(name):
    mesh = surface(name, factor=9)
    corners = mesh.vertices[mesh.triangles].astype(float)
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(facing, axis=1)
    u = coordinates((8, 4), 9)[0][mesh.triangles]
    # a twisted surface's last column has a normal of the other side at u = 1
    inner = (area > 1e-3 * area.max()) & ((u < 1).all(axis=1) | (not SURFACES[name].twisted))
    normals = mesh.normals[mesh.triangles].mean(axis=1)
    along = np.einsum("ij,ij->i", facing[inner], normals[inner]) / area[inner]
    assert (along > 0.5).all()


def test_poles_are_points_with_the_axis_for_normal():
    for name in ("sphere", "superquadric"):
        mesh = surface(name, patches=(5, 3))
        _, v = coordinates((5, 3), 5)
        for end, z in ((0, -1), (1, 1)):
            pole = v == end
            assert np.count_nonzero(pole) == 30
            np.testing.assert_array_equal(mesh.vertices[pole], np.tile([0, 0, z], (30, 1)))
            np.testing.assert_allclose(mesh.normals[pole], mesh.vertices[pole], atol=1e-6)


def test_the_equator_is_exact_in_the_quarters():
    mesh = surface("sphere", patches=(4, 2), factor=1)
    found = {tuple(p) for p in mesh.vertices.tolist()}
    assert found == {(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)}


def test_a_group_of_work_items_makes_what_one_makes(monkeypatch):
    alone = surface("klein", factor=6.1), curve("lissajous", factor=9)
    monkeypatch.setattr(Device, "group_size", lambda self, wanted=64: wanted)
    together = surface("klein", factor=6.1), curve("lissajous", factor=9)
    np.testing.assert_array_equal(together[0].vertices, alone[0].vertices)
    np.testing.assert_array_equal(together[0].normals, alone[0].normals)
    np.testing.assert_array_equal(together[1].points, alone[1].points)


@every_curve
def test_closed_curves_end_where_they_begin(name):
    made = curve(name, pieces=5, factor=7.7, partitioning="fractional_odd")
    assert made.closed == CURVES[name].closed == (made.points[0] == made.points[-1]).all()
    steps = np.linalg.norm(np.diff(made.points, axis=0), axis=1)
    assert len(steps) == 5 * 9
    assert (steps > 0).all()


def test_every_header_has_its_row_and_every_row_its_header():
    for kind, table, twins in (
        ("surface", SURFACES, reference.SURFACES),
        ("curve", CURVES, reference.CURVES),
    ):
        headers = {path.name for path in (KERNELS / "curved" / kind).iterdir()}
        assert headers == {f"{name}.h" for name in table}
        assert set(twins) == set(table)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: surface("cube"), "unknown surface 'cube': expected one of sphere, torus"),
        (lambda: surface("sphere", tube=1), "unknown tube= for sphere: expected radius"),
        (lambda: surface("torus", tube=0), "expected tube above 0"),
        (lambda: surface("torus", tube=np.inf), "expected a finite tube"),
        (lambda: surface("superquadric", along=2.5), "along from 0.1 to 2, got 2.5"),
        (lambda: surface("helicoid", turns=1.3), "a multiple of 0.5 for turns, got 1.3"),
        (lambda: surface("sphere", patches=(0, 4)), "whole number from 1 to 16384 for patches"),
        (lambda: surface("sphere", patches=4), r"patches as \(along u, along v\), got 4"),
        (lambda: surface("sphere", factor=-1), "factor > 0, got -1"),
        (lambda: surface("sphere", partitioning="even"), "unknown partitioning 'even'"),
        (lambda: curve("circle"), "unknown curve 'circle': expected one of helix"),
        (lambda: curve("torus_knot", p=1.5), "a whole number from 1 to 64 for p, got 1.5"),
        (lambda: curve("helix", pieces=0), "whole number from 1"),
        (lambda: curve("helix", factor=0), "factor > 0"),
        (lambda: surface("sphere", patches=(4000, 4000), factor=60), "at most 2147483648 indices"),
    ],
)
def test_bad_input_is_refused_in_one_line(make, message):
    with pytest.raises(InputError, match=message) as caught:
        make()
    assert "\n" not in str(caught.value)
