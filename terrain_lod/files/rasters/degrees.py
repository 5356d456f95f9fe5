"""Longitude and latitude, flattened to local metres.

Heights stay as they are, so vertical errors mean what they say; only the distances between the
samples are those of one latitude, the middle one.
"""

from __future__ import annotations

import logging
import math
from typing import Final

from ...errors import InputError

# WGS 84: semi-major axis in metres and squared eccentricity
AXIS: Final = 6_378_137.0
ECCENTRICITY_2: Final = 0.00669437999014
# east-west lengths at the edges may differ from those in the middle by this part
TOLERANCE: Final = 0.05

log = logging.getLogger(__name__)


def metres_per_degree(latitude: float) -> tuple[float, float]:
    """Return the length in metres of a degree of longitude and of latitude at `latitude`.

    With e the eccentricity, W^2 = 1 - e^2 sin^2(latitude), the radius of the parallel is
    a cos(latitude) / W and that of the meridian's curvature a (1 - e^2) / W^3.
    """
    phi = math.radians(latitude)
    w = math.sqrt(1 - ECCENTRICITY_2 * math.sin(phi) ** 2)
    east = AXIS * math.cos(phi) / w
    north = AXIS * (1 - ECCENTRICITY_2) / w**3
    return math.radians(east), math.radians(north)


def local_metres(
    step: tuple[float, float], north: float, rows: int, name: str
) -> tuple[float, float]:
    """Return the spacing in metres of a raster in degrees, at its middle latitude.

    Parameters
    ----------
    step : (float, float)
        Degrees between samples along longitude and latitude.
    north : float
        Latitude of the first row.
    rows : int
        Number of rows, southwards.
    name : str
        Of the file, for messages.

    Raises
    ------
    InputError
        If the raster is so tall that a flat grid of metres would be off by more than 5 % east to
        west at its northern or southern edge.
    """
    south = north - (rows - 1) * step[1]
    middle = (north + south) / 2
    east, up = metres_per_degree(middle)
    off = max(abs(metres_per_degree(edge)[0] / east - 1) for edge in (north, south))
    if off > TOLERANCE:
        raise InputError(
            f"expected {name}, in degrees, to fit a flat grid of metres to {TOLERANCE:.0%}, got "
            f"{off:.0%} from latitude {south:g} to {north:g}: reproject it, or give spacing="
        )
    spacing = step[0] * east, step[1] * up
    log.info(
        "%s is in degrees: made local metres at latitude %.4f, %.3f m x %.3f m between samples; "
        "east-west lengths at its edges are off by %.2g %%",
        name, middle, *spacing, 100 * off,
    )  # fmt: skip
    return spacing
