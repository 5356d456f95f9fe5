"""Which part of the Earth a tile covers, and where the lines of its lattice run.

Tile (z, x, y) of every scheme is one of the four that cover tile (z - 1, x // 2, y // 2); x counts
eastwards and y northwards, as in the Tile Map Service of the OSGeo. Within a tile longitude and
latitude run evenly from edge to edge, as clients of quantized-mesh take them to.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ..errors import InputError
from .ellipsoid import Floats

Tile = tuple[int, int, int]
"""z, x, y."""

Bounds = tuple[float, float, float, float]
"""West, south, east, north in degrees."""

# the square map of the web ends here, degrees
MERCATOR_LATITUDE = math.degrees(math.atan(math.sinh(math.pi)))


class Scheme(Protocol):
    """How the Earth, or a part of it, is cut into tiles."""

    @property
    def roots(self) -> int:
        """Tiles of level 0, side by side."""

    def longitude(self, z: int, x: int) -> float:
        """Return the western edge of column x."""

    def latitude(self, z: int, y: int) -> float:
        """Return the southern edge of row y."""


@dataclass(frozen=True)
class Geographic:
    """TMS in degrees: two tiles of 180 x 180 degrees."""

    roots: int = 2

    def longitude(self, z: int, x: int) -> float:
        return -180.0 + x * (180.0 / (1 << z))

    def latitude(self, z: int, y: int) -> float:
        return -90.0 + y * (180.0 / (1 << z))


@dataclass(frozen=True)
class Mercator:
    """TMS on the square map of the web, EPSG:3857."""

    roots: int = 1

    def longitude(self, z: int, x: int) -> float:
        return -180.0 + x * (360.0 / (1 << z))

    def latitude(self, z: int, y: int) -> float:
        return math.degrees(math.atan(math.sinh(math.pi * (2 * y / (1 << z) - 1))))


@dataclass(frozen=True)
class Region:
    """A rectangle of degrees and its quarters: the regions of implicit tiling in 3D Tiles."""

    bounds: Bounds
    roots: int = 1

    def longitude(self, z: int, x: int) -> float:
        west, _, east, _ = self.bounds
        return west + (east - west) * (x / (1 << z))

    def latitude(self, z: int, y: int) -> float:
        _, south, _, north = self.bounds
        return south + (north - south) * (y / (1 << z))


def bounds_of(scheme: Scheme, tile: Tile) -> Bounds:
    z, x, y = tile
    west, east = scheme.longitude(z, x), scheme.longitude(z, x + 1)
    return west, scheme.latitude(z, y), east, scheme.latitude(z, y + 1)


def lines(scheme: Scheme, tile: Tile, cells: int) -> tuple[Floats, Floats]:
    """Return the longitudes and latitudes of a tile's lattice; (cells + 1,) each.

    The last line of a tile is the first of the next one, to the bit.
    """
    west, south, east, north = bounds_of(scheme, tile)
    share = np.arange(cells + 1) / cells
    longitudes, latitudes = west + (east - west) * share, south + (north - south) * share
    longitudes[-1], latitudes[-1] = east, north
    return longitudes, latitudes


def tiles_over(scheme: Scheme, z: int, bounds: Bounds) -> tuple[range, range]:
    """Return columns and rows of the tiles of a level that reach into `bounds`."""
    west, south, east, north = bounds

    def first(line: object, value: float, count: int) -> int:
        low, high = 0, count  # the last line not east, or north, of the value
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if line(z, middle) <= value else (low, middle)  # type: ignore[operator]
        return low

    across, down = scheme.roots << z, 1 << z
    columns = range(
        first(scheme.longitude, west, across), first(scheme.longitude, east, across) + 1
    )
    rows = range(first(scheme.latitude, south, down), first(scheme.latitude, north, down) + 1)
    return columns, rows


def require_within(scheme: Scheme, bounds: Bounds) -> None:
    """Say so where ground lies outside what a scheme covers."""
    low, high = scheme.latitude(0, 0), scheme.latitude(0, 1)
    if bounds[1] < low or bounds[3] > high:
        raise InputError(
            f"expected ground from latitude {low:.4f} to {high:.4f} for these tiles, got "
            f"{bounds[1]:.4f} to {bounds[3]:.4f}: choose geographic tiles, or take a part"
        )
