"""glTF of others: every kind of array, nodes that turn and mirror, and what cannot be believed."""

from __future__ import annotations

import json

import numpy as np
import pytest

from support.mesh_files import CUBE, TETRAHEDRON, Gltf, gltf, y_up
from terrain_lod.errors import FileError, InputError, MissingExtraError
from terrain_lod.files.meshes import readers
from terrain_lod.files.meshes.loading import load_mesh


@pytest.fixture
def load(tmp_path):
    """Return a function that loads bytes as a .glb, or with another ending."""

    def loaded(content: bytes, ending: str = ".glb"):
        path = tmp_path / f"some{ending}"
        path.write_bytes(content)
        return load_mesh(path)

    return loaded


def test_a_buffer_in_a_file_of_its_own(load, tmp_path):
    document = gltf(TETRAHEDRON)
    (tmp_path / "the buffer.bin").write_bytes(document.buffer)
    mesh = load(document.json("the%20buffer.bin"), ".gltf")
    np.testing.assert_array_equal(mesh.vertices, TETRAHEDRON.points)
    np.testing.assert_array_equal(mesh.triangles, TETRAHEDRON.triangles)
    for missing in ("nowhere.bin", "https://example.org/a.bin", "."):
        with pytest.raises(FileError, match=r"there is no '.*' beside it"):
            load(document.json(missing), ".gltf")


def test_normals_and_textures_follow_their_node(load):
    document = Gltf()
    points = y_up(np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)])).astype("<f4")
    normals = np.tile(np.float32([(0.6, 0.8, 0)]), (3, 1))
    pairs = np.float32([(0, 0), (1, 0), (0, 1)])
    position = document.accessor(points)
    document.primitive(position)
    document.document["meshes"][0]["primitives"][0]["attributes"] |= {
        "NORMAL": document.accessor(normals),
        "TEXCOORD_0": document.accessor(pairs),
    }
    document.document["nodes"][0] |= {"scale": [2, 1, -1], "translation": [3, 4, 5]}
    mesh = load(document.glb())
    # the first of x, y, z in a glTF is east, the second is up, the third is south
    found = mesh.vertices + mesh.origin
    np.testing.assert_allclose(found, [(3, -5, 4), (5, -5, 4), (3, -6, 4)])
    # a surface twice as wide is half as steep
    expected = np.array((0.3, 0, 0.8)) / np.hypot(0.3, 0.8)
    np.testing.assert_allclose(mesh.normals, [expected] * 3, atol=1e-6)
    assert mesh.textures.tolist() == [[0, 1], [1, 1], [0, 0]]
    # mirrored: the last two corners change places, so that the outside stays outside
    a, b, c = mesh.vertices[mesh.triangles[0]]
    assert np.cross(b - a, c - a)[2] > 0


def test_primitives_that_share_vertices_do_so_here(load):
    document = gltf(CUBE)
    first = document.document["meshes"][0]["primitives"][0]
    corners = CUBE.triangles.ravel().astype("<u2")
    first["indices"] = document.accessor(corners[:18])
    document.primitive(first["attributes"]["POSITION"], document.accessor(corners[18:]))
    mesh = load(document.glb())
    assert (len(mesh.vertices), len(mesh.triangles)) == (8, 12)


def test_lines_and_what_is_in_no_scene_are_left_out(load, caplog):
    document = gltf(CUBE)
    document.primitive(0, mode=1)
    document.document["nodes"].append({"mesh": 0, "translation": [9, 9, 9]})
    assert len(load(document.glb()).triangles) == 12
    assert "left out 1 primitives of lines" in caplog.text
    # without a scene, all nodes are shown
    del document.document["scenes"]
    assert len(load(document.glb()).triangles) == 24


def test_colours_and_deep_nodes(load):
    document = gltf(CUBE)
    depth = 3000
    document.document["nodes"] = [{"children": [i + 1]} for i in range(depth)] + [{"mesh": 0}]
    assert len(load(document.glb()).triangles) == 12


# compression


@pytest.mark.slow
def test_draco(load):
    draco = pytest.importorskip("DracoPy")
    points, corners = y_up(TETRAHEDRON.points).astype(np.float32), TETRAHEDRON.triangles
    data = draco.encode(points, corners.astype(np.uint32), quantization_bits=16)
    (identifier,) = (item["unique_id"] for item in draco.decode(data).attributes)
    document = Gltf()
    packed = {"bufferView": document.view(data), "attributes": {"POSITION": identifier}}
    position = document.accessor(points, document.view(b""))
    document.primitive(position, extensions={"KHR_draco_mesh_compression": packed})
    document.document["extensionsRequired"] = ["KHR_draco_mesh_compression"]
    mesh = load(document.glb())
    found = mesh.vertices[mesh.triangles]
    expected = TETRAHEDRON.points[corners]
    # triangles may come in another order, and begin at another corner
    np.testing.assert_allclose(
        np.sort(found.sum(axis=1), axis=0), np.sort(expected.sum(axis=1), axis=0), atol=1e-3
    )
    a, b, c = np.moveaxis(found, 1, 0)
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(10, rel=1e-4)
    document.buffer = document.buffer[:20] + bytes(len(document.buffer) - 20)
    with pytest.raises(FileError, match="its Draco data cannot be decoded"):
        load(document.glb())


