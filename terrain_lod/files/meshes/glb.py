"""Binary glTF 2.0, written: one node, one mesh, one buffer; read by ``gltf.py``.

::

    header      "glTF", 2, bytes in all
    JSON chunk  node (rotation, translation, extras) -> mesh -> accessors -> views of the buffer
    BIN chunk   positions (V, 3) float32 | normals (V, 3) float32 | corners (T, 3) uint32
                | texture coordinates (V, 2) float32, where there are any | a JPEG, likewise

glTF is y-up: its viewers want x right, y up, z towards the eye. The vertices stay as they are, z up
and relative to the mesh's origin; the node turns them by -90 degrees about x and carries the
origin, turned alike: world (x, y, z) stands at (x, z, -y). Its ``extras`` say the exact origin, the
axes and the CRS. Texture coordinates have v down there, and up here.

Khronos Group: *glTF 2.0 Specification*, 2021; section 4.4 for the container.
"""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ...errors import InputError
from ...mesh.mesh import Mesh

# what our files say that they were written by
GENERATOR: Final = "terrain_lod"
_MAGIC: Final = b"glTF"
_HEADER: Final = struct.Struct("<4sII")
_CHUNK: Final = struct.Struct("<I4s")
_LARGEST: Final = 2**32 - 1

# numbers of the specification
_FLOAT, _UNSIGNED_INT = 5126, 5125
_VERTEX_DATA, _INDEX_DATA, _CLAMPED = 34962, 34963, 33071
# -90 degrees about x, as a quaternion x, y, z, w
_Z_UP_TO_Y_UP: Final = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]


def write_glb(mesh: Mesh, path: Path, picture: bytes | None = None) -> None:
    """Write a mesh with at least one triangle, and the JPEG that lies over it.

    Raises
    ------
    InputError
        If the file would be larger than the 4 GiB that the format can say.
    """
    views = [
        np.ascontiguousarray(mesh.vertices, "<f4"),
        np.ascontiguousarray(_unit(mesh.normals), "<f4"),
        np.ascontiguousarray(mesh.triangles, "<u4"),
    ]
    if mesh.textures is not None:
        views.append(np.ascontiguousarray(textures_upside_down(mesh.textures), "<f4"))
    if picture is not None:
        views.append(np.frombuffer(picture + b"\0" * (-len(picture) % 4), np.uint8))
    text = json.dumps(
        _document(mesh, views, picture), separators=(",", ":"), allow_nan=False
    ).encode()
    text += b" " * (-len(text) % 4)
    size = sum(view.nbytes for view in views)
    total = _HEADER.size + 2 * _CHUNK.size + len(text) + size
    if total > _LARGEST:
        raise InputError(
            f"expected a mesh of at most 4 GiB for a .glb, got {total} bytes: save it as .ply"
        )
    with path.open("wb") as file:
        file.write(_HEADER.pack(_MAGIC, 2, total))
        file.write(_CHUNK.pack(len(text), b"JSON") + text)
        # every view is a multiple of 4 bytes long, so all begin aligned
        file.write(_CHUNK.pack(size, b"BIN\0"))
        for view in views:
            file.write(view.data)


def textures_upside_down(textures: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """Return texture coordinates with v counted from the other end."""
    u, v = textures.T
    return np.stack([u, 1 - v], axis=1)


def _unit(normals: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """Return normals that the format allows: unit length, upright where there is none."""
    squares = np.einsum("ij,ij->i", normals, normals, dtype=np.float64)
    if (abs(squares - 1) < 1e-3).all():
        return normals
    usable = np.isfinite(squares) & (squares > 0)
    unit = np.zeros(normals.shape, np.float32)
    unit[:, 2] = 1.0
    unit[usable] = normals[usable] / np.sqrt(squares[usable])[:, None]
    return unit


def _document(mesh: Mesh, views: list[npt.NDArray[Any]], picture: bytes | None) -> dict[str, Any]:
    """Return the JSON chunk's content."""
    x, y, z = (float(value) for value in mesh.origin)
    extras = {"origin": [x, y, z], "axes": "vertices: x east, y north, z up, relative to origin"}
    if mesh.crs:
        extras["crs"] = mesh.crs
    node = {
        "name": "terrain",
        "mesh": 0,
        "rotation": _Z_UP_TO_Y_UP,
        "translation": [x, z, 0.0 - y],
        "extras": extras,
    }
    attributes = {"POSITION": 0, "NORMAL": 1}
    if mesh.textures is not None:
        attributes["TEXCOORD_0"] = 3
    primitive = {"attributes": attributes, "indices": 2, "material": 0}
    matt: dict[str, Any] = {
        "baseColorFactor": [0.8, 0.8, 0.8, 1.0],
        "metallicFactor": 0.0,
        "roughnessFactor": 1.0,
    }
    shown: dict[str, Any] = {}
    if picture is not None:
        matt |= {"baseColorFactor": [1.0, 1.0, 1.0, 1.0], "baseColorTexture": {"index": 0}}
        shown = {
            "images": [{"bufferView": len(views) - 1, "mimeType": "image/jpeg"}],
            "samplers": [{"wrapS": _CLAMPED, "wrapT": _CLAMPED}],
            "textures": [{"source": 0, "sampler": 0}],
        }
    return {
        "asset": {"version": "2.0", "generator": GENERATOR},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [node],
        "meshes": [{"name": "terrain", "primitives": [primitive]}],
        "materials": [{"name": "matt", "pbrMetallicRoughness": matt}],
        **shown,
        "accessors": _accessors(*views[: len(views) - (picture is not None)]),
        "bufferViews": _buffer_views(views, picture),
        "buffers": [{"byteLength": sum(view.nbytes for view in views)}],
    }


def _accessors(
    positions: npt.NDArray[Any],
    normals: npt.NDArray[Any],
    corners: npt.NDArray[Any],
    *textures: npt.NDArray[Any],
) -> list[dict[str, Any]]:
    bounds = {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
    vectors = {"componentType": _FLOAT, "type": "VEC3"}
    return [
        {"bufferView": 0, "count": len(positions), **vectors, **bounds},
        {"bufferView": 1, "count": len(normals), **vectors},
        {
            "bufferView": 2,
            "count": corners.size,
            "componentType": _UNSIGNED_INT,
            "type": "SCALAR",
        },
        *(
            {"bufferView": 3, "count": len(pairs), "componentType": _FLOAT, "type": "VEC2"}
            for pairs in textures
        ),
    ]


def _buffer_views(views: list[npt.NDArray[Any]], picture: bytes | None) -> list[dict[str, int]]:
    targets = (_VERTEX_DATA, _VERTEX_DATA, _INDEX_DATA, _VERTEX_DATA, _VERTEX_DATA)
    offsets = np.cumsum([0, *(view.nbytes for view in views)]).tolist()
    described = [
        {"buffer": 0, "byteOffset": offset, "byteLength": view.nbytes, "target": target}
        for view, offset, target in zip(views, offsets, targets, strict=False)
    ]
    if picture is not None:  # no vertices
        described[-1].pop("target")
        described[-1]["byteLength"] = len(picture)
    return described
