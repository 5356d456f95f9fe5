"""Binary glTF 2.0, written: one node, one mesh, one buffer; read by ``gltf.py``.

::

    header      "glTF", 2, bytes in all
    JSON chunk  node (rotation, translation, extras) -> mesh -> accessors -> views of the buffer
    BIN chunk   positions (V, 3) float32 | normals (V, 3) float32 | corners (T, 3) uint32
                | texture coordinates (V, 2) float32, where there are any
                | with a normal map, tangents (V, 4) float32 | its PNG
                | the JPEG that lies over the mesh, where there is one

glTF is y-up: its viewers want x right, y up, z towards the eye. The vertices stay as they are, z up
and relative to the mesh's origin; the node turns them by -90 degrees about x and carries the
origin, turned alike: world (x, y, z) stands at (x, z, -y). Its ``extras`` say the exact origin, the
axes and the CRS. Texture coordinates have v down there, and up here.

Khronos Group: *glTF 2.0 Specification*, 2021; section 4.4 for the container.
"""

from __future__ import annotations

import json
import struct
from io import BytesIO
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from PIL import Image

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
_VERTEX_DATA, _INDEX_DATA = 34962, 34963
_LINEAR, _CLAMPED = 9729, 33071
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
    pictures: dict[str, npt.NDArray[np.uint8]] = {}
    if mesh.normal_map is not None:
        views.append(np.ascontiguousarray(mesh.normal_map.tangents, "<f4"))
        pictures["image/png"] = _png(mesh.normal_map.pixels)
    if picture is not None:
        pictures["image/jpeg"] = np.frombuffer(picture, np.uint8)
    document = _document(mesh, views, pictures)
    views += [np.pad(each, (0, -len(each) % 4)) for each in pictures.values()]
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
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


def _png(pixels: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """Return a PNG's bytes."""
    file = BytesIO()
    Image.fromarray(pixels).save(file, format="png")
    return np.frombuffer(file.getvalue(), np.uint8)


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


def _document(
    mesh: Mesh, views: list[npt.NDArray[Any]], pictures: dict[str, npt.NDArray[np.uint8]]
) -> dict[str, Any]:
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
    material: dict[str, Any] = {"name": "matt", "pbrMetallicRoughness": matt}
    if mesh.normal_map is not None:
        attributes["TANGENT"] = 4
        material["normalTexture"] = {"index": 0}
    if "image/jpeg" in pictures:
        over = {"index": len(pictures) - 1}
        matt |= {"baseColorFactor": [1.0, 1.0, 1.0, 1.0], "baseColorTexture": over}
    shown: dict[str, Any] = {}
    if pictures:
        shown = {
            "images": [
                {"bufferView": len(views) + index, "mimeType": kind}
                for index, kind in enumerate(pictures)
            ],
            "samplers": [{"magFilter": _LINEAR, "wrapS": _CLAMPED, "wrapT": _CLAMPED}],
            "textures": [{"source": index, "sampler": 0} for index in range(len(pictures))],
        }
    stored = [*views, *pictures.values()]
    return {
        "asset": {"version": "2.0", "generator": GENERATOR},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [node],
        "meshes": [{"name": "terrain", "primitives": [primitive]}],
        "materials": [material],
        **shown,
        "accessors": _accessors(*views),
        "bufferViews": _buffer_views(views, list(pictures.values())),
        "buffers": [{"byteLength": sum(-(-each.nbytes // 4) * 4 for each in stored)}],
    }


def _accessors(
    positions: npt.NDArray[Any],
    normals: npt.NDArray[Any],
    corners: npt.NDArray[Any],
    *more: npt.NDArray[Any],
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
            {"bufferView": view, "count": len(rows), "componentType": _FLOAT, "type": kind}
            for view, rows, kind in zip((3, 4), more, ("VEC2", "VEC4"), strict=False)
        ),
    ]


def _buffer_views(
    views: list[npt.NDArray[Any]], pictures: list[npt.NDArray[np.uint8]]
) -> list[dict[str, int]]:
    targets = (_VERTEX_DATA, _VERTEX_DATA, _INDEX_DATA, _VERTEX_DATA, _VERTEX_DATA)
    described, offset = [], 0
    for view, target in zip(views, targets, strict=False):
        place = {"buffer": 0, "byteOffset": offset, "byteLength": view.nbytes}
        described.append({**place, "target": target})
        offset += view.nbytes
    for picture in pictures:  # no vertices
        described.append({"buffer": 0, "byteOffset": offset, "byteLength": picture.nbytes})
        offset += picture.nbytes + -picture.nbytes % 4
    return described
