"""Numbers and structs that kernels and host share.

One description gives both the NumPy dtype and the C text, so the two cannot drift:
``header()`` is what kernels see as ``#include "layout.h"``.
"""

from __future__ import annotations

from typing import Final

import numpy as np

# 16.16 fixed point, the resolution of a Direct3D 11 tessellator's domain coordinates
FIXED_BITS: Final = 16
FIXED_ONE: Final = 1 << FIXED_BITS

# largest tile in cells: fractional_odd has no more than 63 segments along an edge
MAX_TILE: Final = 63
DEFAULT_TILE: Final = 4  # of a quadtree: docs/promises.md has the figures
FLAT_TILE: Final = 15  # of a flat grid: 16 x 16 samples, the work-group of the book

MAX_LEVELS: Final = 16  # of a quadtree

# corners of the tile, then the far corners of its four neighbours
CONTROL_POINTS: Final = 12
EDGES: Final = 4  # u = 0, v = 0, u = 1, v = 1
INSIDES: Final = 2  # along u, along v
FRUSTUM_PLANES: Final = 6

# curved patches of a mesh: own corners, both corners of the neighbour at each edge, the corners
# that speak for all at the same position
PATCH_ADJACENT: Final = 3
PATCH_DOMINANT: Final = 9
PATCH_INDICES: Final = 12
NET_VECTORS: Final = 16  # of a PN-triangle: 10 for positions, 6 for normals

# ways to divide an edge, by their number in kernels
PARTITIONINGS: Final = ("integer", "pow2", "fractional_odd", "fractional_even")

# how a raster is cut into tiles; spacing in metres
GRID: Final = np.dtype(
    [
        ("rows", np.int32),
        ("columns", np.int32),
        ("tile", np.int32),  # cells along a full tile
        ("tile_rows", np.int32),
        ("tile_columns", np.int32),
        ("last_row", np.int32),  # first sample of the last row of tiles
        ("last_column", np.int32),
        ("dx", np.float32),
        ("dy", np.float32),
    ]
)

# a quadtree of patches over the tiles: rows and columns of nodes, and the first node, by level
TREE: Final = np.dtype(
    [
        ("levels", np.int32),
        ("rows", np.int32, (MAX_LEVELS,)),
        ("columns", np.int32, (MAX_LEVELS,)),
        ("first", np.int32, (MAX_LEVELS,)),
    ]
)

# a camera as the hull sees it, relative to the terrain's origin and base
VIEW: Final = np.dtype(
    [
        ("eye", np.float32, (3,)),
        # a point is inside where dot(plane.xyz, point) + plane.w >= 0
        ("planes", np.float32, (FRUSTUM_PLANES, 4)),
        ("axes", np.float32, (3, 3)),  # right, upward, forward
        ("focal", np.float32),  # pixels of size 1 at depth 1; at any depth where parallel
        ("widest", np.float32),  # tangent of the angle to the corners of the picture
        ("near", np.float32),
        ("parallel", np.int32),
    ]
)

# a dent where something hit a mesh, relative to the mesh's origin; normal and tangent unit length
DECAL: Final = np.dtype(
    [
        ("point", np.float32, (3,)),
        ("normal", np.float32, (3,)),
        ("tangent", np.float32, (3,)),
        ("radius", np.float32),
        ("scale", np.float32),  # depth of a map's 1
        ("bias", np.float32),
    ]
)

# a lattice over a mesh, seen from above, relative to the mesh's origin
BINS: Final = np.dtype(
    [
        ("across", np.int32),
        ("down", np.int32),
        ("low_x", np.float32),
        ("low_y", np.float32),
        ("per_x", np.float32),  # bins a unit
        ("per_y", np.float32),
    ]
)

CONSTANTS: Final = {
    "FIXED_BITS": FIXED_BITS,
    "FIXED_ONE": FIXED_ONE,
    "MAX_TILE": MAX_TILE,
    "CONTROL_POINTS": CONTROL_POINTS,
    "EDGES": EDGES,
    "INSIDES": INSIDES,
    "FRUSTUM_PLANES": FRUSTUM_PLANES,
    "PATCH_ADJACENT": PATCH_ADJACENT,
    "PATCH_DOMINANT": PATCH_DOMINANT,
    "PATCH_INDICES": PATCH_INDICES,
    "NET_VECTORS": NET_VECTORS,
    **{name.upper(): number for number, name in enumerate(PARTITIONINGS)},
}
STRUCTS: Final = {"Grid": GRID, "Tree": TREE, "View": VIEW, "Bins": BINS, "Decal": DECAL}

_C_NAMES: Final = {"float32": "float", "int32": "int", "uint32": "uint"}


def header() -> str:
    """Return the text of ``layout.h``: a ``#define`` a constant, a ``typedef struct`` a dtype."""
    lines = [f"#define {name} {value}" for name, value in CONSTANTS.items()]
    for name, dtype in STRUCTS.items():
        members = "".join(f"    {_member(dtype, field)};\n" for field in dtype.names or ())
        lines.append(f"typedef struct {{\n{members}}} {name};")
    return "\n".join(lines) + "\n"


def _member(struct: np.dtype[np.void], field: str) -> str:
    dtype: np.dtype[np.generic] = struct[field]
    extents = "".join(f"[{extent}]" for extent in dtype.shape)
    return f"{_C_NAMES[dtype.base.name]} {field}{extents}"
