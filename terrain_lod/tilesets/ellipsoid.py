"""The ellipsoid WGS 84: from longitude, latitude and height to earth-centred metres.

The x axis leaves the Earth at 0 N 0 E, z at the north pole. With a the semi-major axis, e the
eccentricity and N = a / sqrt(1 - e^2 sin^2 latitude), a point of height h above the ellipsoid is

::

    x = (N + h) cos latitude cos longitude
    y = (N + h) cos latitude sin longitude
    z = (N (1 - e^2) + h) sin latitude

IOGP Guidance Note 7-2, section 4.1.1. The normal points along (cos cos, cos sin, sin) of the two
angles, and heights are lengths along it.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

AXIS: Final = 6378137.0
POLAR_AXIS: Final = 6356752.314245179
ECCENTRICITY_2: Final = 1 - (POLAR_AXIS / AXIS) ** 2

Floats = npt.NDArray[np.float64]


def upwards(longitude: Floats, latitude: Floats) -> Floats:
    """Return the ellipsoid's normals at places in degrees; (..., 3)."""
    lon, lat = np.radians(longitude), np.radians(latitude)
    level = np.cos(lat)
    return np.stack([level * np.cos(lon), level * np.sin(lon), np.sin(lat)], axis=-1)


def on_ellipsoid(up: Floats) -> Floats:
    """Return the earth-centred points of the ellipsoid that have these normals; (..., 3)."""
    scaled = up * np.array([1.0, 1.0, 1 - ECCENTRICITY_2])
    prime = AXIS / np.sqrt(1 - ECCENTRICITY_2 * up[..., 2:] ** 2)
    return np.asarray(prime * scaled)


def earth_centred(longitude: Floats, latitude: Floats, height: Floats) -> Floats:
    """Return earth-centred points in metres; (..., 3)."""
    up = upwards(longitude, latitude)
    return on_ellipsoid(up) + height[..., None] * up


def radii(latitude: Floats) -> tuple[Floats, Floats]:
    """Return how fast one moves east and north, in metres a degree, at a latitude."""
    lat = np.radians(latitude)
    w = np.sqrt(1 - ECCENTRICITY_2 * np.sin(lat) ** 2)
    return np.radians(AXIS * np.cos(lat) / w), np.radians(AXIS * (1 - ECCENTRICITY_2) / w**3)


def bulge(longitude: Floats, latitude: Floats, middle: tuple[float, float]) -> Floats:
    """Return how far the ellipsoid has fallen away from its tangent plane, to second order.

    A straight line between two points of it runs below it by what this is from being straight. Of
    a degree of longitude that is cos^2 of the latitude times what it is of one of latitude.
    """
    lat = np.radians(latitude)
    east = np.radians(longitude - middle[0]) * np.cos(lat)
    north = lat - np.radians(middle[1])
    return np.asarray(AXIS / 2 * (east**2 + north**2))
