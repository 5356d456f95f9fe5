"""Meshes from files: what others wrote, and what is broken."""

from __future__ import annotations

import logging
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import pyvista

from support.curved_meshes import torus
from support.drawn_meshes import grid_mesh
from terrain_lod.errors import FileError, InputError, MissingExtraError
from terrain_lod.files.meshes.export import FORMATS, save
from terrain_lod.files.meshes.loading import load_mesh
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.measure.cracks import crack_report

SQUARE = """v 0 0 0
v 2 0 0
v 0 2 0
v 2 2 0
"""


@pytest.fixture
def obj(tmp_path):
    """Return a function that writes an OBJ file."""

    def write(text: str) -> Path:
        path = tmp_path / "some.obj"
        path.write_text(text)
        return path

    return write


def test_polygons_are_cut_and_lines_dropped_and_both_are_said(obj, caplog):
    with caplog.at_level(logging.INFO, "terrain_lod"):
        mesh = load_mesh(obj(SQUARE + "f 1 2 4 3\nl 1 2\n"))
    assert len(mesh.triangles) == 2
    assert "polygons cut into 2 triangles" in caplog.text
    assert "left out 1 lines" in caplog.text
    assert "normals computed from the triangles" in caplog.text
    np.testing.assert_array_equal(mesh.normals, np.tile([0, 0, 1], (4, 1)))
    assert mesh.origin.tolist() == [0, 0, 0]


def test_a_files_own_normals_are_kept(obj):
    normals = "vn 0 0.6 0.8\nvn 0 0 1\nvn 1 0 0\nvn 0 -1 0\n"
    mesh = load_mesh(obj(SQUARE + normals + "f 1//1 2//2 3//3\nf 2//2 4//4 3//3\n"))
    np.testing.assert_allclose(mesh.normals, [(0, 0.6, 0.8), (0, 0, 1), (1, 0, 0), (0, -1, 0)])


def test_large_coordinates_lose_nothing(obj):
    text = "v 500000.125 4000000.0625 8848.5\nv 500001 4000000 0\nv 500000 4000001.25 0\nf 1 2 3\n"
    mesh = load_mesh(obj(text))
    np.testing.assert_array_equal(
        mesh.vertices[0] + mesh.origin, [500000.125, 4000000.0625, 8848.5]
    )
    # near zero nothing moves
    assert mesh.origin.tolist() == [500000, 4000001, 0]


@pytest.mark.slow
def test_a_volume_gives_its_surface(tmp_path, caplog):
    grid = pyvista.ImageData(dimensions=(4, 4, 4))
    grid.save(tmp_path / "box.vti")
    with caplog.at_level(logging.INFO, "terrain_lod"):
        mesh = load_mesh(tmp_path / "box.vti")
    assert len(mesh.triangles) == 6 * 9 * 2
    assert "taking the surface of ImageData" in caplog.text


@pytest.mark.slow
def test_polygons_and_strips_of_vtk(tmp_path, caplog):
    # a bay, whose middle corner lies within, and a strip of two triangles; a line beside them
    points = [
        (0, 0, 0),
        (2, 0, 0),
        (2, 2, 0),
        (1, 0.5, 0),
        (3, 0, 0),
        (4, 0, 0),
        (3, 1, 0),
        (4, 1, 0),
    ]
    surface = pyvista.PolyData(
        np.array(points) + np.array([500_000.125, 0, 0]),
        faces=[4, 0, 1, 2, 3],
        strips=[4, 4, 5, 6, 7],
        lines=[2, 0, 4],
    )
    surface.save(tmp_path / "mixed.vtp")
    mesh = load_mesh(tmp_path / "mixed.vtp")
    assert len(mesh.triangles) == 4
    assert "left out 1 lines" in caplog.text
    np.testing.assert_array_equal(mesh.vertices[0] + mesh.origin, (500_000.125, 0, 0))
    a, b, c = np.moveaxis(mesh.vertices[mesh.triangles], 1, 0)
    areas = np.cross(b - a, c - a)[:, 2] / 2
    assert (areas > 0).all()
    assert areas.sum() == 1.5 + 1


