"""glTF 2.0, read: the triangles of a scene, each node where it stands.

The world of a glTF is y-up; what is read is turned z-up. A file of :func:`.glb.write_glb` says its
exact origin, and that its vertices are z-up already: they are taken as they are.

Khronos Group: *glTF 2.0 Specification*, 2021; *KHR_draco_mesh_compression*, 2018.
"""

from __future__ import annotations

import json
import struct
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from .accessors import Arrays, pick
from .draco import DRACO, draco_primitive
from .glb import GENERATOR, textures_upside_down
from .raw import Integers, RawMesh, of_triangles, require_corners, strips_to_triangles

Matrix = npt.NDArray[np.float64]

# numbers of the specification
_TRIANGLES, _STRIP, _FAN = 4, 5, 6
_LINE_MODES: Final = {0: "points", 1: "lines", 2: "lines", 3: "lines"}
_CHUNK: Final = struct.Struct("<I4s")
_Y_UP_TO_Z_UP: Final = np.array([(1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)], float)
_ATTRIBUTES: Final = ("POSITION", "NORMAL", "TEXCOORD_0")
# what a file may demand that changes no triangle, or is understood here
_HARMLESS: Final = ("texture", "materials", "lights", "quantization", "meshopt", DRACO)
_MOST_VERTICES: Final = 2**31 - 1


def read_gltf(path: Path) -> RawMesh:
    """Return the triangles of a .gltf or .glb; pictures and materials are not looked at.

    Raises
    ------
    ValueError
        If it is damaged, or demands an extension that changes triangles and is not known here.
    MissingExtraError
        If it is compressed with Draco, and there is no DracoPy here.
    """
    try:
        document, binary = _parts(path)
        with np.errstate(all="ignore"):  # what is not finite is refused later
            return _Scene(document, Arrays(document, binary, path.parent)).triangles()
    except (LookupError, TypeError, AttributeError, ArithmeticError, RecursionError) as error:
        # the document is of other types than the specification's
        raise ValueError(f"its JSON is not that of a glTF: {error}") from None


def _parts(path: Path) -> tuple[dict[str, Any], bytes]:
    """Return a file's JSON, and its binary chunk."""
    content = path.read_bytes()
    if content[:4] != b"glTF":
        if path.suffix.lower() == ".glb":
            raise ValueError("it is no binary glTF")
        return json.loads(content), b""
    version, total = struct.unpack_from("<II", content.ljust(12, b"\0"), 4)
    if version != 2 or len(content) < total:
        raise ValueError(
            f"expected binary glTF 2 of {total} bytes, got version {version} and "
            f"{len(content)} bytes: is it truncated?"
        )
    chunks, position = dict[bytes, bytes](), 12
    while position + _CHUNK.size <= total:
        length, kind = _CHUNK.unpack_from(content, position)
        position += _CHUNK.size
        chunks.setdefault(kind, content[position : position + length])
        position += length
    if b"JSON" not in chunks:
        raise ValueError("it has no JSON chunk")
    return json.loads(chunks[b"JSON"]), chunks.get(b"BIN\0", b"")


