"""Content of 3D Tiles: binary glTF whose vertices are earth-centred.

Clients turn glTF, which is y-up, into their z-up world: what stands at (x, y, z) here is written as
(x, z, -y). The node carries the tile's centre in float64, vertices are float32 around it. Both are
whole multiples of one step, a power of two that float32 holds for tiles of this size: so vertices
that two tiles share add up to the same bits.
"""

from __future__ import annotations

import json
import math
import struct
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from .ellipsoid import AXIS, Floats
from .mend import TileMesh

_MAGIC: Final = b"glTF"
_FLOAT, _UNSIGNED_SHORT, _UNSIGNED_INT = 5126, 5123, 5125
_VERTEX_DATA, _INDEX_DATA = 34962, 34963
# whole numbers that float32 holds, and one bit to spare
_WHOLE: Final = 2**23


def vertex_step(degrees: float) -> float:
    """Return the step, in metres, of vertices of tiles so many degrees wide or high."""
    across = math.radians(degrees) * AXIS * math.sqrt(2)
    return float(2.0 ** math.ceil(math.log2(across / _WHOLE)))


def glb(mesh: TileMesh, normals: Floats, step: float, extras: dict[str, Any]) -> bytes:
    """Return a tile as binary glTF.

    Parameters
    ----------
    mesh : TileMesh
        With at least one triangle.
    normals : (V, 3) float64
        Earth-centred.
    step : float
        See :func:`vertex_step`.
    extras : dict
        What the node says besides.
    """
    points = np.rint(mesh.surface.points / step)
    centre = np.rint((points.min(axis=0) + points.max(axis=0)) / 2)
    positions = _y_up((points - centre) * step).astype("<f4")
    corners = mesh.triangles.astype("<u2" if len(points) < 65535 else "<u4")
    views = [positions, _y_up(normals).astype("<f4"), corners]
    content = b""
    buffer_views = []
    for view, target in zip(views, (_VERTEX_DATA, _VERTEX_DATA, _INDEX_DATA), strict=True):
        buffer_views.append({"buffer": 0, "byteOffset": len(content), "byteLength": view.nbytes,
                             "target": target})  # fmt: skip
        content += view.tobytes() + b"\0" * (-view.nbytes % 4)
    # 3D Tiles wants files of a multiple of 8 bytes; what stands before is 28 and a multiple of 8
    content += b"\0" * (-(28 + len(content)) % 8)
    index = _UNSIGNED_SHORT if corners.dtype.itemsize == 2 else _UNSIGNED_INT
    vectors = {"componentType": _FLOAT, "count": len(points), "type": "VEC3"}
    document = {
        "asset": {"version": "2.0", "generator": "terrain_lod"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "translation": _y_up(centre[None] * step)[0].tolist(),
                   "extras": extras}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2,
                                    "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.72, 0.77, 0.63, 1.0],
                                                "metallicFactor": 0.0, "roughnessFactor": 1.0}}],
        "accessors": [
            {"bufferView": 0, **vectors, "min": positions.min(axis=0).tolist(),
             "max": positions.max(axis=0).tolist()},
            {"bufferView": 1, **vectors},
            {"bufferView": 2, "componentType": index, "count": corners.size, "type": "SCALAR"},
        ],
        "bufferViews": buffer_views,
        "buffers": [{"byteLength": len(content)}],
    }  # fmt: skip
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 8)
    total = 12 + 8 + len(text) + 8 + len(content)
    return b"".join(
        [
            struct.pack("<4sII", _MAGIC, 2, total),
            struct.pack("<I4s", len(text), b"JSON") + text,
            struct.pack("<I4s", len(content), b"BIN\0") + content,
        ]
    )


def _y_up(vectors: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    x, y, z = vectors.T
    return np.stack([x, z, 0.0 - y], axis=1)
