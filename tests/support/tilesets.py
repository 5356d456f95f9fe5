"""Tiles read back by code that shares nothing with what writes them, and measured from outside."""

from __future__ import annotations

import gzip
import json
import math
import struct
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.tri import Triangulation
from pyproj import Transformer

import terrain_lod as tl

CENTRED = Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
JACKSBORO_DEGREES = (89487.788051, 110969.966807)


def centred(vertices):
    """Return earth-centred points of longitudes, latitudes and heights; (..., 3)."""
    return np.stack(CENTRED.transform(*np.moveaxis(vertices, -1, 0)), axis=-1)


def jacksboro(rows=slice(100, 190), columns=slice(150, 260), mask=None):
    """Return a part of real ground in degrees."""
    whole = tl.sample("jacksboro")
    (x, y), (dx, dy) = whole.origin, whole.spacing
    return tl.Heightmap(
        whole.elevation[rows, columns],
        spacing=whole.spacing,
        origin=(x + columns.start * dx, y - rows.start * dy),
        crs=whole.crs,
        mask=mask,
    )


def degrees(ground):
    """Return longitude, latitude and height of such ground's samples that have data; (S, 3)."""
    row, column = np.nonzero(ground.valid)
    (x, y), (dx, dy) = ground.origin, ground.spacing
    lon = (x + column * dx) / JACKSBORO_DEGREES[0]
    lat = (y - row * dy) / JACKSBORO_DEGREES[1]
    return np.stack([lon, lat, ground.elevation[row, column]], axis=1)


def places(ground, count=200):
    """Return some samples, none on the outermost line: there a client's float32 decides."""
    samples = degrees(ground)
    inner = (samples[:, :2] > samples[:, :2].min(axis=0)) & (
        samples[:, :2] < samples[:, :2].max(axis=0)
    )
    return np.random.default_rng(15).choice(samples[inner.all(axis=1)], count, replace=False)


@dataclass(frozen=True)
class Decoded:
    """A tile: vertices as longitude, latitude, height; (V, 3)."""

    bounds: tuple[float, float, float, float]
    vertices: np.ndarray
    triangles: np.ndarray
    error: float
    normals: np.ndarray
    edges: tuple[np.ndarray, ...] = ()
    places: np.ndarray | None = None
    header: tuple = ()
    metadata: dict | None = None


def geographic_bounds(z, x, y):
    side = 180 / 2**z
    return -180 + x * side, -90 + y * side, -180 + (x + 1) * side, -90 + (y + 1) * side


def mercator_bounds(z, x, y):
    side = 360 / 2**z
    south, north = (math.degrees(math.atan(math.sinh(math.pi * (2 * row / 2**z - 1))))
                    for row in (y, y + 1))  # fmt: skip
    return -180 + x * side, south, -180 + (x + 1) * side, north


def read_terrain(path: Path, bounds) -> Decoded:
    """Decode quantized-mesh 1.0 as its specification has it."""
    content = path.read_bytes()
    if content[:2] == b"\x1f\x8b":
        content = gzip.decompress(content)
    header = struct.unpack_from("<3d2f4d3d", content)
    low, high = header[3:5]
    at = 88

    def numbers(kind, count):
        nonlocal at
        found = np.frombuffer(content, kind, count, at)
        at += found.nbytes
        return found.astype(np.int64)

    (count,) = numbers("<u4", 1)
    u, v, h = ((n >> 1 ^ -(n & 1)).cumsum() for n in (numbers("<u2", count) for _ in range(3)))
    index = "<u2" if count <= 65536 else "<u4"
    at += -at % np.dtype(index).itemsize
    (triangle_count,) = numbers("<u4", 1)
    highest, corners = 0, []
    for code in numbers(index, 3 * triangle_count).tolist():
        corners.append(highest - code)
        highest += code == 0
    edges = tuple(numbers(index, numbers("<u4", 1)[0]) for _ in range(4))
    normals, metadata = None, None
    while at < len(content):
        number, length = struct.unpack_from("<BI", content, at)
        part = content[at + 5 : at + 5 + length]
        at += 5 + length
        if number == 1:
            normals = _from_octahedron(np.frombuffer(part, np.uint8).reshape(-1, 2))
        if number == 4:
            assert struct.unpack_from("<I", part)[0] == len(part) - 4
            metadata = json.loads(part[4:])
    west, south, east, north = bounds
    vertices = np.stack(
        [
            west + u / 32767 * (east - west),
            south + v / 32767 * (north - south),
            (1 - h / 32767) * low + h / 32767 * high,
        ],
        axis=1,
    )
    return Decoded(bounds, vertices, np.array(corners).reshape(-1, 3), metadata["error"], normals,
                   edges, np.stack([u, v], axis=1), header, metadata)  # fmt: skip


