"""Mesh files written by hand, in every dialect that readers meet: solids, and how to write them."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Solid:
    """Points, and faces of any number of corners, seen from outside counter-clockwise."""

    points: np.ndarray
    faces: Sequence[Sequence[int]]

    @property
    def triangles(self) -> np.ndarray:
        """The faces as fans: right wherever they are convex."""
        return np.array([(f[0], b, c) for f in self.faces for b, c in pairwise(f[1:])])

    @property
    def areas(self) -> np.ndarray:
        """Area of each face, which must be flat."""
        normals = [
            np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)
            for corners in (self.points[list(face)] - self.points[face[0]] for face in self.faces)
        ]
        return np.linalg.norm(normals, axis=1) / 2

    @property
    def volume(self) -> float:
        """Signed volume below flat faces."""
        a, b, c = np.moveaxis(self.points[self.triangles], 1, 0)
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def solid(points, faces) -> Solid:
    return Solid(np.array(points, np.float64), faces)


def prism(outline: Sequence[tuple[float, float]], height: float = 2.0) -> Solid:
    """Return a prism on a counter-clockwise outline."""
    n = len(outline)
    points = [(x, y, z) for z in (0.0, height) for x, y in outline]
    sides = [(i, (i + 1) % n, n + (i + 1) % n, n + i) for i in range(n)]
    return solid(points, [tuple(range(n))[::-1], tuple(range(n, 2 * n)), *sides])


TETRAHEDRON = solid(
    [(0, 0, 0), (3, 0, 0), (0, 4, 0), (0, 0, 5)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
)
CUBE = prism([(0, 0), (1, 0), (1, 1), (0, 1)], 1.0)
INSIDE_OUT = Solid(CUBE.points, [face[::-1] for face in CUBE.faces])
HEXAGON = prism([(np.cos(a), np.sin(a)) for a in np.arange(6) * np.pi / 3])
ELL = prism([(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)])
COMB = prism([(0, 0), (9, 0), *((9 - i, 4 if i % 2 else 1) for i in range(9)), (0, 4)])
# corners in line with their neighbours, on every side
DOTTED = prism([(0, 0), (1, 0), (2, 0), (3, 0), (3, 1), (2, 1), (1, 1), (1, 2), (0, 2), (0, 1)])
# a plate with a square hole, its outline led to the hole and back
KEYHOLE = solid(
    [(0, 0, 0), (4, 0, 0), (4, 4, 0), (0, 4, 0), (1, 1, 0), (1, 3, 0), (3, 3, 0), (3, 1, 0)],
    [(0, 1, 2, 3, 0, 4, 5, 6, 7, 4)],
)
FAR = Solid(TETRAHEDRON.points * 0.125 + (500_123.125, 5_200_345.25, 812.5), TETRAHEDRON.faces)
LARGE = Solid(CUBE.points * 1e6, CUBE.faces)
SMALL = Solid(CUBE.points * 2.0**-20, CUBE.faces)
OPEN = solid([(0, 0, 0), (2, 0, 1), (2, 2, 0), (0, 2, 3)], [(0, 1, 2), (0, 2, 3)])


# text


def obj(shape: Solid, corner: str = "{0}", *, head: str = "", vertex: str = "", end="\n") -> bytes:
    """Return OBJ; `corner` is written with the number of a point, from 1, and from the end, -n."""
    n = len(shape.points)
    lines = [head] if head else []
    lines += ["v " + " ".join(f"{x:.12g}" for x in point) + vertex for point in shape.points]
    lines += ["f " + " ".join(corner.format(i + 1, i - n) for i in face) for face in shape.faces]
    return (end.join(lines) + end).encode()


def with_lines(content: bytes, *lines: str, before: bytes = b"f ") -> bytes:
    """Return text with lines put in before the first that begins so."""
    place = content.index(b"\n" + before) + 1
    return content[:place] + "".join(line + "\n" for line in lines).encode() + content[place:]


def off(shape: Solid, keyword: str = "OFF\n", vertex: str = "", face: str = "") -> bytes:
    rows = [f"{len(shape.points)} {len(shape.faces)} 0"]
    rows += [" ".join(f"{x:.12g}" for x in point) + vertex for point in shape.points]
    rows += [" ".join(map(str, (len(f), *f))) + face for f in shape.faces]
    return (keyword + "\n".join(rows) + "\n").encode()


def ascii_stl(shape: Solid, name: str = "drawn") -> bytes:
    facets = [
        "facet normal 0 0 0\n outer loop\n"
        + "".join("  vertex " + " ".join(f"{x:.12g}" for x in p) + "\n" for p in corners)
        + " endloop\nendfacet\n"
        for corners in shape.points[shape.triangles]
    ]
    return f"solid {name}\n{''.join(facets)}endsolid {name}\n".encode()


def binary_stl(shape: Solid, header: bytes = b"drawn") -> bytes:
    corners = shape.points[shape.triangles].astype("<f4")
    facets = b"".join(bytes(12) + facet.tobytes() + b"\0\0" for facet in corners)
    return header.ljust(80, b"\0") + struct.pack("<I", len(corners)) + facets


# PLY

_NUMPY = {"float": "f4", "double": "f8", "int": "i4", "short": "i2", "uchar": "u1", "uint": "u4"}


def ply(
    shape: Solid,
    form: str = "binary_little_endian",
    coordinate: str = "float",
    count: str = "uchar",
    index: str = "int",
    *,
    extra: bool = False,
    row_end: str = "",
) -> bytes:
    """Return PLY; `extra` puts a column before and behind the faces' corners and the points."""
    order = ">" if form.endswith("big_endian") else "<"
    header = ["ply", f"format {form} 1.0", "comment drawn", f"element vertex {len(shape.points)}"]
    header += ["property uchar quality"] * extra
    header += [f"property {coordinate} {axis}" for axis in "xyz"]
    header += [f"element face {len(shape.faces)}", *["property int flags"] * extra]
    header += [f"property list {count} {index} vertex_indices", *["property float area"] * extra]
    body = b""
    if form == "ascii":
        rows = [
            " ".join(["7"] * extra + [f"{x:.12g}" for x in point]) + row_end
            for point in shape.points
        ]
        rows += [
            " ".join(["-1"] * extra + [str(n) for n in (len(f), *f)] + ["0.5"] * extra) + row_end
            for f in shape.faces
        ]
        body = ("\n".join(rows) + "\n").encode()
    else:
        for point in shape.points:
            body += b"\7" * extra + point.astype(order + _NUMPY[coordinate]).tobytes()
        for face in shape.faces:
            body += np.array([-1] * extra, order + "i4").tobytes()
            body += np.array(len(face), order + _NUMPY[count]).tobytes()
            body += np.array(face, order + _NUMPY[index]).tobytes()
            body += np.array([0.5] * extra, order + "f4").tobytes()
    return ("\n".join([*header, "end_header"]) + "\n").encode() + body


