"""Mesh files: whole or not there, exact in every format, clean for the Khronos validator."""

from __future__ import annotations

import json
import shutil
import struct
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from support.drawn_meshes import grid_mesh, mesh_of
from terrain_lod.errors import FileError, InputError
from terrain_lod.files.meshes.export import FORMATS, save
from terrain_lod.files.meshes.glb import write_glb
from terrain_lod.files.meshes.loading import load_mesh
from terrain_lod.ground.grid import TileGrid
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.mesh.bake import bake_normals
from terrain_lod.mesh.mesh import Mesh, Patches
from terrain_lod.mesh.normals import vertex_normals


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    """A piece of ground far from zero, its numbers not round in any base."""
    row, column = np.mgrid[:9, :12]
    ground = Heightmap(
        np.sin(row / 2) * np.cos(column / 3) * 50 / 3,
        spacing=(30.1, 10.7),
        origin=(500_000.1, 4_000_000.3),
        base=1234.56789,
    )
    drawn = grid_mesh(ground)
    normals = vertex_normals(drawn.vertices, drawn.triangles).astype(np.float32)
    return replace(drawn, normals=normals, crs="EPSG:32633")


def facets(mesh: Mesh) -> np.ndarray:
    """Return the positions of every triangle's corners, the triangles in a fixed order."""
    corners = mesh.vertices[mesh.triangles].reshape(-1, 9) + np.float32(0)  # no -0
    return corners[np.lexsort(corners.T)]


# files


@pytest.mark.parametrize("ending", FORMATS)
def test_what_is_saved_is_what_is_loaded(mesh, tmp_path, ending):
    path = tmp_path / f"ground{ending}"
    assert save(mesh, path) == path
    assert list(tmp_path.iterdir()) == [path]
    loaded = load_mesh(path)
    np.testing.assert_array_equal(loaded.origin, mesh.origin)
    np.testing.assert_array_equal(facets(loaded), facets(mesh))
    if ending == ".stl":
        # facets only: vertices are merged and normals computed again, and the CRS has no room
        assert len(loaded.vertices) == len(mesh.vertices)
        assert loaded.crs is None
    else:
        np.testing.assert_array_equal(loaded.vertices, mesh.vertices)
        np.testing.assert_array_equal(loaded.triangles, mesh.triangles)
        np.testing.assert_allclose(loaded.normals, mesh.normals, atol=1e-6)
        assert loaded.crs == mesh.crs
    assert (loaded.vertices.dtype, loaded.triangles.dtype) == (np.float32, np.int32)
    assert loaded.origin.dtype == np.float64


@pytest.mark.parametrize("ending", FORMATS)
def test_a_mesh_without_origin_and_crs(tmp_path, ending):
    triangle = mesh_of(np.eye(3), [(0, 1, 2)])
    loaded = load_mesh(save(triangle, tmp_path / f"one{ending}"))
    assert loaded.origin.tolist() == [0, 0, 0]
    assert loaded.crs is None


def test_the_ending_may_be_in_capitals_and_a_file_is_replaced(mesh, tmp_path):
    path = tmp_path / "GROUND.PLY"
    path.write_text("old")
    assert len(load_mesh(save(mesh, str(path))).triangles) == len(mesh.triangles)


def test_an_origin_too_long_for_stl_is_left_out_and_said(mesh, tmp_path, caplog):
    origin = -np.array([1.2345678901234567e-15, 2.2345678901234567e-15, 3.2345678901234567e-15])
    path = save(replace(mesh, origin=origin), tmp_path / "ground.stl")
    assert "does not fit an STL header" in caplog.text
    assert load_mesh(path).origin.tolist() == [0, 0, 0]


def test_what_cannot_be_saved_is_refused_in_one_line(mesh, tmp_path):
    for name, message in (
        ("ground.fbx", r"'\.fbx': expected a name that ends in \.glb, \.obj, \.ply, \.stl, \.vtp"),
        ("ground", r"unknown mesh format ''"),
    ):
        with pytest.raises(InputError, match=message):
            save(mesh, tmp_path / name)
    with pytest.raises(FileError, match=r"expected a folder to write ground\.glb in"):
        save(mesh, tmp_path / "missing" / "ground.glb")
    with pytest.raises(InputError, match=r"expected triangles to save in ground\.glb"):
        save(mesh_of(np.eye(3), []), tmp_path / "ground.glb")
    with pytest.raises(InputError, match="finite positions"):
        save(mesh_of(np.full((3, 3), np.nan), [(0, 1, 2)]), tmp_path / "ground.glb")
    assert not list(tmp_path.iterdir())


