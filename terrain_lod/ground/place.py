"""Where the samples of a ground stand on the Earth: from its CRS to WGS 84, and back."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..errors import InputError, MissingExtraError

Floats = npt.NDArray[np.float64]
Transform = Callable[[Floats, Floats], tuple[Floats, Floats]]

# what `load` calls lengths that were degrees, or a stretched map, before
_LOCAL: Final = re.compile(
    r'LOCAL_CS\["(?:degrees(?: of (?P<degrees>\S+))?|(?P<map>\S+)) '
    r"times (?P<east>[-+.\deE]+) east, (?P<north>[-+.\deE]+) north\""
)
# geographic systems that are within a metre or two of WGS 84 all over the Earth
_DEGREES: Final = ("EPSG:4326", "EPSG:4979", "EPSG:4269", "EPSG:4258", "OGC:CRS84", "CRS84")
_AXIS: Final = 6378137.0  # of the ellipsoid, metres
_LONGEST_NAME: Final = 30  # of a CRS that is said; others are WKT
_MERCATOR: Final = ("EPSG:3857", "EPSG:900913", "EPSG:102100")


@dataclass(frozen=True)
class Place:
    """A map, and how its numbers become longitude and latitude in degrees.

    Attributes
    ----------
    crs : str
        As the ground has it.
    name : str
        What it is called.
    to_degrees, from_degrees : callable
        From two arrays to two of the same shape.
    """

    crs: str
    name: str
    to_degrees: Transform
    from_degrees: Transform

    @classmethod
    def of(cls, crs: str | None) -> Place:
        """Return what a ground's CRS says.

        Raises
        ------
        InputError
            If there is none, or PROJ does not know it.
        MissingExtraError
            If it needs pyproj and that is not installed.
        """
        if crs is None:
            raise InputError(
                "expected ground that says where on the Earth it is, got none with a CRS: name it "
                "with crs= (--crs EPSG:32632)"
            )
        local = _LOCAL.match(crs)
        if local is None:
            return cls._named(crs)
        scale = float(local["east"]), float(local["north"])
        if local["map"] is None:
            known = local["degrees"] or "EPSG:4326"
        elif local["map"] == "CRS":
            raise InputError("expected a CRS with a code, got one without: name it with crs=")
        else:
            known = local["map"]
        inner = cls._named(known)
        return cls(
            crs,
            known,
            lambda x, y: inner.to_degrees(x / scale[0], y / scale[1]),
            lambda lon, lat: _times(inner.from_degrees(lon, lat), scale),
        )

    def __reduce__(self) -> tuple[Callable[[str], Place], tuple[str]]:
        # functions of PROJ are made anew where this is sent to
        return Place.of, (self.crs,)

    @classmethod
    def _named(cls, crs: str) -> Place:
        if crs.upper() in _DEGREES:
            return cls(crs, crs, _same, _same)
        if crs.upper() in _MERCATOR:
            return cls(crs, crs, _from_mercator, _to_mercator)
        try:
            from pyproj import Transformer
            from pyproj.exceptions import ProjError
        except ImportError:
            raise MissingExtraError(
                f"expected pyproj for ground in {crs[:60]}, got none: "
                "pip install 'terrain_lod[geo]'"
            ) from None
        try:
            there = Transformer.from_crs(crs, "EPSG:4326", always_xy=True)
        except ProjError as error:
            reason = " ".join(str(error).split())[:200]
            raise InputError(
                f"expected a CRS that PROJ knows, got {crs[:60]!r}: {reason}"
            ) from None

        def transform(direction: str) -> Transform:
            def apply(x: Floats, y: Floats) -> tuple[Floats, Floats]:
                made: Any = there.transform(x, y, direction=direction)
                return np.asarray(made[0], np.float64), np.asarray(made[1], np.float64)

            return apply

        return cls(crs, crs, transform("FORWARD"), transform("INVERSE"))


def _same(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    return x, y


def _times(pair: tuple[Floats, Floats], scale: tuple[float, float]) -> tuple[Floats, Floats]:
    return pair[0] * scale[0], pair[1] * scale[1]


def _from_mercator(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    return np.degrees(x / _AXIS), np.degrees(np.arctan(np.sinh(y / _AXIS)))


def _to_mercator(longitude: Floats, latitude: Floats) -> tuple[Floats, Floats]:
    return np.radians(longitude) * _AXIS, _AXIS * np.arcsinh(np.tan(np.radians(latitude)))


def degrees_of(crs: str | None, x: float, y: float) -> tuple[float, float] | None:
    """Return longitude and latitude of a place in a ground's CRS; None where nobody can say."""
    try:
        made = Place.of(crs).to_degrees(np.array([x]), np.array([y]))
    except (InputError, MissingExtraError):
        return None
    longitude, latitude = (float(value[0]) for value in made)
    return (longitude, latitude) if math.isfinite(longitude + latitude) else None


def said_in_degrees(crs: str | None, x: float, y: float, digits: int = 3) -> str | None:
    """Return a place in a ground's CRS as people say it, ``47.123° N, 10.456° E``, or None."""
    place = degrees_of(crs, x, y)
    if place is None:
        return None
    longitude, latitude = place
    north, east = ("N" if latitude >= 0 else "S"), ("E" if longitude >= 0 else "W")
    return f"{abs(latitude):.{digits}f}° {north}, {abs(longitude):.{digits}f}° {east}"


def said_place(crs: str | None, x: float, y: float, unit: str) -> tuple[str, ...]:
    """Return where a place is: in degrees if that is known, and as the raster's own map has it.

    Lengths that were made of degrees, or of a stretched map, are nobody's coordinates: the numbers
    that they were made of are said.
    """
    degrees = said_in_degrees(crs, x, y, digits=5)
    local = None if crs is None else _LOCAL.match(crs)
    if local is not None:
        x, y = x / float(local["east"]), y / float(local["north"])
        if local["map"] is None:
            return (degrees or f"{x:.6f}, {y:.6f} degrees",)
        crs = local["map"]
    own = f"x {x:,.1f}, y {y:,.1f}"
    if crs is None:
        return (f"{own} {unit}",)
    named = f"{own} in {crs}" if len(crs) < _LONGEST_NAME else f"{own} {unit}"
    return (degrees, named) if degrees else (named,)
