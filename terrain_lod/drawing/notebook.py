"""What notebooks show of a value: a title, a table, and perhaps a picture from above."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping
from html import escape
from io import BytesIO
from typing import Final

import numpy as np
import numpy.typing as npt
from PIL import Image

from .colours import hypsometric, lit, sun_direction, to_bytes

_SIDE: Final = 160  # pixels of a picture's longer side, at most
_SUN: Final = (315.0, 45.0)  # azimuth and elevation, degrees
_HOLE: Final = (0.97, 0.97, 0.97)


def page(title: str, table: Mapping[str, str], picture: bytes | None = None) -> str:
    """Return a title, a table of names and values, and a PNG beside it, as HTML."""
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


def from_above(
    elevation: npt.NDArray[np.float64],
    spacing: tuple[float, float],
    height_range: tuple[float, float],
) -> bytes:
    """Return a PNG of heights from above, tinted and lit; (R, C), NaN where there is no data."""
    step = -(-max(elevation.shape) // _SIDE)
    heights = elevation[::step, ::step]
    holes = np.isnan(heights)
    filled = np.where(holes, height_range[0], heights)
    dx, dy = (distance * step for distance in spacing)
    # a picture a sample wide or high has no slope
    if min(filled.shape) > 1:
        south, east = np.gradient(filled, dy, dx)
    else:
        south = east = np.zeros_like(filled)
    normals = np.stack([-east, south, np.ones_like(filled)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    flat = normals.reshape(-1, 3).astype(np.float32)
    tints = hypsometric(filled.ravel().astype(np.float32), flat, height_range)
    colours = lit(tints, flat, sun_direction(*_SUN))
    colours[holes.ravel()] = _HOLE
    buffer = BytesIO()
    Image.fromarray(to_bytes(colours).reshape(*filled.shape, 3)).save(buffer, "PNG")
    return buffer.getvalue()