FULL_DISK = """
import resource, signal, sys
sys.path.insert(0, {tests!r})
import numpy as np
from support.drawn_meshes import grid_mesh
from terrain_lod.errors import FileError
from terrain_lod.files.meshes.export import save
from terrain_lod.ground.heightmap import Heightmap
mesh = grid_mesh(Heightmap(np.zeros((60, 60))))
save(mesh, {warm_up!r})
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, resource.RLIM_INFINITY))
try:
    save(mesh, {path!r})
except FileError as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="limits the size of a file")
@pytest.mark.parametrize("ending", FORMATS)
def test_a_full_disk_leaves_nothing_behind(tmp_path, ending):
    folder = tmp_path / "full"
    folder.mkdir()
    path = folder / f"ground{ending}"
    path.write_text("what was there")
    code = FULL_DISK.format(
        tests=str(Path(__file__).parents[1]),
        path=str(path),
        warm_up=str(tmp_path / f"warm{ending}"),
    )
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert child.stdout.startswith(f"cannot write {path}: ")
    assert child.stdout.count("\n") == 1
    assert not child.stderr
    assert list(folder.iterdir()) == [path]
    assert path.read_text() == "what was there"


# GLB


def parts_of_glb(path: Path) -> tuple[dict, bytes]:
    """Return document and buffer of a GLB file, its container checked on the way."""
    content = path.read_bytes()
    magic, version, total = struct.unpack_from("<4sII", content)
    assert (magic, version, total) == (b"glTF", 2, len(content))
    length, kind = struct.unpack_from("<I4s", content, 12)
    assert (kind, length % 4) == (b"JSON", 0)
    size, kind = struct.unpack_from("<I4s", content, 20 + length)
    assert (kind, size % 4) == (b"BIN\0", 0)
    assert 28 + length + size == total
    return json.loads(content[20 : 20 + length]), content[28 + length :]


def test_glb_holds_what_its_document_says(mesh, tmp_path):
    document, buffer = parts_of_glb(save(mesh, tmp_path / "ground.glb"))
    assert document["buffers"] == [{"byteLength": len(buffer)}]
    assert [view["target"] for view in document["bufferViews"]] == [34962, 34962, 34963]
    vertices, normals, corners = (
        np.frombuffer(buffer, kind, view["byteLength"] // 4, view["byteOffset"]).reshape(-1, 3)
        for kind, view in zip(("<f4", "<f4", "<u4"), document["bufferViews"], strict=True)
    )
    np.testing.assert_array_equal(vertices, mesh.vertices)
    np.testing.assert_array_equal(normals, mesh.normals)
    np.testing.assert_array_equal(corners, mesh.triangles)
    position, _, index = document["accessors"]
    np.testing.assert_array_equal(np.float32(position["min"]), vertices.min(axis=0))
    np.testing.assert_array_equal(np.float32(position["max"]), vertices.max(axis=0))
    assert (position["count"], index["count"]) == (len(vertices), corners.size)


def test_glb_stands_y_up_at_its_origin(mesh, tmp_path):
    document, _ = parts_of_glb(save(mesh, tmp_path / "ground.glb"))
    (node,) = document["nodes"]
    assert node["extras"]["origin"] == mesh.origin.tolist()
    assert node["extras"]["crs"] == "EPSG:32633"
    # rotate as glTF does: v + 2 q x (q x v + w v)
    *axis, w = node["rotation"]
    local = mesh.vertices.astype(np.float64)
    turned = local + 2 * np.cross(axis, np.cross(axis, local) + w * local)
    x, y, z = (local + mesh.origin).T
    np.testing.assert_allclose(
        turned + node["translation"], np.stack([x, z, -y], axis=1), rtol=1e-14
    )


def odd_mesh() -> Mesh:
    """Return a mesh with all that is legal and odd: no area, no use, no unit normals."""
    odd = mesh_of(np.eye(5, 3), [(0, 1, 2), (0, 0, 1), (3, 4, 3)])
    normals = np.float32([(0, 0, 0), (0, 0, 2), (np.nan, 0, 0), (1e-30, 0, 0), (0, 1, 0)])
    return replace(odd, normals=normals)


def test_glb_normals_are_unit_vectors_whatever_comes(tmp_path):
    document, buffer = parts_of_glb(save(odd_mesh(), tmp_path / "odd.glb"))
    view = document["bufferViews"][1]
    normals = np.frombuffer(buffer, "<f4", 15, view["byteOffset"]).reshape(-1, 3)
    expected = [(0, 0, 1), (0, 0, 1), (0, 0, 1), (1, 0, 0), (0, 1, 0)]
    np.testing.assert_allclose(normals, expected, atol=1e-6)


VALIDATE = """
require('gltf-validator')
    .validateBytes(new Uint8Array(require('fs').readFileSync(process.argv[1])))
    .then(report => console.log(JSON.stringify(report.issues)))
