"""A folder of 3D Tiles 1.1: z/x/y.glb, tileset.json, and subtrees where tiling is implicit."""

from __future__ import annotations

import json
import math
from collections.abc import Collection
from dataclasses import replace
from typing import Any, Final

from .glb import glb
from .job import Job
from .journal import Record
from .normals import vertex_normals
from .schemes import Tile, bounds_of
from .skirts import with_skirts
from .subtrees import LEVELS, SCHEMA, subtree
from .tile_mesh import tile_mesh

NAME: Final = "tileset.json"


def write_tileset_tile(job: Job, tile: Tile) -> Record:
    """Mesh a tile and write it, unless no ground is there."""
    z = tile[0]
    mesh = tile_mesh(job.source, job.scheme, tile, job.levels[z])
    if not len(mesh.triangles):
        return Record(*tile, "", 0, 0, 0.0, 0.0, 0.0)
    record = Record.of(mesh, "{}/{}/{}.glb".format(*tile))
    normals = vertex_normals(job.source, job.scheme, mesh)
    if job.skirts:
        mesh, above = with_skirts(mesh, job.skirt(z))
        normals = normals[above]
    extras = {"error": mesh.error, "samples": mesh.samples}
    content = glb(mesh, normals, job.levels[z].rounding, extras)
    low = min(record.low, float(mesh.heights.min()))
    return replace(record, low=low, bytes=job.write(record.path, content))


def write_tileset(job: Job, records: Collection[Record]) -> None:
    """Write what a client asks for first, and the subtrees."""
    by_tile = {record.tile: record for record in records}
    there = _there(by_tile)
    # from the deepest level up
    known = {tile: _with_range(by_tile, there, tile) for tile in sorted(there, reverse=True)}
    root = known[0, 0, 0]
    document: dict[str, Any] = {
        "asset": {"version": "1.1", "generator": "terrain_lod", "extras": job.about},
        # what is missed where nothing is drawn: all of it
        "geometricError": _diagonal(job),
    }
    if job.implicit:
        document["schema"] = SCHEMA
        document["root"] = {
            **_node(job, root),
            "content": {"uri": "{level}/{x}/{y}.glb"},
            "implicitTiling": {
                "subdivisionScheme": "QUADTREE",
                "availableLevels": job.deepest + 1,
                "subtreeLevels": LEVELS,
                "subtrees": {"uri": "subtrees/{level}/{x}/{y}.subtree"},
            },
        }
        for tile in there:
            if tile[0] % LEVELS == 0:
                path = "subtrees/{}/{}/{}.subtree".format(*tile)
                job.write(path, subtree(tile, there, known))
    else:
        document["root"] = _explicit(job, there, known, (0, 0, 0))
    job.write(NAME, json.dumps(document, separators=(",", ":")).encode())


def _there(records: dict[Tile, Record]) -> set[Tile]:
    """Return the tiles that have content, and all above them."""
    there = set()
    for record in records.values():
        tile = record.tile
        while record.triangles and tile not in there:
            there.add(tile)
            z, x, y = tile
            tile = (max(z - 1, 0), x // 2, y // 2)
    return there


def _children(there: set[Tile], tile: Tile) -> list[Tile]:
    z, x, y = tile
    below = [(z + 1, 2 * x + i, 2 * y + j) for j in (0, 1) for i in (0, 1)]
    return [child for child in below if child in there]


def _with_range(records: dict[Tile, Record], there: set[Tile], tile: Tile) -> Record:
    """Return a tile's record with the heights of those below it in its own.

    What holds them has to hold theirs; records are replaced from the deepest level up.
    """
    record = records[tile]
    parts = [records[child] for child in _children(there, tile)]
    if record.triangles:
        parts.append(record)
    records[tile] = replace(
        record, low=min(part.low for part in parts), high=max(part.high for part in parts),
        # where nothing is drawn for it, what is below counts
        error=record.error if record.triangles else max(part.error for part in parts) * 2,
    )  # fmt: skip
    return records[tile]


def _node(job: Job, record: Record) -> dict[str, Any]:
    bounds = [math.radians(angle) for angle in bounds_of(job.scheme, record.tile)]
    return {
        "boundingVolume": {"region": [*bounds, record.low, record.high]},
        "geometricError": record.error,
        "refine": "REPLACE",
    }


def _explicit(
    job: Job, there: set[Tile], records: dict[Tile, Record], tile: Tile
) -> dict[str, Any]:
    node = _node(job, records[tile])
    if records[tile].triangles:
        node["content"] = {"uri": records[tile].path}
    children = [_explicit(job, there, records, child) for child in _children(there, tile)]
    return {**node, "children": children} if children else node


def _diagonal(job: Job) -> float:
    west, south, east, north = job.source.bounds
    return math.hypot(east - west, north - south) * 111e3