def _from_octahedron(codes):
    x, y = codes.T / 255 * 2 - 1
    z = 1 - abs(x) - abs(y)
    fold = np.maximum(-z, 0)
    vectors = np.stack([x - np.copysign(fold, x), y - np.copysign(fold, y), z], axis=1)
    return vectors / np.linalg.norm(vectors, axis=1)[:, None]


def glb_parts(path: Path):
    """Return a GLB's JSON, and earth-centred positions in float64, normals and triangles."""
    content = path.read_bytes()
    if content[:2] == b"\x1f\x8b":
        content = gzip.decompress(content)
    assert len(content) % 8 == 0
    length = struct.unpack_from("<I", content, 12)[0]
    document, data = json.loads(content[20 : 20 + length]), content[28 + length :]

    def array(number):
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5125: "<u4", 5123: "<u2"}[accessor["componentType"]]
        count = accessor["count"] * {"VEC3": 3, "SCALAR": 1}[accessor["type"]]
        return np.frombuffer(data, kind, count, view["byteOffset"]).reshape(-1, 3)

    def z_up(vectors):
        x, y, z = vectors.astype(np.float64).T
        return np.stack([x, -z, y], axis=1)

    (node,) = document["nodes"]
    positions = array(0).astype(np.float64) + np.array(node["translation"])
    return document, z_up(positions), z_up(array(1)), array(2).astype(np.int64)


def read_glb(path: Path, bounds) -> Decoded:
    document, points, normals, triangles = glb_parts(path)
    vertices = np.stack(CENTRED.transform(*points.T, direction="INVERSE"), axis=1)
    return Decoded(bounds, vertices, triangles, document["nodes"][0]["extras"]["error"], normals)


def without_walls(tile: Decoded) -> Decoded:
    """Return a tile without triangles that stand upright."""
    a, b, c = (centred(tile.vertices[tile.triangles[:, corner]]) for corner in range(3))
    normal, up = np.cross(b - a, c - a), a / np.linalg.norm(a, axis=1)[:, None]
    leaning = np.einsum("ij,ij->i", normal, up) / np.linalg.norm(normal, axis=1)
    # the ellipsoid's normal is up to a fifth of a degree from the centre's direction
    return replace(tile, triangles=tile.triangles[leaning > 0.005])


def measured(tile: Decoded, samples: np.ndarray) -> tuple[float, int]:
    """Return the largest distance of samples, (S, 3), within a tile, and how many there are.

    Along the ellipsoid's normal, to the flat triangle between earth-centred corners and to the
    height that is linear in degrees; a sample on a side may belong to either triangle.
    """
    west, south, east, north = tile.bounds
    lon, lat, height = samples.T
    inside = (lon > west) & (lon < east) & (lat > south) & (lat < north)
    lon, lat, height = samples[inside].T
    if not len(lon):
        return 0.0, 0
    flat = Triangulation(tile.vertices[:, 0], tile.vertices[:, 1], tile.triangles)
    owner = flat.get_trifinder()(lon, lat)
    assert (owner >= 0).all(), f"{(owner < 0).sum()} samples are not covered"
    corners = tile.vertices[tile.triangles[owner]]
    a, b, c = (centred(corners[:, i]) for i in range(3))
    foot, above = (centred(np.stack([lon, lat, np.full_like(lon, h)], axis=1)) for h in (0, 1))
    up = above - foot
    normal = np.cross(b - a, c - a)
    drawn = np.einsum("ij,ij->i", a - foot, normal) / np.einsum("ij,ij->i", up, normal)
    matrix = np.concatenate([corners[:, :, :2], np.ones((len(lon), 3, 1))], axis=2)
    place = np.stack([lon, lat, np.ones_like(lon)], axis=1)
    weights = np.linalg.solve(matrix.transpose(0, 2, 1), place[:, :, None])[:, :, 0]
    linear = (weights * corners[:, :, 2]).sum(axis=1)
    return float(max(abs(drawn - height).max(), abs(linear - height).max())), len(lon)


def contents(folder: Path) -> dict[Path, bytes]:
    """Return all files of a folder of tiles but its journal, which is in the order of the work."""
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*.*")
            if path.name != "tiles.jsonl"}  # fmt: skip