"""


@pytest.fixture(scope="module")
def validate():
    """Return a function that gives the Khronos validator's issues with a file."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("GLB NOT VALIDATED: no node here; apt install nodejs npm")
    if subprocess.run([node, "-e", "require('gltf-validator')"], capture_output=True).returncode:
        pytest.skip("GLB NOT VALIDATED: npm install --no-save gltf-validator, or set NODE_PATH")

    def issues(path: Path) -> dict:
        command = [node, "-e", VALIDATE, str(path)]
        return json.loads(subprocess.run(command, capture_output=True, check=True).stdout)

    return issues


def test_khronos_validator_finds_nothing(validate, mesh, tmp_path):
    found = validate(save(mesh, tmp_path / "ground.glb"))
    assert found["messages"] == []
    mapped = bake_normals(mesh, mesh, (16, 8))
    assert validate(save(mapped, tmp_path / "mapped.glb"))["messages"] == []
    # triangles with two equal corners are a remark, no more
    found = validate(save(odd_mesh(), tmp_path / "odd.glb"))
    assert [message["code"] for message in found["messages"]] == [
        "ACCESSOR_INDEX_TRIANGLE_DEGENERATE"
    ]
    assert (found["numErrors"], found["numWarnings"]) == (0, 0)


def test_khronos_validator_would_find_something(validate, mesh, tmp_path):
    path = save(mesh, tmp_path / "ground.glb")
    content = path.read_bytes()
    path.write_bytes(content[:-4] + b"\xff\xff\xff\x7f")
    assert validate(path)["numErrors"] > 0


# pyvista


def test_pyvista_shares_memory_and_knows_the_patches(mesh):
    patches = Patches(
        grid=TileGrid(9, 17, 8, (1.0, 1.0)),
        areas=np.int32([[0, 0, 8, 8], [0, 8, 8, 8]]),
        edge_factors=np.float32([[1, 1, 1, 1], [3, 3, 3, 3]]),
        inside_factors=np.float32([[1, 5], [3, 3]]),
        point_offsets=np.array([0, 50, 108]),
        triangle_offsets=np.array([0, 100, len(mesh.triangles)]),
        deviation=np.float32([0.5, 2.5]),
    )
    surface = replace(mesh, patches=patches).to_pyvista()
    assert np.shares_memory(surface.points, mesh.vertices)
    np.testing.assert_array_equal(surface.regular_faces, mesh.triangles)
    np.testing.assert_array_equal(surface.point_data["Normals"], mesh.normals)
    assert surface.point_data.active_normals_name == "Normals"
    assert surface.field_data["origin"].tolist() == mesh.origin.tolist()
    assert surface.cell_data["patch"][[0, 99, 100, -1]].tolist() == [0, 0, 1, 1]
    assert surface.cell_data["factor"][[0, -1]].tolist() == [5, 3]
    assert surface.cell_data["deviation"][[0, -1]].tolist() == [0.5, 2.5]
    assert mesh.to_pyvista().cell_data.keys() == []


def test_pyvista_takes_an_empty_mesh():
    assert mesh_of(np.zeros((0, 3)), []).to_pyvista().n_cells == 0


def test_glb_of_no_size_that_the_format_can_say(mesh, tmp_path, monkeypatch):
    monkeypatch.setattr("terrain_lod.files.meshes.glb._LARGEST", 1000)
    with pytest.raises(InputError, match=r"at most 4 GiB for a \.glb, got \d+ bytes"):
        write_glb(mesh, tmp_path / "ground.glb")
