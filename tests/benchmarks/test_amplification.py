"""Ways to amplify: one surface, whatever the way; counts; what is refused."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from amplify import reference
from amplify.ways import WAYS, Scene, _kernel, amplify, emitters_per_triangle, triangles_of

from support.curved_meshes import CLOSED, cube, torus
from terrain_lod.camera.camera import Camera
from terrain_lod.curved.adjacency import Adjacency
from terrain_lod.curved.smooth import pn_triangles
from terrain_lod.device.device import Device
from terrain_lod.drawing.graphics import graphics_problem
from terrain_lod.drawing.picture import draw
from terrain_lod.errors import InputError
from terrain_lod.measure.cracks import crack_report
from terrain_lod.mesh.mesh import Mesh

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
LEVELS = (1, 3, 5, 9, 15)


def two_copies():
    """As it is, and turned a third of pi and shifted."""
    cosine, sine = np.cos(np.pi / 3), np.sin(np.pi / 3)
    turned = [[cosine, -sine, 0, 4], [sine, cosine, 0, -1], [0, 0, 1, 0.5]]
    return np.array([np.eye(3, 4), turned])


def corners(mesh):
    return mesh.vertices[mesh.triangles], mesh.normals[mesh.triangles]


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("level", LEVELS)
def test_every_way_makes_the_same_corners_in_the_same_order(way, level):
    mesh, copies = torus(8, 5), two_copies()
    found = amplify(mesh, level, way=way, transforms=copies)
    positions, normals = corners(found)
    expected = corners(amplify(mesh, level, way="indexed", transforms=copies))
    assert len(positions) == 2 * len(mesh.triangles) * triangles_of(level)
    # what is stored is placed after it is evaluated, the others before
    ulp = np.spacing(np.abs(positions).max()) if way == "stored" else 0
    np.testing.assert_allclose(positions, expected[0], rtol=0, atol=4 * ulp)
    np.testing.assert_allclose(normals, expected[1], rtol=0, atol=4e-7 if ulp else 0)


@pytest.mark.parametrize("way", WAYS)
def test_unmoved_copy_is_the_curved_mesh_bit_for_bit(way):
    mesh = torus(8, 5)
    found, expected = amplify(mesh, 7, way=way), pn_triangles(mesh, 7)
    np.testing.assert_array_equal(corners(found)[0], corners(expected)[0])


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", CLOSED)
def test_closed_stays_closed(way, name):
    assert not crack_report(amplify(CLOSED[name](), 5, way=way))


@pytest.mark.skipif(graphics_problem() is not None, reason="no 3-D pictures here")
def test_every_way_draws_the_same_picture():
    mesh = cube()
    camera = Camera((3, -4, 3), (0.5, 0.5, 0.5), fov=25, size=(160, 120))
    pictures = [draw(amplify(mesh, 5, way=way), camera) for way in WAYS]
    for picture in pictures[1:]:
        np.testing.assert_array_equal(picture, pictures[0])


@pytest.mark.parametrize("level", [1, 3, 5, 7, 11, 15])
def test_counts_and_emitters_are_those_of_the_rings(level):
    assert triangles_of(level) == len(reference.triangles(level))
    for quads in (False, True):
        records = reference.emitters(level, quads=quads)
        assert emitters_per_triangle(level, quads=quads) == len(records)
        assert emitters_on_device(level, quads) == records


def emitters_on_device(level, quads):
    """Return ring, side and first of the second of two patches."""
    device, each = Device.open(), emitters_per_triangle(level, quads=quads)
    records = device.empty((2 * each, 4), np.int32)
    _kernel(device, "emitters", QUADS=int(quads))(
        (2,), (64,), patches=2, level=level, each=each, records=records
    )
    found = records.host()[each:]
    assert (found[:, 0] == 1).all()
    return [tuple(record) for record in found[:, 1:].tolist()]


@pytest.mark.parametrize("way", WAYS)
def test_agrees_with_float64(way):
    mesh, turn = bulging_tent(), two_copies()[1]
    wide = mesh.vertices.astype(np.float64), mesh.normals.astype(np.float64)
    positions, normals = reference.sub_triangles(Adjacency.of(mesh).patches, *wide, 7)
    found = corners(amplify(mesh, 7, way=way, transforms=turn[None]))
    # coordinates of up to 8, and normals of sums that cancel
    placed = (positions @ turn[:, :3].T + turn[:, 3]).reshape(-1, 3, 3)
    np.testing.assert_allclose(found[0], placed, rtol=0, atol=4e-6)
    turned = (normals @ turn[:, :3].T).reshape(-1, 3, 3)
    np.testing.assert_allclose(found[1], turned, rtol=0, atol=2e-5)


def bulging_tent():
    """Return an open fan of six triangles with normals that lean in all directions."""
    angle = np.arange(6) * np.pi / 3
    rim = np.stack([np.cos(angle), np.sin(angle), 0.2 * np.sin(2 * angle)], axis=1)
    vertices = np.concatenate([[(0, 0, 1)], rim]).astype(np.float32)
    normals = vertices + np.float32(0.3) * np.roll(vertices, 1, axis=0)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    around = np.arange(6)
    triangles = np.stack([np.zeros(6), 1 + around, 1 + (around + 1) % 6], axis=1)
    return Mesh(vertices, normals, triangles.astype(np.int32))


def test_stored_keeps_a_level_s_triangles_and_on_the_fly_nearly_nothing():
    mesh, device = torus(), Device.open()
    scene = Scene.upload(mesh, None, device)
    kept = {way: prepare(scene, 11).kept for way, prepare in WAYS.items()}
    control = len(mesh.triangles) * 3 * 24
    # the thesis: roughly 200 times at level 11
    assert kept["stored"] == 181 * control
    assert kept["direct"] == kept["fixed"] < control
    assert kept["indexed"] == kept["passed"] == 16 * len(mesh.triangles)
    assert kept["direct"] < kept["borders"] < kept["quads"] < kept["stored"]


def test_adjacency_is_kept_so_that_sharp_edges_are_closed():
    mesh = cube()
    assert Scene.upload(mesh, None, Device.open()).mesh.edges.shape == (12, 3)
    assert len(Adjacency.of(mesh).sides) == 18


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"level": 4}, "expected an odd level, got 4"),
        ({"level": 65}, "from 1 to 63 for level"),
        ({"way": "geometry"}, "unknown way 'geometry': expected one of fixed, direct"),
        ({"transforms": np.eye(4)}, r"expected finite transforms of shape (K, 3, 4), got (4, 4)"),
        ({"transforms": np.full((1, 3, 4), np.nan)}, "expected finite transforms"),
    ],
)
def test_wrong_arguments_get_one_line(wrong, says):
    with pytest.raises(InputError, match=re.escape(says)):
        amplify(cube(), **wrong)


def test_empty_mesh_is_refused():
    nothing = np.zeros((0, 3), np.float32)
    with pytest.raises(InputError, match="empty mesh"):
        amplify(Mesh(nothing, nothing, np.zeros((0, 3), np.int32)))


@pytest.mark.slow
def test_benchmark_prints_and_draws(tmp_path):
    script, picture = BENCHMARKS / "amplification.py", tmp_path / "a.svg"
    command = [sys.executable, script, "--levels", "1", "3", "--rounds", "1", "--copies", "2"]
    done = subprocess.run([*command, "--out", picture], capture_output=True, text=True, check=True)
    count = re.search(r"1 character of (\d+) triangles: milliseconds a frame", done.stdout)
    assert count is not None
    assert 1900 < int(count[1]) < 2100
    assert "181 times" in done.stdout
    assert picture.read_text().startswith("<?xml")