def test_gltf_of_others_is_turned_z_up(tmp_path):
    ground = Heightmap(np.arange(12).reshape(3, 4), origin=(10.0, 20.0))
    path = save(grid_mesh(ground), tmp_path / "ground.glb")
    content = path.read_bytes()
    # the same bytes under another name
    path.write_bytes(content.replace(b'"generator":"terrain_lod"', b'"generator":"terrain_xyz"'))
    ours, theirs = grid_mesh(ground), load_mesh(path)
    world = ours.vertices + ours.origin
    np.testing.assert_allclose(theirs.vertices + theirs.origin, world, atol=1e-5)
    np.testing.assert_allclose(theirs.normals, ours.normals, atol=1e-6)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (SQUARE + "f 1 2 9\n", "among its 4 vertices, got corner 8 of face 0, counted from 0"),
        (SQUARE + "f 1 2 3\nf 1 2 4 -9\n", "among its 4 vertices, got corner -5 of face 1"),
        (SQUARE + "f 0 1 2\n", "among its 4 vertices, got corner -1 of face 0"),
        ("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", r"finite positions, got \(0, 0, nan\)"),
        ("v 0 0 inf\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", r"finite positions, got \(0, 0, inf\)"),
        (SQUARE + "l 1 2\n", "expected triangles in .*, got none"),
        (SQUARE, "expected triangles in .*, got none"),
        ("", "expected triangles in .*, got none"),
        (SQUARE + "f 1 2\nf 3\nf\n", "expected triangles in .*, got none"),
        ("v 1e39 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "that 32 bits can hold in .*, got 1e\\+39"),
        ("v 1e999 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", r"finite positions, got \(inf, 0, 0\)"),
    ],
)
def test_what_is_no_mesh_is_refused_in_one_line(obj, text, message):
    with pytest.raises(InputError, match=message) as caught:
        load_mesh(obj(text))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("v 0 0\nf 1 1 1\n", "expected 3 numbers of a vertex, got '0 0'"),
        ("v 0 0 x\nf 1 1 1\n", "expected 3 numbers of a vertex, got '0 0 x'"),
        ("v 0 0 0\nvt\nf 1 1 1\n", "expected 2 numbers of texture coordinates, got '0'"),
        ("v 0 0 0\nf 1 1 one\n", "a face's corners are no whole numbers"),
        ("v 0 0 0\nf 1 1 " + "9" * 30, "a face's corners are no whole numbers"),
        ("v 0 0 \0\n", "it is no text"),
        ("# terrain_lod origin 1 2 x\nv 0 0 0\n", "the origin in its comment is no three numbers"),
    ],
)
def test_a_damaged_file_is_refused_in_one_line(obj, text, message):
    with pytest.raises(FileError, match=f"^cannot read .*some.obj: {message}"):
        load_mesh(obj(text))


@pytest.mark.parametrize("number", ["inf", "nan", "1e400"])
def test_an_origin_that_is_nowhere_is_refused(obj, number):
    with pytest.raises(InputError, match="expected a finite origin of three numbers in"):
        load_mesh(obj(f"# terrain_lod origin {number} 0 0\n" + SQUARE + "f 1 2 3\n"))


def test_what_is_left_out_is_counted_in_one_line(obj, caplog):
    mesh = load_mesh(obj(SQUARE + "v nan nan nan\nl 1 2\np 3\nf 1 2\nf 1\nf 1 2 3\n"))
    assert mesh.vertices.tolist() == [[0, 0, 0], [2, 0, 0], [0, 2, 0]]
    warnings = [record for record in caplog.records if record.levelname == "WARNING"]
    assert [record.getMessage().partition(": ")[2] for record in warnings] == [
        "left out 1 lines, 1 points, 2 faces of fewer than three corners, 2 vertices of no triangle"
    ]


def test_texture_coordinates_and_normals_that_some_corners_lack_are_left_out(obj, caplog):
    more = "vt 0 0\nvn 0 0 -1\n"
    mesh = load_mesh(obj(SQUARE + more + "f 1/1/1 2/1/1 3/1/1\nf 2 4 3/2/2\n"))
    assert mesh.textures is None
    assert (mesh.normals == (0, 0, 1)).all()
    assert len(mesh.vertices) == 4
    assert "1 texture coordinates, as not every corner has them, 1 normals, as" in caplog.text


@pytest.mark.slow
@pytest.mark.parametrize("ending", [".off", ".msh", ".inp", ".mesh", ".vol", ".mdpa"])
def test_formats_that_meshio_knows(tmp_path, ending):
    meshio = pytest.importorskip("meshio")
    expected, path = torus(), tmp_path / f"ring{ending}"
    meshio.Mesh(expected.vertices.astype(float), [("triangle", expected.triangles)]).write(path)
    mesh = load_mesh(path)
    corners = (mesh.vertices + mesh.origin)[mesh.triangles]
    np.testing.assert_allclose(corners, expected.vertices[expected.triangles], atol=1e-6)
    assert not crack_report(mesh, closed=True)
    path.write_bytes(path.read_bytes()[:40])
    with pytest.raises((FileError, InputError), match=r"expected|cannot read") as caught:
        load_mesh(path)
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_corners_out_of_range_in_a_format_of_meshio(tmp_path):
    pytest.importorskip("meshio")
    path = tmp_path / "outside.mesh"
    path.write_text(
        "MeshVersionFormatted 2\nDimension\n3\nVertices\n3\n0 0 0 0\n1 0 0 0\n0 1 0 0\n"
        "Triangles\n1\n1 2 8 0\nEnd\n"
    )
    with pytest.raises(InputError, match=r"among its 3 vertices, got \[7\]"):
        load_mesh(path)


