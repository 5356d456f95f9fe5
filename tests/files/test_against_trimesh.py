"""Odd mesh files: as many triangles, as much area and volume as trimesh finds, or as is right."""

from __future__ import annotations

from codecs import BOM_UTF8

import numpy as np
import pytest

from support.mesh_files import (
    COMB,
    CUBE,
    DOTTED,
    ELL,
    FAR,
    HEXAGON,
    INSIDE_OUT,
    KEYHOLE,
    LARGE,
    OPEN,
    SMALL,
    TETRAHEDRON,
    Gltf,
    Solid,
    ascii_stl,
    binary_stl,
    gltf,
    obj,
    off,
    ply,
    ply_strips,
    with_lines,
    y_up,
)
from terrain_lod.files.meshes.loading import load_mesh

trimesh = pytest.importorskip("trimesh")


def turned(document: Gltf, **node) -> bytes:
    document.document["nodes"][0] |= node
    return document.glb()


def textured(document: Gltf) -> None:
    """Name a picture that is not there."""
    document.document |= {
        "images": [{"uri": "missing.png"}],
        "textures": [{"source": 0}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    }
    document.document["meshes"][0]["primitives"][0]["material"] = 0


def strip(shape: Solid, corners: list[int], mode: int) -> bytes:
    document = Gltf()
    position = document.accessor(y_up(shape.points).astype("<f4"))
    document.primitive(position, document.accessor(np.array(corners, "<u1")), mode=mode)
    return document.glb()


def soup(shape: Solid) -> bytes:
    """Return a .glb without indices."""
    document = Gltf()
    corners = y_up(shape.points[shape.triangles].reshape(-1, 3)).astype("<f4")
    document.primitive(document.accessor(corners))
    return document.glb()


def sparse(shape: Solid) -> bytes:
    """Return a .glb whose positions are all wrong but for what a sparse accessor replaces."""
    document = Gltf()
    points = y_up(shape.points).astype("<f4")
    indices = document.view(np.arange(len(points), dtype="<u2").tobytes())
    values = document.view(points.tobytes())
    position = document.accessor(
        np.full_like(points, 9.0),
        sparse={
            "count": len(points),
            "indices": {"bufferView": indices, "componentType": 5123},
            "values": {"bufferView": values},
        },
    )
    document.primitive(position, document.accessor(shape.triangles.ravel().astype("<u1")))
    return document.glb()


def sparse_alone(shape: Solid) -> bytes:
    """Return a .glb whose positions have no view of their own: zero, and then replaced."""
    document = Gltf()
    points = y_up(shape.points).astype("<f4")
    indices = document.view(np.arange(len(points), dtype="<u2").tobytes())
    entries = {
        "count": len(points),
        "indices": {"bufferView": indices, "componentType": 5123},
        "values": {"bufferView": document.view(points.tobytes())},
    }
    position = document.accessor(points, sparse=entries)
    del document.document["accessors"][position]["bufferView"]
    document.primitive(position, document.accessor(shape.triangles.ravel().astype("<u1")))
    return document.glb()


def strided(shape: Solid) -> bytes:
    """Return a .glb of positions and normals by turns."""
    document = Gltf()
    points = y_up(shape.points).astype("<f4")
    up = np.tile(np.float32([0, 1, 0]), (len(points), 1))
    view = document.view(np.concatenate([points, up], axis=1).tobytes(), byteStride=24)
    attributes = {
        "POSITION": document.accessor(points, view),
        "NORMAL": document.accessor(up, view, byteOffset=12),
    }
    indices = document.accessor(shape.triangles.ravel().astype("<u1"))
    document.primitive(0, indices, attributes=attributes)
    return document.glb()


def other_modes(document: Gltf) -> None:
    """Add points and lines."""
    document.primitive(0, mode=0)
    document.primitive(0, document.accessor(np.array([0, 1, 1, 2], "<u2")), mode=1)


def target(document: Gltf) -> None:
    """Add a shape to blend with, of no weight."""
    by = document.accessor(np.ones((document.document["accessors"][0]["count"], 3), "<f4"))
    document.document["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": by}]


