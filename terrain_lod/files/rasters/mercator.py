"""The map of the web, EPSG:3857, and its tiles.

x = a longitude, y = a asinh(tan(latitude)), in radians, with a the semi-major axis of WGS 84: the
formulas of a sphere with the latitudes of an ellipsoid (IOGP Guidance Note 7-2, section 3.2.1.2).
Tile (0, 0, 0) is the whole square of it, tile (z, x, y) one of 4^z, x eastwards and y southwards
from the north-western corner.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Final

from ...arguments import parts, whole
from ...errors import InputError
from ...ground.units import METRE
from .raster import Raster
from .wkt import WGS84, System

CODE: Final = "EPSG:3857"
# what others call the same map
CODES: Final = (CODE, "EPSG:3785", "EPSG:900913", "EPSG:102100", "EPSG:102113", "ESRI:102100",
                "ESRI:102113")  # fmt: skip
SYSTEM: Final = System(CODE, CODE, unit=METRE)
TILE_PATH: Final = re.compile(r"(\d{1,2})/(\d{1,10})/(\d{1,10})(?:@\dx)?\.\w+$")

Tile = tuple[int, int, int]


def geographic(x: float, y: float) -> tuple[float, float]:
    """Return longitude and latitude in degrees."""
    latitude = math.atan(math.sinh(max(min(y / WGS84.axis, 700.0), -700.0)))
    return math.degrees(x / WGS84.axis), math.degrees(latitude)


def checked_tile(tile: object, name: str = "tile") -> Tile:
    """Return (z, x, y), or say what is wrong with it."""
    level, *place = parts(name, tile, "z", "x", "y")
    z = whole("z of the tile", level, 0, 30)
    x, y = (
        whole(f"{axis} of a tile at z = {z}", number, 0, 2**z - 1)
        for axis, number in zip("xy", place, strict=True)
    )
    return z, x, y


def tile_of(path: Path) -> Tile | None:
    """Return the (z, x, y) that a path such as ``12/2138/1450.png`` ends in, None if in none."""
    found = TILE_PATH.search(path.absolute().as_posix())
    if found is None:
        return None
    z, x, y = (int(number) for number in found.groups())
    return (z, x, y) if z <= 30 and max(x, y) < 2**z else None


def with_tile(raster: Raster, tile: Tile, name: str) -> Raster:
    """Return `raster` in the place of a tile, whose cells its samples are the middles of."""
    if raster.step is not None:
        raise InputError(f"expected a file without a place of its own with tile=, got {name}")
    z, x, y = tile
    rows, columns = raster.values.shape
    half = math.pi * WGS84.axis
    side = 2 * half / 2**z
    step = side / columns, side / rows
    origin = x * side - half + step[0] / 2, half - y * side - step[1] / 2
    return replace(raster, step=step, origin=origin, system=SYSTEM, geographic=geographic)