@pytest.mark.slow
def test_without_meshio_one_line_says_what_to_install(tmp_path, monkeypatch):
    # the reader's process finds a package of that name that cannot be imported
    (tmp_path / "meshio.py").write_text("raise ImportError")
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "ring.msh").write_text("?")
    with pytest.raises(MissingExtraError, match=r"ring\.msh: .* install 'terrain_lod\[meshes\]'"):
        load_mesh(tmp_path / "ring.msh")


@pytest.mark.slow
def test_a_reader_that_dies_is_an_error_in_one_line(tmp_path, monkeypatch):
    (tmp_path / "meshio.py").write_text("import os, signal\nos.kill(os.getpid(), signal.SIGSEGV)")
    (tmp_path / "ring.msh").write_text("?")
    with monkeypatch.context() as patch:
        patch.syspath_prepend(tmp_path)
        with pytest.raises(FileError, match=r"ring\.msh: its reader crashed \(SIGSEGV\)"):
            load_mesh(tmp_path / "ring.msh")
    (tmp_path / "meshio.py").write_text("import time\ntime.sleep(60)")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr("terrain_lod.files.meshes.child._SECONDS", 3.0)
    with pytest.raises(FileError, match=r"ring\.msh: its reader found no end in 3 s"):
        load_mesh(tmp_path / "ring.msh")


# texture coordinates


@pytest.mark.slow
@pytest.mark.parametrize("ending", [".glb", ".obj", ".ply", ".vtp"])
def test_texture_coordinates_come_back(tmp_path, ending):
    ring = torus()
    textures = np.random.default_rng(1).uniform(-1, 2, (len(ring.vertices), 2)).astype(np.float32)
    mesh = load_mesh(save(replace(ring, textures=textures), tmp_path / f"ring{ending}"))
    # files may split vertices and put them in another order
    found = np.concatenate([mesh.vertices, mesh.textures], axis=1)
    expected = np.concatenate([ring.vertices, textures], axis=1)
    corners = found[mesh.triangles.ravel()], expected[ring.triangles.ravel()]
    np.testing.assert_allclose(*corners, atol=1e-5)
    assert load_mesh(save(ring, tmp_path / f"bare{ending}")).textures is None


def test_texture_coordinates_of_others(tmp_path, obj):
    # a seam: one position, two pairs
    pairs = "vt 0 0\nvt 1 0\nvt 0 1\nvt 0.5 0.25\n"
    mesh = load_mesh(obj(SQUARE + pairs + "f 1/1 2/2 3/3\nf 2/4 4/2 3/3\n"))
    assert mesh.textures[mesh.triangles].tolist() == [
        [[0, 0], [1, 0], [0, 1]],
        [[0.5, 0.25], [1, 0], [0, 1]],
    ]
    # glTF of others counts v from the top
    path = save(replace(torus(), textures=np.full((128, 2), 0.25, np.float32)), tmp_path / "a.glb")
    path.write_bytes(path.read_bytes().replace(b'"terrain_lod"', b'"terrain_xyz"'))
    np.testing.assert_array_equal(load_mesh(path).textures, 0.25)
    assert b"TEXCOORD_0" in path.read_bytes()


@pytest.mark.slow
def test_files_that_are_not_there_or_unknown(tmp_path):
    with pytest.raises(FileError, match="expected a mesh file, got none at"):
        load_mesh(tmp_path / "missing.ply")
    with pytest.raises(FileError, match="expected a mesh file, got none at"):
        load_mesh(tmp_path)
    with pytest.raises(FileError, match="File name too long"):
        load_mesh(tmp_path / ("x" * 300 + ".ply"))
    (tmp_path / "what.fbx2").write_text("?")
    with pytest.raises(InputError, match=r"unknown mesh format '\.fbx2': expected \.glb, "):
        load_mesh(tmp_path / "what.fbx2")


TRUNCATED = """
import logging
import sys
from pathlib import Path
from terrain_lod.errors import TerrainError
from terrain_lod.files.meshes.loading import load_mesh
logging.disable()
path = Path(sys.argv[1])
content = path.read_bytes()
for length in (0, 3, 100, len(content) // 2, len(content) * 3 // 4):
    path.write_bytes(content[:length])
    try:
        print(load_mesh(path))
    except TerrainError as error:
        print("refused:", error)
"""


@pytest.mark.slow
@pytest.mark.parametrize("ending", FORMATS)
def test_a_truncated_file_is_refused_in_one_line(tmp_path, ending):
    # in a child process: a crash would be a failure of this test alone
    path = save(grid_mesh(Heightmap(np.zeros((20, 20)))), tmp_path / f"ground{ending}")
    command = [sys.executable, "-c", TRUNCATED, str(path)]
    child = subprocess.run(command, capture_output=True, text=True, check=True)
    lines = child.stdout.splitlines()
    assert len(lines) == 5
    # text that ends within its faces cannot be told from a smaller mesh
    refused = lines[:3] if ending == ".obj" else lines
    assert all(line.startswith("refused: ") for line in refused), child.stdout
    assert not child.stderr
