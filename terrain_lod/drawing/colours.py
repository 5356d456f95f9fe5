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

# Detail of a patch, 0 the lowest of its LOD and 1 the highest: the code of figures 9.11 and 9.22,
# black, blue, green, red, with the yellow and orange between its last two.
# cells of a segment that are shown as black
LONGEST: Final = 64.0
LOD_STOPS: Final[Stops] = (
    (0.00, 0.00, 0.00, 0.00),
    (0.25, 0.08, 0.22, 0.90),
    (0.50, 0.10, 0.75, 0.20),
    (0.75, 0.98, 0.85, 0.10),
    (1.00, 0.90, 0.08, 0.08),
)

# Lowland to summit, 0 the lowest land of the picture and 1 the highest.
LAND_STOPS: Final[Stops] = (
    (0.00, 0.42, 0.52, 0.38),
    (0.20, 0.56, 0.62, 0.42),
    (0.42, 0.74, 0.69, 0.50),
    (0.65, 0.67, 0.56, 0.44),
    (0.85, 0.75, 0.70, 0.65),
    (1.00, 0.90, 0.88, 0.86),
)
# Shore to the deepest water.
WATER_STOPS: Final[Stops] = ((0.00, 0.47, 0.64, 0.74), (1.00, 0.20, 0.34, 0.52))
_ROCK: Final = (0.50, 0.46, 0.42)

# of the light on ground that faces the sun: the sun's share, and the sky's from straight above
_SUN: Final = (1.00, 0.95, 0.86)
_SKY: Final = (0.30, 0.36, 0.44)

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


def lod_colours(factors: npt.ArrayLike, factor_range: tuple[float, float]) -> Colours:
    """Return the colour of tessellation factors (P,): black lowest, then blue, green, red.

    Parameters
    ----------
    factors : (P,) array_like
    factor_range : (float, float)
        The lowest and the highest factor that the LOD gives.
    """
    low, high = factor_range
    return ramp(LOD_STOPS, (np.asarray(factors, np.float32) - low) / (high - low))


def segment_colours(cells: npt.ArrayLike) -> Colours:
    """Return the colour of segments that span so many cells (P,): red one, black the longest."""
    octaves = np.log2(np.maximum(np.asarray(cells, np.float32), 1e-3))
    return ramp(LOD_STOPS, 1.0 - octaves / np.log2(LONGEST))


def hypsometric(
    elevations: npt.NDArray[np.float32],
    normals: npt.NDArray[np.float32],
    height_range: tuple[float, float],
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
    """
    low, high = height_range
    shore = 0.0 if low <= 0 < high else low
    land = _quick_ramp(LAND_STOPS, (elevations - shore) / max(high - shore, 1e-30))
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
    colours: Colours, normals: npt.NDArray[np.float32], sun: npt.NDArray[np.float32]
) -> Colours:
    """Return `colours` (N, 3) under sun and sky: Lambert's cosine, and more sky from above."""
    facing_sun = facing(normals, sun)
    facing_sky = 0.5 + 0.5 * normals[:, 2]
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
