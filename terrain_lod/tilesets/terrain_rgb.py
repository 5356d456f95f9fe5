"""A folder of terrain-RGB: heights packed in the colours of PNG tiles, as MapLibre reads them.

::

    terrarium   height = 256 red + green + blue / 256 - 32768        steps of 1/256 m
    mapbox      height = (65536 red + 256 green + blue) / 10 - 10000     steps of 0.1 m

Pixels stand for heights at their middles. A tile's error is that of the surface bilinear between
them, those of the next tiles included, at every sample; lowest and highest are samples, too.
"""

from __future__ import annotations

import io
import json
from collections.abc import Collection
from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt
from PIL import Image

from .ellipsoid import Floats
from .job import Job
from .journal import Record
from .levels import reach
from .schemes import Tile, bounds_of

NAME: Final = "tiles.json"
PIXELS: Final = 256
# step and height of the number 0
ENCODINGS: Final = {"terrarium": (1 / 256, -32768.0), "mapbox": (0.1, -10000.0)}
# heights of a pixel are looked at along each axis, to be averaged, at most
_FINEST: Final = 8


def write_picture(job: Job, tile: Tile) -> Record:
    """Sample a tile, measure it and write it."""
    z, x, y = tile
    step, zero = ENCODINGS[job.encoding]
    heights = _heights(job, tile)
    numbers = np.clip(np.rint((heights - zero) / step), 0, 2**24 - 1).astype(np.int64)
    record = _measured(job, tile, np.asarray(numbers * step + zero, np.float64))
    inside = numbers[1:-1, 1:-1]
    colours = np.stack([inside >> 16, inside >> 8 & 255, inside & 255], axis=-1)
    file = io.BytesIO()
    Image.fromarray(colours.astype(np.uint8)).save(file, "png")
    # rows count from the north in these files
    path = f"{z}/{x}/{2**z - 1 - y}.png"
    return replace(record, path=path, bytes=job.write(path, file.getvalue()))


def write_tilejson(job: Job, records: Collection[Record]) -> None:
    """Write what a client asks for first."""
    known = [record for record in records if record.z == job.deepest and record.low <= record.high]
    document = {
        "tilejson": "3.0.0",
        "tiles": ["{z}/{x}/{y}.png"],
        "scheme": "xyz",
        "bounds": list(job.source.bounds),
        "minzoom": 0,
        "maxzoom": job.deepest,
        "encoding": job.encoding,
        "tileSize": PIXELS,
        "lowest": min(record.low for record in known),
        "highest": max(record.high for record in known),
        "error": max(record.error for record in known),
        **job.about,
    }
    job.write(NAME, json.dumps(document, indent=1).encode())


def _heights(job: Job, tile: Tile) -> Floats:
    """Return heights of a tile's pixels and of a ring around it, row 0 north; 0 without ground."""
    z, x, y = tile
    finer = min(2 ** (job.deepest - z), _FINEST)
    # the middles of the parts that each pixel is averaged from
    steps = (np.arange(-finer, (PIXELS + 1) * finer) + 0.5) / finer / PIXELS
    lon = job.scheme.longitude(z, x) + steps * (360.0 / 2**z)
    lat = np.degrees(np.arctan(np.sinh(2 * np.pi * ((y + 1 - steps) / 2**z - 0.5))))
    far = reach(job.source, job.scheme, z)
    # nothing is asked for where no ground can be
    west, south, east, north = job.source.bounds
    rim = (far + 2) * job.source.step / 1e4
    across = (lon > west - rim) & (lon < east + rim)
    down = (lat > south - rim) & (lat < north + rim)
    heights = np.full((len(lat), len(lon)), np.nan)
    if across.any() and down.any():
        longitudes, latitudes = np.meshgrid(lon[across], lat[down])
        known = job.source.heights(longitudes, latitudes, far)
        heights[np.ix_(down, across)] = known
    parts = heights.reshape(PIXELS + 2, finer, PIXELS + 2, finer)
    there = np.isfinite(parts)
    count = there.sum(axis=(1, 3))
    total = np.where(there, parts, 0.0).sum(axis=(1, 3))
    return np.where(count > 0, total / np.maximum(count, 1), 0.0)


def _measured(job: Job, tile: Tile, heights: Floats) -> Record:
    """Return a record of a tile with its error and the range of its samples."""
    z, x, y = tile
    error, low, high = 0.0, np.inf, -np.inf
    for samples in job.source.samples(bounds_of(job.scheme, tile)):
        across = (samples.longitude - job.scheme.longitude(z, x)) * (2**z / 360.0)
        up = np.arcsinh(np.tan(np.radians(samples.latitude))) / (2 * np.pi) + 0.5
        # in pixels from the middle of the ring's first one
        column = across * PIXELS + 0.5
        row = (y + 1 - up * 2**z) * PIXELS + 0.5
        shown = _bilinear(heights, row, column)
        error = max(error, float(abs(shown - samples.height).max()))
        low, high = min(low, float(samples.height.min())), max(high, float(samples.height.max()))
    return Record(z, x, y, "", 0, 0, error, low, high)


def _bilinear(heights: Floats, row: Floats, column: Floats) -> npt.NDArray[np.float64]:
    first_row = np.clip(row.astype(np.int64), 0, PIXELS)
    first_column = np.clip(column.astype(np.int64), 0, PIXELS)
    down, across = row - first_row, column - first_column
    north = heights[first_row, first_column] * (1 - across)
    north += heights[first_row, first_column + 1] * across
    south = heights[first_row + 1, first_column] * (1 - across)
    south += heights[first_row + 1, first_column + 1] * across
    return np.asarray(north * (1 - down) + south * down)