@pytest.mark.slow
def test_without_dracopy_one_line_says_what_to_install(tmp_path, monkeypatch, load):
    (tmp_path / "DracoPy.py").write_text("raise ImportError")
    monkeypatch.syspath_prepend(tmp_path)
    document = Gltf()
    packed = {"bufferView": document.view(b"DRACO"), "attributes": {"POSITION": 0}}
    document.primitive(0, extensions={"KHR_draco_mesh_compression": packed})
    with pytest.raises(MissingExtraError, match=r"install 'terrain_lod\[compress\]'"):
        load(document.glb())


# what cannot be believed


def without_a_view(document: Gltf) -> None:
    for accessor in document.document["accessors"]:
        del accessor["bufferView"]


def spoiled(*path, value):
    """Return a change of the document: what stands at a path of keys is another value."""

    def change(document: Gltf) -> None:
        *keys, last = path
        place = document.document
        for key in keys:
            place = place[key]
        place[last] = value

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (without_a_view, "its accessor 0 has no data"),
        (spoiled("accessors", 0, "count", value=10**12), "rows of 12 bytes from 0 on, of 96"),
        (spoiled("accessors", 0, "count", value=-1), "a number as its count, got -1"),
        (spoiled("accessors", 0, "count", value=8.0), "a number as its count, got 8.0"),
        (spoiled("accessors", 0, "byteOffset", value=4), "of 96 bytes"),
        (spoiled("accessors", 0, "bufferView", value=-1), "there is no -1 among its 2 bufferViews"),
        (spoiled("accessors", 0, "bufferView", value=True), "there is no True among its 2"),
        (spoiled("accessors", 0, "type", value="MAT4"), "'MAT4'"),
        (spoiled("accessors", 0, "componentType", value=7), "7"),
        (spoiled("bufferViews", 0, "byteLength", value=10**9), "a view of 1000000000 bytes"),
        (spoiled("bufferViews", 0, "buffer", value=3), "there is no 3 among its 1 buffers"),
        (spoiled("nodes", 0, "children", value=[0]), "its node 0 hangs in two places"),
        (spoiled("nodes", 0, "matrix", value=[1, 2]), "cannot reshape"),
        (spoiled("nodes", 0, "rotation", value="north"), "could not convert"),
        (spoiled("nodes", 0, "mesh", value=1), "there is no 1 among its 1 meshes"),
        (spoiled("scene", value=7), "there is no 7 among its 1 scenes"),
        (spoiled("meshes", 0, "primitives", 0, "mode", value=9), "unknown mode 9 of a primitive"),
        (spoiled("meshes", 0, "primitives", 0, "attributes", value={}), "has no positions"),
        (spoiled("meshes", value=7), "its JSON is not that of a glTF"),
        (spoiled("asset", value=[]), "its JSON is not that of a glTF"),
        (spoiled("extensionsRequired", value=["EXT_new_shape"]), "without the extension EXT_new"),
    ],
)
def test_a_document_that_lies_is_refused_in_one_line(load, change, message):
    with pytest.raises(FileError, match=f"^cannot read .*{message}") as caught:
        load(gltf(CUBE, change=change).glb())
    assert "\n" not in str(caught.value)


def test_numbers_out_of_range_are_refused(load):
    with pytest.raises(InputError, match="finite positions"):
        load(gltf(CUBE, change=spoiled("nodes", 0, "scale", value=[1e999] * 3)).glb())
    with pytest.raises(InputError, match="that 32 bits can hold"):
        load(gltf(CUBE, change=spoiled("nodes", 0, "scale", value=[1e39] * 3)).glb())
    document = gltf(CUBE)
    indices = document.accessor(np.array([0, 1, 8], "<u2"))
    document.document["meshes"][0]["primitives"][0]["indices"] = indices
    with pytest.raises(InputError, match="among its 8 vertices, got corner 8"):
        load(document.glb())


@pytest.mark.parametrize("text", [b"", b"{", b"[]", b"7", b"[" * 100_000, b"\xff\xfe", b"{}"])
def test_what_is_no_document_is_refused_in_one_line(load, text):
    with pytest.raises((FileError, InputError), match="cannot read") as caught:
        load(text, ".gltf")
    assert "\n" not in str(caught.value)


def test_our_own_files_say_their_origin_and_lies_in_it_are_found(load, tmp_path):
    document = gltf(CUBE)
    document.document["asset"]["generator"] = "terrain_lod"
    document.document["nodes"][0]["extras"] = {"origin": [1.5, 2.5, 1e999], "crs": "EPSG:32633"}
    with pytest.raises(InputError, match="expected a finite origin"):
        load(document.glb())
    document.document["nodes"][0]["extras"]["origin"] = [1.5, 2.5, 3.5]
    mesh = load(document.glb())
    assert (mesh.origin.tolist(), mesh.crs) == ([1.5, 2.5, 3.5], "EPSG:32633")
    # as they are: z-up already
    np.testing.assert_array_equal(mesh.vertices, y_up(CUBE.points))


def test_only_draco_needs_a_child(tmp_path, monkeypatch):
    monkeypatch.setattr(readers, "read_in_child", lambda path: pytest.fail("a child"))
    path = tmp_path / "plain.gltf"
    path.write_bytes(gltf(CUBE).json())
    assert json.loads(path.read_bytes())["asset"] == {"version": "2.0"}
    load_mesh(path)