def faces_first(shape: Solid) -> bytes:
    return b"\n".join(sorted(obj(shape).splitlines(), key=lambda line: line[:1]))


def points_between(shape: Solid) -> bytes:
    """Return OBJ whose faces each stand behind their own points, counted from the last."""
    lines = []
    for face in shape.faces:
        lines += ["v " + " ".join(f"{x:.12g}" for x in shape.points[i]) for i in face]
        lines.append("f " + " ".join(str(i) for i in range(-len(face), 0)))
    return "\n".join(lines).encode()


def lists_before(shape: Solid) -> bytes:
    """Return PLY with lists before the corners, and rows of others between and behind."""
    header = [
        *("ply", "format binary_big_endian 1.0", "obj_info by hand"),
        *(f"element vertex {len(shape.points)}", *(f"property float64 {axis}" for axis in "xyz")),
        *("element material 1", "property list uint8 int8 name"),
        *(f"element face {len(shape.faces)}", "property list uint8 float32 texcoord"),
        "property list uint8 uint32 vertex_index",
        *("element edge 1", "property int vertex1", "property int vertex2", "end_header"),
    ]
    body = shape.points.astype(">f8").tobytes() + b"\3abc"
    for face in shape.faces:
        body += bytes([2 * len(face)]) + bytes(8 * len(face))
        body += bytes([len(face)]) + np.array(face, ">u4").tobytes()
    return ("\n".join(header) + "\n").encode() + body + np.array([0, 1], ">i4").tobytes()


def faces_before_points(shape: Solid) -> bytes:
    header = ["ply", "format ascii 1.0", f"element face {len(shape.faces)}",
              "property list uchar int vertex_indices", f"element vertex {len(shape.points)}",
              *(f"property double {axis}" for axis in "xyz"), "end_header"]  # fmt: skip
    rows = [" ".join(map(str, (len(face), *face))) for face in shape.faces]
    rows += [" ".join(f"{x:.12g}" for x in point) for point in shape.points]
    return "\n".join([*header, *rows]).encode()


def quantized(shape: Solid) -> bytes:
    """Return a .glb of positions in 16 bits, scaled by its node: shares of the largest."""
    document = Gltf()
    largest = abs(shape.points).max()
    points = np.rint(y_up(shape.points) / largest * 32767).astype("<i2")
    padded = np.concatenate([points, np.zeros((len(points), 1), "<i2")], axis=1)
    view = document.view(padded.tobytes(), byteStride=8)
    position = document.accessor(points, view, normalized=True)
    document.primitive(position, document.accessor(shape.triangles.ravel().astype("<u1")))
    document.document |= {"extensionsRequired": ["KHR_mesh_quantization"]}
    return turned(document, scale=[float(largest)] * 3)


def two_instances(shape: Solid) -> bytes:
    """Return a .glb of a mesh that two nodes show, one below the other's node."""
    document = gltf(shape)
    document.document["nodes"] = [
        {"mesh": 0, "children": [1], "translation": [5, 0, 0]},
        {"mesh": 0, "rotation": [0, 0.6, 0, 0.8], "scale": [1, 1, 1]},
    ]
    return document.glb()


def twice(shape: Solid) -> Solid:
    n = len(shape.points)
    return Solid(
        np.concatenate([shape.points, shape.points + 50]),
        [*shape.faces, *(tuple(i + n for i in face) for face in shape.faces)],
    )


