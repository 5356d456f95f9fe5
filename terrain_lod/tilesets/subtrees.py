"""Subtrees of implicit tiling: which tiles there are, and what is measured of each.

::

    "subt", 1, bytes of JSON, bytes behind it | JSON | bits: tiles, contents, child subtrees
                                                     | float64: errors, lowest, highest

Tiles of a subtree stand level by level, those of a level in Morton's order: the bits of x and y
take turns, x first from below. Open Geospatial Consortium: *3D Tiles 1.1*, section 8, 22-025r4.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Set
from typing import Any, Final

import numpy as np

from .journal import Record
from .schemes import Tile

# levels of one subtree
LEVELS: Final = 5
SCHEMA: Final[dict[str, Any]] = {
    "id": "terrain",
    "classes": {
        "tile": {
            "properties": {
                name: {"type": "SCALAR", "componentType": "FLOAT64", "semantic": f"TILE_{name}"}
                for name in ("GEOMETRIC_ERROR", "MINIMUM_HEIGHT", "MAXIMUM_HEIGHT")
            }
        }
    },
}


def morton(x: int, y: int) -> int:
    """Return the number whose bits are those of x and y in turns."""
    return sum(((x >> bit & 1) | (y >> bit & 1) << 1) << 2 * bit for bit in range(x.bit_length() +
               y.bit_length()))  # fmt: skip


def below(tile: Tile, levels: int) -> list[Tile]:
    """Return the tiles so many levels below one, in Morton's order."""
    z, x, y = tile
    side = 1 << levels
    tiles = [(z + levels, x * side + i, y * side + j) for i in range(side) for j in range(side)]
    return sorted(tiles, key=lambda tile: morton(tile[1] - x * side, tile[2] - y * side))


def subtree(root: Tile, there: Set[Tile], records: Mapping[Tile, Record]) -> bytes:
    """Return the file of the subtree under a tile.

    Parameters
    ----------
    root : (z, x, y)
    there : set of (z, x, y)
        Tiles that have content or stand above some that have.
    records : dict
        Of the tiles that have content, and what is said of the others.
    """
    tiles = [tile for level in range(LEVELS) for tile in below(root, level)]
    available = [tile in there for tile in tiles]
    contents = [tile in there and records[tile].triangles > 0 for tile in tiles]
    children = [tile in there for tile in below(root, LEVELS)]
    rows = [records[tile] for tile, is_there in zip(tiles, available, strict=True) if is_there]
    views: list[bytes] = []

    def bits(values: list[bool]) -> dict[str, int]:
        if all(values) or not any(values):
            return {"constant": int(values[0])}
        views.append(np.packbits(values, bitorder="little").tobytes())
        return {"bitstream": len(views) - 1, "availableCount": sum(values)}

    def column(values: list[float]) -> dict[str, int]:
        views.append(np.array(values, "<f8").tobytes())
        return {"values": len(views) - 1}

    document: dict[str, Any] = {
        "tileAvailability": bits(available),
        "contentAvailability": [bits(contents)],
        "childSubtreeAvailability": bits(children),
        "tileMetadata": 0,
        "propertyTables": [
            {
                "class": "tile",
                "count": len(rows),
                "properties": {
                    "GEOMETRIC_ERROR": column([row.error for row in rows]),
                    "MINIMUM_HEIGHT": column([row.low for row in rows]),
                    "MAXIMUM_HEIGHT": column([row.high for row in rows]),
                },
            }
        ],
    }
    content, placed = b"", []
    for view in views:
        placed.append({"buffer": 0, "byteOffset": len(content), "byteLength": len(view)})
        content += view + b"\0" * (-len(view) % 8)
    document |= {"bufferViews": placed, "buffers": [{"byteLength": len(content)}]}
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 8)
    return struct.pack("<4sIQQ", b"subt", 1, len(text), len(content)) + text + content
