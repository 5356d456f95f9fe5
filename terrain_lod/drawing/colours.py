"""What colour the ground is: by height and slope, by sunlight, by level of detail.

Colours are red, green, blue in 0..1 as screens take them (sRGB); light is added up in linear
intensity and turned back, as eyes expect.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Final

import numpy as np
import numpy.typing as npt

Colours = npt.NDArray[np.float32]
"""(N, 3) red, green, blue in 0..1."""

Stops = tuple[tuple[float, float, float, float], ...]
"""Rows of position, red, green, blue; positions rise."""

# Numbers from the lowest to the highest, in steps that the eye sees as equal, by lightness alone
# too: viridis and inferno of matplotlib (Smith, van der Walt and Firing, 2015; CC0).
LOD_STOPS: Final[Stops] = (
    (0.000, 0.267, 0.005, 0.329),
    (0.125, 0.279, 0.175, 0.483),
    (0.250, 0.230, 0.322, 0.546),
    (0.375, 0.173, 0.449, 0.558),
    (0.500, 0.128, 0.567, 0.551),
    (0.625, 0.158, 0.684, 0.502),
    (0.750, 0.369, 0.789, 0.383),
    (0.875, 0.678, 0.864, 0.190),
    (1.000, 0.993, 0.906, 0.144),
)
HEAT_STOPS: Final[Stops] = (
    (0.000, 0.001, 0.000, 0.014),
    (0.125, 0.129, 0.047, 0.291),
    (0.250, 0.342, 0.062, 0.429),
    (0.375, 0.541, 0.135, 0.415),
    (0.500, 0.736, 0.216, 0.330),
    (0.625, 0.894, 0.353, 0.194),
    (0.750, 0.978, 0.558, 0.035),
    (0.875, 0.975, 0.798, 0.206),
    (1.000, 0.988, 0.998, 0.645),
)
# Far below, on, far above: blue and red, which few take for each other, in equal steps of OKLab
# lightness (Ottosson, 2020) from either end to the middle.
ERROR_STOPS: Final[Stops] = (
    (0.000, 0.091, 0.287, 0.590),
    (0.125, 0.186, 0.436, 0.835),
    (0.250, 0.417, 0.615, 0.930),
    (0.375, 0.700, 0.790, 0.925),
    (0.500, 0.960, 0.960, 0.950),
    (0.625, 0.928, 0.730, 0.683),
    (0.750, 0.903, 0.472, 0.391),
    (0.875, 0.782, 0.230, 0.145),
    (1.000, 0.549, 0.119, 0.048),
)

# Land by height, from lowland to snow.
LAND_STOPS: Final[Stops] = (
    (0.00, 0.42, 0.52, 0.38),
    (0.20, 0.56, 0.62, 0.42),
    (0.42, 0.74, 0.69, 0.50),
    (0.65, 0.67, 0.56, 0.44),
    (0.85, 0.75, 0.70, 0.65),
    (1.00, 0.93, 0.92, 0.92),
)
# where each of them is on the Earth: metres above the sea
_LAND_METRES: Final = (0.0, 250.0, 900.0, 2000.0, 3200.0, 4800.0)
# of the range of tints, what land of any relief is given, and the most where the sea is unknown
_LEAST_SPAN, _SNOWLESS = 0.4, 0.85
# Shore to the deepest water.
WATER_STOPS: Final[Stops] = ((0.00, 0.47, 0.64, 0.74), (1.00, 0.20, 0.34, 0.52))
_ROCK: Final = (0.50, 0.46, 0.42)

# of the light on ground that faces the sun: the sun's share, and the sky's from straight above
_SUN: Final = (1.00, 0.95, 0.86)
_SKY: Final = (0.30, 0.36, 0.44)

# of an open sky where it is known what hides it, in skies; and how fast light falls as it is hidden
_OPEN_SKY, _DEPTH = 1.25, 2.0

_GAMMA: Final = 2.2
_STEPS: Final = 1024  # of a ramp that is looked up


def ramp(stops: Stops, positions: npt.NDArray[np.float32]) -> Colours:
    """Return the colour at each position (N,), interpolated between `stops`."""
    at, *channels = np.asarray(stops, np.float32).T
    colours = [np.interp(positions, at, channel) for channel in channels]
    return np.stack(colours, axis=-1).astype(np.float32)


def _quick_ramp(stops: Stops, positions: npt.NDArray[np.float32]) -> Colours:
    """Return the colour at each position (N,) as :func:`ramp` does, to a thousandth."""
    steps = np.clip(positions * _STEPS, 0, _STEPS).astype(np.intp)
    return _table(stops).take(steps, axis=0)


@cache
def _table(stops: Stops) -> Colours:
    return ramp(stops, np.linspace(0, 1, _STEPS + 1, dtype=np.float32))


def land_stops(low: float, high: float, metres: float | None) -> Stops:
    """Return the tints of land between two elevations, positions from one to the other.

    Parameters
    ----------
    low, high : float
    metres : float or None
        The unit of elevations above the sea: tints are then those of maps, whatever the range, so
        that only what is as high as snow is white. None where nobody knows where the sea is.
    """
    first, last = 0.0, _SNOWLESS
    at = np.linspace(0.0, 1.0, 33)
    shares = first + at * (last - first)
    if metres is not None:
        stops = [stop[0] for stop in LAND_STOPS]
        heights = metres * (low + at * (high - low))
        shares = np.interp(heights, _LAND_METRES, stops)
        # low relief is told apart, too: around its own tint, and never into snow
        lack = _LEAST_SPAN - float(shares[-1] - shares[0])
        if lack > 0:
            top = max(float(shares[-1]), min(float(shares[-1]) + lack / 2, _SNOWLESS))
            bottom = max(0.0, top - _LEAST_SPAN)
            shares = bottom + at * (min(1.0, bottom + _LEAST_SPAN) - bottom)
    colours = ramp(LAND_STOPS, shares.astype(np.float32)).tolist()
    return tuple((float(x), r, g, b) for x, (r, g, b) in zip(at, colours, strict=True))


def height_stops(height_range: tuple[float, float], metres: float | None) -> Stops:
    """Return the tints that :func:`hypsometric` gives level ground, as a colour bar shows them."""
    low, high = height_range
    if not low <= 0 < high:
        return land_stops(low, high, metres)
    shore = -low / (high - low)
    water = tuple(
        (shore * (1 - deep), red, green, blue) for deep, red, green, blue in reversed(WATER_STOPS)
    )
    land = tuple(
        (shore + at * (1 - shore), red, green, blue)
        for at, red, green, blue in land_stops(0.0, high, metres)
    )
    return (*water, *land) if low < 0 else land


def hypsometric(
    elevations: npt.NDArray[np.float32],
    normals: npt.NDArray[np.float32],
    height_range: tuple[float, float],
    metres: float | None = None,
) -> Colours:
    """Return the tint of ground: by height, bare rock where it is steep, blue where it is sea.

    Parameters
    ----------
    elevations : (N,) float32
        Up to 0 is sea, where the range reaches above it.
    normals : (N, 3) float32
        Unit normals, z up.
    height_range : (float, float)
        Elevations of the lowest and the highest tint.
    metres : float, optional
        As for :func:`land_stops`.
    """
    low, high = height_range
    shore = 0.0 if low <= 0 < high else low
    stops = land_stops(shore, high, metres)
    land = _quick_ramp(stops, (elevations - shore) / max(high - shore, 1e-30))
    # rock shows from 27 degrees on, and alone from 53
    land = mixed(land, np.clip((0.9 - normals[:, 2]) / 0.3, 0.0, 1.0), _ROCK)
    if not low <= 0 < high:
        return land
    sea = _quick_ramp(WATER_STOPS, elevations / min(low, -1e-30))
    return np.where(elevations[:, None] <= 0, sea, land)


def sun_direction(azimuth: float, elevation: float) -> npt.NDArray[np.float32]:
    """Return the unit vector towards the sun.

    Parameters
    ----------
    azimuth : float
        Degrees clockwise from north.
    elevation : float
        Degrees above the horizon.
    """
    turn, rise = math.radians(azimuth), math.radians(elevation)
    horizontal = math.cos(rise)
    return np.array(
        [horizontal * math.sin(turn), horizontal * math.cos(turn), math.sin(rise)], np.float32
    )


def facing(
    normals: npt.NDArray[np.float32], sun: npt.NDArray[np.float32]
) -> npt.NDArray[np.float32]:
    """Return the cosine between normals (N, 3) and the sun, 0 where they face away from it.

    Without a matrix product: after one, the threads of NumPy's BLAS wait for the next in a busy
    loop, on the cores that kernels and drawing want.
    """
    x, y, z = normals.T
    light: npt.NDArray[np.float32] = sun[0] * x
    light += sun[1] * y
    light += sun[2] * z
    np.maximum(light, 0.0, out=light)
    return light


def lit(
    colours: Colours,
    normals: npt.NDArray[np.float32],
    sun: npt.NDArray[np.float32],
    sky: npt.NDArray[np.float32] | None = None,
) -> Colours:
    """Return `colours` (N, 3) under sun and sky: Lambert's cosine, and more sky from above.

    With the share of its light that a sky gives each (N,), there is more of it where it is whole,
    and little where it is not: what is lit from valley to valley is lit twice.
    """
    facing_sun = facing(normals, sun)
    facing_sky = 0.5 + 0.5 * normals[:, 2]
    if sky is not None:
        facing_sky *= np.float32(_OPEN_SKY) * sky**_DEPTH
    seen = np.empty(colours.shape, np.float32)
    # a channel at a time: rows of three are slow
    for channel, (of_sun, of_sky) in enumerate(zip(_SUN, _SKY, strict=True)):
        light = np.float32(of_sun) * facing_sun + np.float32(of_sky) * facing_sky
        # the gamma-th root of (colour to the gamma times light)
        np.multiply(colours[:, channel], light ** (1 / _GAMMA), out=seen[:, channel])
    return np.minimum(seen, 1.0, out=seen)


def mixed(colours: Colours, share: npt.NDArray[np.float32], other: tuple[float, ...]) -> Colours:
    """Return `colours` (N, 3) with a `share` (N,) in 0..1 of one `other` colour in each."""
    mixture = np.empty(colours.shape, np.float32)
    for channel, value in enumerate(other):
        own = colours[:, channel]
        mixture[:, channel] = own + share * (np.float32(value) - own)
    return mixture


def to_bytes(colours: Colours) -> npt.NDArray[np.uint8]:
    """Return colours in 0..1 as bytes."""
    return np.round(colours * 255).astype(np.uint8)