HALF_SLASHES = "{0}//"
TRIANGLED = Solid(CUBE.points, CUBE.triangles.tolist())
FLAT_STRIP = Solid(np.array([(i // 2, i % 2, 0) for i in range(8)], float), [(0, 2, 1), (1, 2, 3),
    (2, 4, 3), (3, 4, 5), (4, 6, 5), (5, 6, 7)])  # fmt: skip

# name of the file, what it holds, and what that is; a name before a dash says why it is odd
CASES: dict[str, tuple[bytes, Solid]] = {
    "plain.obj": (obj(CUBE), CUBE),
    "tetrahedron.obj": (obj(TETRAHEDRON), TETRAHEDRON),
    "hexagons.obj": (obj(HEXAGON), HEXAGON),
    "negative.obj": (obj(CUBE, "{1}"), CUBE),
    "slashes.obj": (obj(CUBE, HALF_SLASHES), CUBE),
    "texture-missing.obj": (obj(CUBE, "{0}/{0}"), CUBE),
    "normal-missing.obj": (obj(CUBE, "{0}//{0}"), CUBE),
    "both-missing.obj": (obj(CUBE, "{0}/{0}/{0}"), CUBE),
    "normals.obj": (with_lines(obj(CUBE, "{0}//1"), "vn 0 0 1"), CUBE),
    "negative-normals.obj": (with_lines(obj(CUBE, "{1}//-1"), "vn 0 0 1"), CUBE),
    "crlf.obj": (obj(CUBE, end="\r\n"), CUBE),
    "tabs.obj": (obj(CUBE).replace(b" ", b"\t"), CUBE),
    "weights.obj": (obj(CUBE, vertex=" 1.0"), CUBE),
    "colours.obj": (obj(CUBE, vertex=" 0.5 0.25 1"), CUBE),
    "material-unnamed.obj": (obj(CUBE, head="mtllib nowhere.mtl\nusemtl\no\ng"), CUBE),
    "comments.obj": (obj(CUBE, head="# f 1 2 9\n\n   # more"), CUBE),
    "broken-lines.obj": (obj(HEXAGON).replace(b"f 1 ", b"f 1 \\\n"), HEXAGON),
    "lines.obj": (obj(CUBE) + b"l 1 2 3\np 1\n", CUBE),
    "smooth.obj": (with_lines(obj(CUBE), "s off", "g a b", "vp 0.5"), CUBE),
    "far.obj": (obj(FAR), FAR),
    "large.obj": (obj(LARGE), LARGE),
    "small.obj": (obj(SMALL), SMALL),
    "inside-out.obj": (obj(INSIDE_OUT), INSIDE_OUT),
    "open.obj": (obj(OPEN), OPEN),
    "two.obj": (obj(twice(CUBE)), twice(CUBE)),
    "ell.obj": (obj(ELL), ELL),
    "comb.obj": (obj(COMB), COMB),
    "dotted.obj": (obj(DOTTED), DOTTED),
    "keyhole.obj": (obj(KEYHOLE), KEYHOLE),
    "faces-first.obj": (faces_first(CUBE), CUBE),
    "points-between.obj": (points_between(CUBE), CUBE),
    "marked.obj": (BOM_UTF8 + obj(CUBE), CUBE),
    "ends-of-old.obj": (obj(CUBE, end="\r"), CUBE),
    "latin.obj": (obj(CUBE, head="o Stra\xdfe").decode().encode("latin-1"), CUBE),
    "blanks-behind.obj": (obj(CUBE).replace(b"\n", b"  \t\n"), CUBE),
    "mixed-slashes.obj": (obj(CUBE).replace(b"f 1 ", b"f 1/1 ").replace(b"f 2 ", b"f 2//2 "),
                          CUBE),
    "surfaces.obj": (with_lines(obj(CUBE), "cstype bezier", "deg 3", "parm u 0 1", "end"), CUBE),
    "plain.off": (off(TETRAHEDRON), TETRAHEDRON),
    "quads.off": (off(CUBE), CUBE),
    "colours.off": (off(CUBE, "COFF\n", " 0.5 0.5 1 1", " 255 0 0"), CUBE),
    "comments.off": (off(CUBE, "OFF # made\n# by\n\n", " # hand"), CUBE),
    "one-line.off": (off(CUBE, "OFF "), CUBE),
    "normals.off": (off(CUBE, "NOFF\n", " 0 0 1"), CUBE),
    "textures.off": (off(CUBE, "STOFF\n", " 0.5 0.5"), CUBE),
    "marked.off": (BOM_UTF8 + off(CUBE), CUBE),
    "no-edges.off": (off(CUBE).replace(b"8 6 0", b"8 6"), CUBE),
    "comb.off": (off(COMB), COMB),
    "far.off": (off(FAR), FAR),
    "little.ply": (ply(CUBE), CUBE),
    "big.ply": (ply(CUBE, "binary_big_endian"), CUBE),
    "text.ply": (ply(CUBE, "ascii"), CUBE),
    "mixed.ply": (ply(HEXAGON), HEXAGON),
    "mixed-big.ply": (ply(HEXAGON, "binary_big_endian", "double", "int", "uint"), HEXAGON),
    "double-far.ply": (ply(FAR, coordinate="double"), FAR),
    "text-far.ply": (ply(FAR, "ascii", "double"), FAR),
    "int.ply": (ply(TETRAHEDRON, coordinate="int"), TETRAHEDRON),
    "int-text.ply": (ply(TETRAHEDRON, "ascii", "int"), TETRAHEDRON),
    "short.ply": (ply(TETRAHEDRON, coordinate="short"), TETRAHEDRON),
    "byte-indices.ply": (ply(CUBE, count="uint", index="uchar"), CUBE),
    "extra.ply": (ply(TRIANGLED, extra=True), CUBE),
    "extra-mixed.ply": (ply(HEXAGON, "binary_big_endian", extra=True), HEXAGON),
    "extra-text.ply": (ply(HEXAGON, "ascii", extra=True), HEXAGON),
    "long-rows.ply": (ply(TRIANGLED, "ascii", row_end=" 9 9"), CUBE),
    "strips.ply": (ply_strips(FLAT_STRIP, [0, 2, 1, 3, -1, 2, 4, 3, 5, -1, 4, 6, 5, 7]),
                   FLAT_STRIP),
    "lists.ply": (lists_before(HEXAGON), HEXAGON),
    "faces-first.ply": (faces_before_points(HEXAGON), HEXAGON),
    "comb.ply": (ply(COMB), COMB),
    "dotted.ply": (ply(DOTTED, "ascii"), DOTTED),
    "binary.stl": (binary_stl(CUBE), CUBE),
    "binary-solid.stl": (binary_stl(CUBE, b"solid as text"), CUBE),
    "facet-in-header.stl": (binary_stl(CUBE, b"solid facet normal 0 0 0"), CUBE),
    "more-behind.stl": (binary_stl(CUBE) + b"more", CUBE),
    "marked.stl": (BOM_UTF8 + ascii_stl(CUBE), CUBE),
    "text.stl": (ascii_stl(CUBE), CUBE),
    "text-far.stl": (ascii_stl(FAR), FAR),
    "text-capitals.stl": (ascii_stl(CUBE).upper().replace(b"SOLID", b"solid"), CUBE),
    "two-solids.stl": (ascii_stl(CUBE) + ascii_stl(Solid(CUBE.points + 50, CUBE.faces)),
                       twice(CUBE)),
    "plain.glb": (gltf(CUBE).glb(), CUBE),
    "plain.gltf": (gltf(CUBE).json(), CUBE),
    "wide.glb": (gltf(TETRAHEDRON, "<u4").glb(), TETRAHEDRON),
    "narrow.glb": (gltf(TETRAHEDRON, "<u1").glb(), TETRAHEDRON),
    "mirrored.glb": (turned(gltf(CUBE), scale=[-1, 1, 1]), CUBE),
    "mirrored-matrix.glb": (
        turned(gltf(CUBE), matrix=[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1]), CUBE),
    "turned.glb": (turned(gltf(CUBE), rotation=[0.6, 0, 0, 0.8], translation=[0, 0, 0]), CUBE),
    "picture-missing.glb": (gltf(CUBE, change=textured).glb(), CUBE),
    "no-indices.glb": (soup(CUBE), CUBE),
    "sparse.glb": (sparse(CUBE), CUBE),
    "sparse-alone.glb": (sparse_alone(CUBE), CUBE),
    "strided.glb": (strided(CUBE), CUBE),
    "other-modes.glb": (gltf(CUBE, change=other_modes).glb(), CUBE),
    "targets.glb": (gltf(CUBE, change=target).glb(), CUBE),
    "quantized.glb": (quantized(CUBE), CUBE),
    "strip.glb": (strip(FLAT_STRIP, [0, 2, 1, 3, 3, 2, 2, 4, 3, 5, 5, 4, 4, 6, 5, 7], 5),
                  FLAT_STRIP),
    "fan.glb": (strip(OPEN, [0, 1, 2, 3], 6), OPEN),
    "instances.glb": (two_instances(CUBE), twice(CUBE)),
}  # fmt: skip

# what trimesh does otherwise
FANS = "concave faces are fans there, and overlap"
UNREAD = "not read there"
UNLIKE_TRIMESH = {
    "tabs.obj": UNREAD,
    "points-between.obj": "points in one place become one there",
    "marked.obj": "the first point is lost there",
    "ends-of-old.obj": UNREAD,
    "marked.off": UNREAD,
    "lists.ply": UNREAD,
    "more-behind.stl": UNREAD,
    "marked.stl": UNREAD,
    "sparse-alone.glb": "sparse accessors are not read there",
    "ell.obj": FANS,
    "comb.obj": FANS,
    "keyhole.obj": FANS,
    "comb.off": UNREAD,
    "comb.ply": UNREAD,
    "mixed.ply": UNREAD,
    "mixed-big.ply": UNREAD,
    "extra-mixed.ply": UNREAD,
    "strips.ply": UNREAD,
    "sparse.glb": "sparse accessors are not read there",
    "quantized.glb": "shares are whole numbers there",
    "strip.glb": "triangles with two equal corners stay there",
    "fan.glb": UNREAD,
}


def measured(points: np.ndarray, triangles: np.ndarray) -> tuple[int, float, float]:
    """Return how many triangles, their area and their signed volume."""
    mesh = trimesh.Trimesh(points, triangles, process=False)
    with np.errstate(invalid="ignore"):  # flat ones have no centre of mass there
        return len(triangles), mesh.area, mesh.volume


def test_there_are_enough_cases() -> None:
    assert len(CASES) - len(UNLIKE_TRIMESH) >= 60
    assert UNLIKE_TRIMESH.keys() <= CASES.keys()


@pytest.mark.parametrize("name", CASES)
def test_triangles_area_and_volume(tmp_path, name: str) -> None:
    content, shape = CASES[name]
    path = tmp_path / name
    path.write_bytes(content)
    mesh = load_mesh(path)
    # about the middle, where trimesh's sums lose nothing, far from zero or not
    middle = shape.points.mean(axis=0)
    right = Solid(shape.points - middle, shape.faces)
    ours = measured(mesh.vertices + mesh.origin - middle, mesh.triangles)
    # positions are float32, and so are those of some files: 0.03 m where they are far from zero
    about = {"rel": 1e-5, "abs": 1e-12 * abs(right.points).max()}
    assert ours == pytest.approx((len(right.triangles), right.areas.sum(), right.volume), **about)
    if name in UNLIKE_TRIMESH:
        return
    theirs = trimesh.load(path, process=False, force="mesh")
    points = theirs.vertices
    if path.suffix in (".glb", ".gltf"):
        points = np.stack([points[:, 0], -points[:, 2], points[:, 1]], axis=1)
    assert ours == pytest.approx(measured(points - middle, theirs.faces), **about)
