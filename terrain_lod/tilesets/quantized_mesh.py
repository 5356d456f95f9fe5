"""quantized-mesh 1.0, written: the terrain of Cesium's globe.

::

    header      centre, lowest and highest, bounding sphere, horizon point        88 bytes
    vertices    count | u | v | height, 0..32767 each, as differences, zigzag     uint16
    triangles   count | corners, as the distance below the highest one yet        uint16, uint32
    edges       west, south, east, north: count | vertices                        uint16, uint32
    extensions  number | length | bytes: 1 normals in two bytes, 4 metadata

Written here rather than with a library, for two reasons. Heights are whole multiples of one
quantum in all tiles of a level, so that neighbours decode to the same bits; the format's lowest and
highest height only say where the 32768 steps begin and how long they are. And earth-centred numbers
are float64 throughout: in float32 they would lose half a metre.

Cesium: *quantized-mesh-1.0 terrain format*; the horizon point after Ring, *Horizon Culling*, 2013.
"""

from __future__ import annotations

import json
import struct
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from .ellipsoid import AXIS, POLAR_AXIS, Floats
from .mend import TileMesh

MOST: Final = 32767
_HEADER: Final = struct.Struct("<3d2f4d3d")
_EXTENSION: Final = struct.Struct("<BI")
_NORMALS, _METADATA = 1, 4
# what float32 holds of whole numbers
_EXACT: Final = 2**24
# a horizon point for what is never hidden, in the Earth's radii
_ALWAYS: Final = 1e6


def smallest_quantum(low: float, high: float) -> float:
    """Return the finest step, a power of two, that all heights of a ground fit the format with."""
    span = max(high, 0.0) - min(low, 0.0)
    step = 2.0 ** np.ceil(np.log2(max(span / (MOST - 1), 1e-9)))
    # lowest and highest are written in float32
    while max(abs(low), abs(high)) / step > _EXACT / 2:
        step *= 2
    return float(step)


def quantized_mesh(
    mesh: TileMesh,
    normals: Floats | None = None,
    metadata: dict[str, Any] | None = None,
    *,
    rim: int | None = None,
) -> bytes:
    """Return the content of a .terrain file.

    Parameters
    ----------
    mesh : TileMesh
        On a grid of 32767 steps.
    normals : (V, 3) float64, optional
        Earth-centred.
    metadata : dict, optional
    rim : int, optional
        Vertices from this one on are those of walls and no edge's.

    Raises
    ------
    InputError
        If the tile's heights reach over more quanta than the format has steps.
    """
    rim = len(mesh.places) if rim is None else rim
    order, triangles = _by_first_use(mesh.triangles)
    places, quanta = mesh.places[order], mesh.quanta[order]
    low, high, steps = _steps(quanta, mesh.level.quantum)
    points = mesh.surface.points[order]
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = np.linalg.norm(points - centre, axis=1).max()
    horizon = _horizon_point(points, centre)
    index = "<u2" if len(places) <= 65536 else "<u4"
    parts = [
        _HEADER.pack(*centre, low, high, *centre, radius, *horizon),
        struct.pack("<I", len(places)),
        *(_zigzag(values) for values in (places[:, 0], places[:, 1], steps)),
    ]
    parts.append(b"\0" * (-sum(map(len, parts)) % np.dtype(index).itemsize))
    parts += [struct.pack("<I", len(triangles)), _below_highest(triangles).astype(index).tobytes()]
    for axis, line in ((0, 0), (1, 0), (0, MOST), (1, MOST)):
        edge = np.flatnonzero((places[:, axis] == line) & (order < rim))
        edge = edge[np.argsort(places[edge, 1 - axis])]
        parts += [struct.pack("<I", len(edge)), edge.astype(index).tobytes()]
    if normals is not None:
        encoded = octahedral(normals[order]).tobytes()
        parts += [_EXTENSION.pack(_NORMALS, len(encoded)), encoded]
    if metadata is not None:
        text = json.dumps(metadata, separators=(",", ":"), allow_nan=False).encode()
        parts += [_EXTENSION.pack(_METADATA, 4 + len(text)), struct.pack("<I", len(text)), text]
    return b"".join(parts)


