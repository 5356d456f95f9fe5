"""What notebooks show for a heightmap, a terrain and a mesh: a table, and a picture from above."""

from __future__ import annotations

from base64 import b64encode
from html import escape
from io import BytesIO
from typing import TYPE_CHECKING, Final

import numpy as np
from PIL import Image

from .colours import (
    hypsometric,
    lit,
    sun_direction,
    to_bytes,
)

if TYPE_CHECKING:
    from ..ground.heightmap import Heightmap
    from ..mesh.mesh import Mesh
    from ..terrain.terrain import Terrain

_SIDE: Final = 160  # pixels of a picture's longer side, at most
_SUN: Final = (315.0, 45.0)  # azimuth and elevation, degrees
_HOLE: Final = (0.97, 0.97, 0.97)


def heightmap_html(ground: Heightmap) -> str:
    """Return a heightmap as HTML."""
    return _page(f"Heightmap {ground.name}", _ground_rows(ground), _picture(ground))


def terrain_html(terrain: Terrain) -> str:
    """Return a terrain as HTML."""
    rows, columns = terrain.grid.shape
    tiles = f"{rows} × {columns} of {terrain.grid.tile} cells"
    table = {**_ground_rows(terrain.ground), "tiles": tiles, "device": terrain.device.info.name}
    if terrain.detail is not None:
        table["detail"] = " × ".join(f"{extent:,}" for extent in terrain.detail.shape)
    return _page(f"Terrain {terrain.ground.name}", table, _picture(terrain.ground))


def mesh_html(mesh: Mesh) -> str:
    """Return a mesh as HTML."""
    table = {"triangles": f"{len(mesh.triangles):,}", "vertices": f"{len(mesh.vertices):,}"}
    if len(mesh.vertices):
        size = np.ptp(mesh.vertices, axis=0)
        table["size"] = " × ".join(f"{extent:,.4g}" for extent in size)
    table["origin"] = ", ".join(f"{value:,.10g}" for value in mesh.origin)
    if mesh.patches is not None:
        drawn = mesh.patches.count - mesh.patches.culled_count
        table["patches"] = f"{drawn:,} drawn, {mesh.patches.culled_count:,} culled"
    if mesh.achieved is not None:
        pixels = mesh.achieved.pixels
        seen = "" if pixels is None else f", {pixels:.3g} pixels"
        table["largest error"] = f"{mesh.achieved.metres:.4g}{seen}"
    for stage, seconds in mesh.timings.items():
        table[stage] = f"{1e3 * seconds:.1f} ms"
    if mesh.crs:
        table["CRS"] = mesh.crs
    return _page("Mesh", table)


def _ground_rows(ground: Heightmap) -> dict[str, str]:
    low, high = ground.height_range
    table = {
        "samples": " × ".join(f"{extent:,}" for extent in ground.shape),
        "spacing": " × ".join(f"{step:g}" for step in ground.spacing),
        "heights": f"{low:,.6g} to {high:,.6g}",
        "origin": ", ".join(f"{value:,.10g}" for value in ground.origin),
    }
    if ground.mask is not None:
        table["nodata"] = f"{int(ground.mask.sum()):,} samples"
    if ground.crs:
        table["CRS"] = ground.crs
    return table


def _picture(ground: Heightmap) -> bytes:
    """Return a PNG of the ground from above, tinted by height and lit."""
    step = -(-max(ground.shape) // _SIDE)
    heights = ground.elevation[::step, ::step]
    holes = np.isnan(heights)
    low, high = ground.height_range
    filled = np.where(holes, low, heights)
    dx, dy = (spacing * step for spacing in ground.spacing)
    # a picture a sample wide or high has no slope
    if min(filled.shape) > 1:
        south, east = np.gradient(filled, dy, dx)
    else:
        south = east = np.zeros_like(filled)
    normals = np.stack([-east, south, np.ones_like(filled)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    flat = normals.reshape(-1, 3).astype(np.float32)
    tints = hypsometric(filled.ravel().astype(np.float32), flat, (low, high))
    colours = lit(tints, flat, sun_direction(*_SUN))
    colours[holes.ravel()] = _HOLE
    buffer = BytesIO()
    Image.fromarray(to_bytes(colours).reshape(*filled.shape, 3)).save(buffer, "PNG")
    return buffer.getvalue()


def _page(title: str, table: dict[str, str], picture: bytes | None = None) -> str:
    rows = "".join(
        f"<tr><th style='text-align: left'>{escape(name)}</th>"
        f"<td style='text-align: left'>{escape(value)}</td></tr>"
        for name, value in table.items()
    )
    image = ""
    if picture is not None:
        data = b64encode(picture).decode()
        image = f"<img alt='from above, north up' src='data:image/png;base64,{data}'>"
    return (
        "<div style='display: flex; gap: 1em; align-items: flex-start'>"
        f"<div><b>{escape(title)}</b><table>{rows}</table></div>{image}</div>"
    )