class _Scene:
    """The triangles of a document's scene, gathered primitive by primitive."""

    def __init__(self, document: dict[str, Any], arrays: Arrays) -> None:
        for name in document.get("extensionsRequired", []):
            if not any(word in name for word in _HARMLESS):
                raise ValueError(f"it cannot be read without the extension {name[:80]}")
        self._document = document
        self._arrays = arrays
        self._dropped = Counter[str]()
        self._vertices: list[list[npt.NDArray[Any] | None]] = []
        self._triangles: list[Integers] = []
        self._count = 0

    def triangles(self) -> RawMesh:
        nodes = [node for node in self._nodes() if "mesh" in node[0]]
        recorded = self._recorded(nodes)
        for node, matrix in nodes:
            self._add(node, np.eye(4) if recorded else matrix)
        if not self._vertices:
            return RawMesh(np.zeros((0, 3)), *of_triangles(np.zeros((0, 3), np.int64)))
        points, normals, textures = (
            None if any(part is None for part in parts) else np.concatenate(parts)
            for parts in zip(*self._vertices, strict=True)
        )
        assert points is not None
        mesh = RawMesh(
            points,
            *of_triangles(np.concatenate(self._triangles)),
            normals,
            None if textures is None else textures_upside_down(textures),
            dropped=self._dropped,
        )
        if recorded:
            mesh.points = mesh.points.astype(np.float32)
            mesh.origin = np.array([float(number) for number in recorded["origin"]])
            mesh.crs = recorded.get("crs")
        return mesh

    def _recorded(self, nodes: list[tuple[dict[str, Any], Matrix]]) -> dict[str, Any]:
        """Return what our own files say of origin and CRS; nothing for another's."""
        if self._document["asset"].get("generator") != GENERATOR or len(nodes) != 1:
            return {}
        extras: dict[str, Any] = nodes[0][0].get("extras", {})
        return extras if len(extras.get("origin", ())) == 3 else {}

    def _nodes(self) -> Iterator[tuple[dict[str, Any], Matrix]]:
        """Yield the nodes of the scene, each with its matrix to a z-up world."""
        document = self._document
        if "scenes" in document:
            roots = pick(document, "scenes", document.get("scene", 0)).get("nodes", [])
        else:
            inner = {child for node in document["nodes"] for child in node.get("children", [])}
            roots = [index for index in range(len(document["nodes"])) if index not in inner]
        rest, seen = [(index, _Y_UP_TO_Z_UP) for index in reversed(roots)], set[int]()
        while rest:
            index, matrix = rest.pop()
            node = pick(document, "nodes", index)
            if index in seen:
                raise ValueError(f"its node {index} hangs in two places")
            seen.add(index)
            matrix = matrix @ _matrix(node)
            rest += [(child, matrix) for child in reversed(node.get("children", []))]
            yield node, matrix

    def _add(self, node: dict[str, Any], matrix: Matrix) -> None:
        """Add the primitives of a node's mesh; those that share their vertices do so here too."""
        shared: dict[tuple[Any, ...], tuple[int, int]] = {}
        for primitive in pick(self._document, "meshes", node["mesh"])["primitives"]:
            mode = primitive.get("mode", _TRIANGLES)
            if mode in _LINE_MODES:
                self._dropped[f"primitives of {_LINE_MODES[mode]}"] += 1
                continue
            packed = primitive.get("extensions", {}).get(DRACO)
            if packed is not None:
                data = self._arrays.view(packed["bufferView"])
                found, corners = draco_primitive(data, packed["attributes"], _ATTRIBUTES)
                start, _ = self._append(found, matrix)
            else:
                names = tuple(primitive["attributes"].get(name) for name in _ATTRIBUTES)
                if names not in shared:
                    shared[names] = self._append(self._attributes(names), matrix)
                start, count = shared[names]
                corners = self._corners(primitive, count)
            triangles = _triangles_of(corners, mode)
            if np.linalg.det(matrix[:3, :3]) < 0:  # mirrored: section 3.7.4
                triangles = triangles[:, ::-1]
            self._triangles.append(triangles + start)

    def _attributes(self, names: tuple[Any, ...]) -> list[npt.NDArray[Any] | None]:
        return [None if index is None else self._arrays.accessor(index) for index in names]

    def _corners(self, primitive: dict[str, Any], count: int) -> Integers:
        """Return the corners of a primitive of `count` vertices."""
        if "indices" not in primitive:
            return np.arange(count)
        corners = self._arrays.accessor(primitive["indices"]).ravel().astype(np.int64)
        require_corners(corners, np.ones(len(corners), np.int64), count)
        return corners

    def _append(self, found: list[npt.NDArray[Any] | None], matrix: Matrix) -> tuple[int, int]:
        """Append vertices where they stand; return the number of the first, and how many."""
        points, normals, textures = found
        if points is None or points.shape[1] != 3:
            raise ValueError("a primitive has no positions")
        start = self._count
        self._count += len(points)
        if self._count > _MOST_VERTICES:
            raise ValueError(f"expected at most {_MOST_VERTICES} vertices, got {self._count}")
        linear = matrix[:3, :3]
        placed = points.astype(np.float64) @ linear.T + matrix[:3, 3]
        turned = None
        if normals is not None and normals.shape == points.shape:
            turned = _turned(normals.astype(np.float64), linear)
        if textures is not None and textures.shape != (len(points), 2):
            textures = None
        self._vertices.append([placed, turned, textures])
        return start, len(points)


def _matrix(node: dict[str, Any]) -> Matrix:
    """Return a node's matrix, (4, 4): section 3.5.3."""
    if "matrix" in node:
        return np.array(node["matrix"], np.float64).reshape(4, 4).T
    x, y, z, w = (float(number) for number in node.get("rotation", (0, 0, 0, 1)))
    result = np.eye(4)
    result[:3, :3] = np.array(
        [
            (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
        ]
    ) * np.array(node.get("scale", (1, 1, 1)), np.float64).reshape(3)
    result[:3, 3] = np.array(node.get("translation", (0, 0, 0)), np.float64).reshape(3)
    return result


def _turned(normals: npt.NDArray[np.float64], linear: Matrix) -> npt.NDArray[np.float64] | None:
    """Return normals of a surface that a matrix has moved, unit length; None where it is flat."""
    # the transpose of the inverse, but for its length
    cofactors = np.cross(np.roll(linear, -1, axis=0), np.roll(linear, -2, axis=0))
    turned = normals @ cofactors.T * np.sign(np.linalg.det(linear))
    lengths = np.linalg.norm(turned, axis=1, keepdims=True)
    own = np.linalg.norm(normals, axis=1, keepdims=True)
    if not np.isfinite(lengths).all() or (lengths == 0).any():
        return None
    # as long as they were: whether they are unit vectors is asked of all formats alike
    result: npt.NDArray[np.float64] = turned * (own / lengths)
    return result


def _triangles_of(corners: Integers, mode: Any) -> Integers:
    """Return the triangles (T, 3) of a primitive."""
    if mode == _TRIANGLES:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    if mode == _STRIP:
        return strips_to_triangles(corners, np.array([len(corners)]))
    if mode != _FAN:
        raise ValueError(f"unknown mode {mode!r} of a primitive")
    tops = np.broadcast_to(corners[:1], max(len(corners) - 2, 0))
    return np.stack([tops, corners[1:-1], corners[2:]], axis=1)
