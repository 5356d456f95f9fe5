"""Where the samples of a ground stand on the Earth: from its CRS to WGS 84, and back."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ..errors import InputError, MissingExtraError
from .ellipsoid import AXIS, Floats

Transform = Callable[[Floats, Floats], tuple[Floats, Floats]]

# what `load` calls lengths that were degrees, or a stretched map, before
_LOCAL: Final = re.compile(
    r'LOCAL_CS\["(?:degrees(?: of (?P<degrees>\S+))?|(?P<map>\S+)) '
    r"times (?P<east>[-+.\deE]+) east, (?P<north>[-+.\deE]+) north\""
)
# geographic systems that are within a metre or two of WGS 84 all over the Earth
_DEGREES: Final = ("EPSG:4326", "EPSG:4979", "EPSG:4269", "EPSG:4258", "OGC:CRS84", "CRS84")
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
            from pyproj.exceptions import CRSError
        except ImportError:
            raise MissingExtraError(
                f"expected pyproj for ground in {crs[:60]}, got none: "
                "pip install 'terrain_lod[tiles]'"
            ) from None
        try:
            there = Transformer.from_crs(crs, "EPSG:4326", always_xy=True)
        except CRSError as error:
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
    return np.degrees(x / AXIS), np.degrees(np.arctan(np.sinh(y / AXIS)))


def _to_mercator(longitude: Floats, latitude: Floats) -> tuple[Floats, Floats]:
    return np.radians(longitude) * AXIS, AXIS * np.arcsinh(np.tan(np.radians(latitude)))
