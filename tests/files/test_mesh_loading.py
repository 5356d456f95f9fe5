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
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from support.curved_meshes import torus
from support.drawn_meshes import grid_mesh
from terrain_lod.errors import FileError, InputError, MissingExtraError
from terrain_lod.files.meshes.export import FORMATS, save
from terrain_lod.files.meshes.loading import load_mesh
from terrain_lod.files.meshes.ply import require_whole_ply
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
    assert "dropping 1 lines and points" in caplog.text
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


def test_a_volume_gives_its_surface(tmp_path, caplog):
    grid = pyvista.ImageData(dimensions=(4, 4, 4))
    grid.save(tmp_path / "box.vti")
    with caplog.at_level(logging.INFO, "terrain_lod"):
        mesh = load_mesh(tmp_path / "box.vti")
    assert len(mesh.triangles) == 6 * 9 * 2
    assert "taking the surface of ImageData" in caplog.text


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
        (SQUARE + "f 1 2 9\n", r"among its 4 vertices, got \[0, 1, 8\] at triangle 0"),
        (SQUARE + "f 1 2 4 9\n", r"among its 4 vertices, got \[8\]"),
        ("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", r"finite positions, got \(0, 0, nan\)"),
        ("v 0 0 inf\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", r"finite positions, got \(0, 0, inf\)"),
        (SQUARE + "l 1 2\n", "expected triangles in .*, got none"),
        (SQUARE, "expected triangles in .*, got none"),
        ("", "expected triangles in .*, got none"),
    ],
)
def test_what_is_no_mesh_is_refused_in_one_line(obj, text, message):
    with pytest.raises(InputError, match=message) as caught:
        load_mesh(obj(text))
    assert "\n" not in str(caught.value)


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


def test_corners_out_of_range_in_a_format_of_meshio(tmp_path):
    pytest.importorskip("meshio")
    path = tmp_path / "outside.off"
    path.write_text("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n")
    with pytest.raises(InputError, match=r"among its 3 vertices, got \[7\]"):
        load_mesh(path)


def test_without_meshio_one_line_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "meshio", None)
    (tmp_path / "ring.off").write_text("OFF\n")
    with pytest.raises(MissingExtraError, match=r"ring\.off: .* install 'terrain_lod\[meshes\]'"):
        load_mesh(tmp_path / "ring.off")


# texture coordinates


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


def test_files_that_are_not_there_or_unknown(tmp_path):
    with pytest.raises(FileError, match="expected a mesh file, got none at"):
        load_mesh(tmp_path / "missing.ply")
    with pytest.raises(FileError, match="expected a mesh file, got none at"):
        load_mesh(tmp_path)
    (tmp_path / "what.fbx2").write_text("?")
    with pytest.raises(InputError, match=r"unknown mesh format '\.fbx2': expected \.glb, "):
        load_mesh(tmp_path / "what.fbx2")


TRUNCATED = """
import sys
from pathlib import Path
from terrain_lod.errors import TerrainError
from terrain_lod.files.meshes.loading import load_mesh
path = Path(sys.argv[1])
content = path.read_bytes()
for length in (0, 3, 100, len(content) // 2, len(content) * 3 // 4):
    path.write_bytes(content[:length])
    try:
        print(load_mesh(path))
    except TerrainError as error:
        print("refused:", error)
"""


@pytest.mark.parametrize("ending", FORMATS)
def test_a_truncated_file_is_refused_in_one_line(tmp_path, ending):
    # in a child process: VTK may crash
    path = save(grid_mesh(Heightmap(np.zeros((20, 20)))), tmp_path / f"ground{ending}")
    command = [sys.executable, "-c", TRUNCATED, str(path)]
    child = subprocess.run(command, capture_output=True, text=True, check=True)
    lines = child.stdout.splitlines()
    assert len(lines) == 5
    # text that ends after a whole face cannot be told from a smaller mesh
    refused = lines[:4] if ending == ".obj" else lines
    assert all(line.startswith("refused: ") for line in refused), child.stdout
    assert not child.stderr


# PLY

HEADER = """ply
format {form} 1.0
comment drawn
element vertex 4
property float x
property float y
property float z
element face {faces}
property list uchar int vertex_indices
end_header
"""


def binary_ply(faces, order="<"):
    """Return a binary PLY file of four vertices and these faces."""
    form = "binary_little_endian" if order == "<" else "binary_big_endian"
    body = np.arange(12).astype(order + "f4").tobytes()
    for face in faces:
        body += bytes([len(face)]) + np.array(face, order + "i4").tobytes()
    return HEADER.format(form=form, faces=len(faces)).encode() + body


def text_ply(faces):
    """Return a PLY file in text."""
    rows = ["0 0 0", "1 0 0", "0 1 0", "1 1 0"]
    rows += [" ".join(map(str, [len(face), *face])) for face in faces]
    return (HEADER.format(form="ascii", faces=len(faces)) + "\n".join(rows)).encode()


FACES = st.lists(st.lists(st.integers(0, 3), min_size=3, max_size=5), min_size=1, max_size=5)


@settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(faces=FACES, form=st.sampled_from(["<", ">", "text"]), data=st.data())
def test_a_ply_file_is_whole_or_refused_at_any_length(tmp_path, faces, form, data):
    content = text_ply(faces) if form == "text" else binary_ply(faces, form)
    path = tmp_path / "some.ply"
    path.write_bytes(content + data.draw(st.sampled_from([b"", b"\n", b"more"])))
    require_whole_ply(path)
    length = data.draw(st.integers(0, len(content) - 1))
    if form == "text" and content[length - 1 : length + 1].isdigit():
        length -= 1  # inside a number
    path.write_bytes(content[:length])
    with pytest.raises(FileError):
        require_whole_ply(path)


@pytest.mark.parametrize(
    "header",
    [
        b"solid\n",
        b"ply\nformat binary_middle_endian 1.0\nend_header\n",
        b"ply\nformat ascii 1.0\nelement vertex many\nend_header\n",
        b"ply\nformat ascii 1.0\nproperty float x\nend_header\n",
        b"ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n",
    ],
)
def test_a_header_that_is_none_is_refused(tmp_path, header):
    path = tmp_path / "some.ply"
    path.write_bytes(header)
    with pytest.raises(FileError, match="expected a PLY"):
        require_whole_ply(path)


def test_mixed_polygons_of_a_binary_ply(tmp_path):
    path = tmp_path / "mixed.ply"
    path.write_bytes(binary_ply([(0, 1, 2), (0, 1, 3, 2)]))
    assert len(load_mesh(path).triangles) == 3