def _by_first_use(
    triangles: npt.NDArray[np.int32],
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return vertices in the order of their first use, and triangles by that order."""
    corners = triangles.ravel()
    first = np.full(int(corners.max()) + 1, len(corners))
    # what is written last stays: from the end, that is the first use
    first[corners[::-1]] = np.arange(len(corners))[::-1]
    order = corners[first[corners] == np.arange(len(corners))].astype(np.int64)
    number = np.empty(len(first), np.int64)
    number[order] = np.arange(len(order))
    return order, number[triangles]


def _steps(
    quanta: npt.NDArray[np.int64], quantum: float
) -> tuple[float, float, npt.NDArray[np.int64]]:
    """Return the lowest and highest height to write, and heights in steps between them.

    A step is a quantum or a half, quarter, ... of it: as small as lets them reach the highest
    vertex, so that what is written is at most twice as high as the tile.
    """
    low, span = int(quanta.min()), int(np.ptp(quanta))
    if span > MOST:
        raise InputError(
            f"expected heights within {MOST * quantum:g} m in one tile, got {span * quantum:g} m"
        )
    parts = 1
    while span * parts * 2 <= MOST and (abs(low) + span + 1) * parts * 2 < _EXACT // 2:
        parts *= 2
    step = quantum / parts
    return low * quantum, low * quantum + MOST * step, (quanta - low) * parts


def _zigzag(values: npt.NDArray[np.int64]) -> bytes:
    """Return differences with the sign in the last bit."""
    steps = np.diff(values, prepend=0)
    return ((steps << 1) ^ (steps >> 63)).astype("<u2").tobytes()


def _below_highest(triangles: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    """Return how far each corner is below the first number that was not used yet."""
    corners = triangles.ravel()
    highest = np.maximum.accumulate(corners)
    # what is new is the highest, and one more than the highest before it
    before = np.concatenate([[-1], highest[:-1]])
    return np.asarray(before + 1 - corners)


def octahedral(normals: Floats) -> npt.NDArray[np.uint8]:
    """Return unit vectors in two bytes each, (V, 2): the octahedron unfolded into a square.

    Cigolle, Donow et al.: *A Survey of Efficient Representations for Independent Unit Vectors*,
    2014.
    """
    flat = normals / np.abs(normals).sum(axis=1)[:, None]
    x, y, z = flat.T
    sign_x, sign_y = np.where(x < 0, -1.0, 1.0), np.where(y < 0, -1.0, 1.0)
    below = z < 0
    square = np.stack(
        [
            np.where(below, (1 - abs(y)) * sign_x, x),
            np.where(below, (1 - abs(x)) * sign_y, y),
        ],
        axis=1,
    )
    return np.asarray(np.rint((np.clip(square, -1, 1) + 1) / 2 * 255), np.uint8)


def _horizon_point(points: Floats, centre: Floats) -> Floats:
    """Return a point that is below the horizon only where all of the tile is, in Earth's radii."""
    scaled = points / [AXIS, AXIS, POLAR_AXIS]
    direction = centre / [AXIS, AXIS, POLAR_AXIS]
    direction = direction / np.linalg.norm(direction)
    lengths = np.maximum(np.linalg.norm(scaled, axis=1), 1.0)
    towards = scaled / np.linalg.norm(scaled, axis=1)[:, None]
    cos_alpha = towards @ direction
    sin_alpha = np.linalg.norm(np.cross(towards, direction), axis=1)
    cos_beta = 1 / lengths
    sin_beta = np.sqrt(lengths**2 - 1) * cos_beta
    seen = cos_alpha * cos_beta - sin_alpha * sin_beta
    # seen from beyond a quarter of the Earth, it is never below the horizon
    reach = _ALWAYS if seen.min() <= 1 / _ALWAYS else float((1 / seen).max())
    return np.asarray(direction * reach)
