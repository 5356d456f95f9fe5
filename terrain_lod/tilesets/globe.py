"""A folder of quantized-mesh, as Cesium's globe wants it: z/x/y.terrain and layer.json."""

from __future__ import annotations

import json
from collections.abc import Collection
from dataclasses import replace
from typing import Any

from .job import Job
from .journal import Record
from .normals import vertex_normals
from .quantized_mesh import quantized_mesh
from .schemes import Geographic, Tile
from .skirts import with_skirts
from .tile_mesh import tile_mesh

LAYER = "layer.json"


def write_globe_tile(job: Job, tile: Tile) -> Record:
    """Mesh a tile and write it."""
    mesh = tile_mesh(job.source, job.scheme, tile, job.levels[tile[0]])
    normals = vertex_normals(job.source, job.scheme, mesh)
    metadata: dict[str, Any] = {"error": mesh.error, "samples": mesh.samples}
    if tile[0] == 0:
        metadata["available"] = available(job)[1:]
    record = Record.of(mesh, path := "{}/{}/{}.terrain".format(*tile))
    rim = len(mesh.places)
    if job.skirts:
        mesh, above = with_skirts(mesh, job.skirt(tile[0]))
        normals = normals[above]
    return replace(record, bytes=job.write(path, quantized_mesh(mesh, normals, metadata, rim=rim)))


def write_layer(job: Job, records: Collection[Record]) -> None:
    """Write what a client asks for first."""
    west, south, east, north = job.source.bounds
    layer: dict[str, Any] = {
        "tilejson": "2.1.0",
        "format": "quantized-mesh-1.0",
        "version": "1.0.0",
        "scheme": "tms",
        "tiles": ["{z}/{x}/{y}.terrain"],
        "projection": "EPSG:4326" if isinstance(job.scheme, Geographic) else "EPSG:3857",
        "bounds": [west, south, east, north],
        "minzoom": 0,
        "maxzoom": job.deepest,
        "extensions": ["octvertexnormals", "metadata"],
        "available": available(job),
        # clients that read metadata are told by the tiles of level 0
        "metadataAvailability": job.deepest + 1,
        **job.about,
    }
    job.write(LAYER, json.dumps(layer, indent=1).encode())


def available(job: Job) -> list[list[dict[str, int]]]:
    """Return the rectangle of the tiles that there are at each level."""
    levels = []
    for z in range(job.deepest + 1):
        columns, rows = job.tiles(z)
        levels.append([{"startX": columns[0], "startY": rows[0],
                        "endX": columns[-1], "endY": rows[-1]}])  # fmt: skip
    return levels
