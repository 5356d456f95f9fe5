"""Longitude and latitude, and stretched maps, flattened to local metres.

Heights stay as they are, so vertical errors mean what they say; only the distances between the
samples are those of one place, the middle.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Final

import numpy as np

from ...errors import InputError
from .wkt import WGS84, Ellipsoid

# lengths at the edges may differ from those in the middle by this part
TOLERANCE: Final = 0.05

Pair = tuple[float, float]


def metres_per_degree(latitude: float, ellipsoid: Ellipsoid = WGS84) -> Pair:
    """Return the length in metres of a degree of longitude and of latitude at `latitude`.

    With a the semi-major axis, e the eccentricity and W^2 = 1 - e^2 sin^2(latitude), the radius of
    the parallel is a cos(latitude) / W and that of the meridian's curvature a (1 - e^2) / W^3.
    """
    phi = math.radians(latitude)
    w = math.sqrt(1 - ellipsoid.eccentricity_2 * math.sin(phi) ** 2)
    east = ellipsoid.axis * math.cos(phi) / w
    north = ellipsoid.axis * (1 - ellipsoid.eccentricity_2) / w**3
    return math.radians(east), math.radians(north)


def flat_degrees(
    north: float, south: float, name: str, ellipsoid: Ellipsoid = WGS84
) -> tuple[Pair, float]:
    """Return the metres of a degree in the middle of a raster, and by what part its edges differ.

    Parameters
    ----------
    north, south : float
        Latitudes of the first and the last row, in degrees.
    name : str
        Of the file, for messages.

    Raises
    ------
    InputError
        If the raster is so tall that a flat grid of metres would be off by more than 5 % east to
        west at its northern or southern edge, or reaches beyond a pole.
    """
    if max(abs(north), abs(south)) > 90.01:
        raise InputError(
            f"expected latitudes from -90 to 90 in {name}, got {south:g} to {north:g}: "
            "give spacing= in metres"
        )
    per_degree = metres_per_degree((north + south) / 2, ellipsoid)
    edges = [metres_per_degree(edge, ellipsoid)[0] for edge in (north, south)]
    off = max(abs(edge / per_degree[0] - 1) for edge in edges)
    if off > TOLERANCE:
        tolerance, got = told_apart(TOLERANCE, off)
        raise InputError(
            f"expected {name}, in degrees, to fit a flat grid of metres to {tolerance}, got "
            f"{got} from latitude {south:g} to {north:g}: take a part with bounds=, reproject it, "
            "or give spacing="
        )
    return per_degree, off


def map_stretch(
    geographic: Callable[[float, float], Pair],
    corner: Pair,
    extent: Pair,
    ellipsoid: Ellipsoid = WGS84,
) -> tuple[Pair, float] | None:
    """Return how many metres on the ground a metre of a map is, in the middle of a raster.

    Measured between points a thousandth of the raster apart, at the middle and around the edges.

    Parameters
    ----------
    geographic : callable
        From x and y to longitude and latitude in degrees.
    corner : (float, float)
        x and y of the north-western sample.
    extent : (float, float)
        From there eastwards and southwards, in the unit of x and y.

    Returns
    -------
    ((float, float), float) or None
        Along x and y, and by what part the edges differ from that; None where the map has no
        longitude and latitude.
    """
    half = 5e-4 * max(extent)

    def there(share_x: float, share_y: float) -> Pair:
        x, y = corner[0] + share_x * extent[0], corner[1] - share_y * extent[1]
        points = [geographic(x + dx, y + dy) for dx, dy in
                  ((-half, 0), (half, 0), (0, -half), (0, half))]  # fmt: skip
        if not np.isfinite(points).all() or np.abs(np.array(points)[:, 1]).max() > 90:
            return math.nan, math.nan
        east, north = metres_per_degree(points[0][1] / 2 + points[1][1] / 2, ellipsoid)
        lengths = []
        for (lon, lat), (other_lon, other_lat) in (points[:2], points[2:]):
            turn = (other_lon - lon + 180) % 360 - 180
            lengths.append(math.hypot(turn * east, (other_lat - lat) * north) / (2 * half))
        return lengths[0], lengths[1]

    middle = there(0.5, 0.5)
    shares = (0.0, 0.5, 1.0)
    around = np.array([there(x, y) for x in shares for y in shares])
    if not np.isfinite(middle).all() or min(middle) <= 0:
        return None
    off = np.abs(around / middle - 1)
    return middle, float(np.nanmax(off))


def told_apart(limit: float, value: float) -> tuple[str, str]:
    """Return two shares in percent with as many digits as it takes to tell them apart."""
    for digits in range(12):
        texts = f"{limit:.{digits}%}", f"{value:.{digits}%}"
        if texts[0] != texts[1]:
            break
    return texts