def ply_strips(shape: Solid, strips: Sequence[int]) -> bytes:
    """Return PLY of the points of a solid and triangle strips, -1 between them."""
    header = ["ply", "format binary_big_endian 1.0", f"element vertex {len(shape.points)}"]
    header += [f"property float {axis}" for axis in "xyz"]
    header += ["element tristrips 1", "property list int int vertex_indices", "end_header"]
    body = shape.points.astype(">f4").tobytes() + np.array([len(strips), *strips], ">i4").tobytes()
    return ("\n".join(header) + "\n").encode() + body


# glTF


@dataclass
class Gltf:
    """A document that grows: views of one buffer, accessors of views."""

    document: dict[str, Any] = field(
        default_factory=lambda: {
            "asset": {"version": "2.0"},
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": []}],
            "accessors": [],
            "bufferViews": [],
        }
    )
    buffer: bytes = b""

    def view(self, data: bytes, **more: Any) -> int:
        self.buffer += bytes(-len(self.buffer) % 4)
        view = {"buffer": 0, "byteOffset": len(self.buffer), "byteLength": len(data), **more}
        self.buffer += data
        self.document["bufferViews"].append(view)
        return len(self.document["bufferViews"]) - 1

    def accessor(self, values: np.ndarray, view: int | None = None, **more: Any) -> int:
        """Return the number of an accessor of an array (n, width), in a view of its own."""
        kinds = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
        accessor = {
            "componentType": kinds[values.dtype.str[1:]],
            "count": len(values),
            "type": "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}",
            "bufferView": self.view(values.tobytes()) if view is None else view,
            **more,
        }
        self.document["accessors"].append(accessor)
        return len(self.document["accessors"]) - 1

    def primitive(self, position: int, indices: int | None = None, **more: Any) -> None:
        primitive = {"attributes": {"POSITION": position}, **more}
        if indices is not None:
            primitive["indices"] = indices
        self.document["meshes"][0]["primitives"].append(primitive)

    def json(self, uri: str | None = None) -> bytes:
        """Return a .gltf, its buffer in a file of its own or in the text."""
        data = "data:application/octet-stream;base64," + base64.b64encode(self.buffer).decode()
        buffers = [{"byteLength": len(self.buffer), "uri": uri or data}]
        return json.dumps({**self.document, "buffers": buffers}).encode()

    def glb(self) -> bytes:
        buffer = self.buffer + bytes(-len(self.buffer) % 4)
        document = {**self.document, "buffers": [{"byteLength": len(buffer)}]}
        text = json.dumps(document).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(buffer), b"BIN\0") + buffer
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def y_up(points: np.ndarray) -> np.ndarray:
    """Return points of a z-up world as a glTF has them."""
    return np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)


def gltf(shape: Solid, index: str = "<u2", change: Callable[[Gltf], None] | None = None) -> Gltf:
    """Return a document of one primitive of a solid's triangles."""
    made = Gltf()
    position = made.accessor(y_up(shape.points).astype("<f4"))
    made.primitive(position, made.accessor(shape.triangles.ravel().astype(index)))
    if change is not None:
        change(made)
    return made
