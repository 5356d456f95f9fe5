"""Grids of text: ESRI's ASCII grids and those of GRASS."""

from __future__ import annotations

import codecs
import math
import re
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from ...errors import FileError, InputError
from .limits import require_memory
from .parts import Part
from .raster import Raster
from .wkt import DEGREE, System, system_of

ESRI: Final = re.compile(
    r"\s*(ncols|nrows|[xy]ll(?:corner|center|centre)|cellsize|dx|dy|nodata_value|nodata)\s+(\S+)",
    re.IGNORECASE,
)
GRASS: Final = re.compile(
    r"\s*(north|south|east|west|rows|cols|null|type|multiplier)\s*:\s*(\S+)", re.IGNORECASE
)
NODATA: Final = -9999.0  # where ESRI's header has none
# degrees, minutes, seconds and a quarter of the globe, as GRASS writes longitude and latitude
DEGREES: Final = re.compile(
    r"(-?\d+(?:\.\d*)?)(?::(\d+(?:\.\d*)?))?(?::(\d+(?:\.\d*)?))?([NSEW]?)$"
)

Header = dict[str, str]


def read_asc(path: Path, part: Part) -> Raster:
    """Read a grid of text; a .prj file beside it names the coordinate reference system."""
    part.require_one_band(path.name)
    # text and numbers stand in memory at the same time; a number takes two characters at least
    require_memory(1, path.stat().st_size // 2, np.float64, path.name, "less of the file")
    text = _text(path.read_bytes())
    grass = GRASS.match(text) is not None
    header: Header = {}
    start = 0
    while entry := (GRASS if grass else ESRI).match(text, start):
        header[entry[1].lower().replace("centre", "center")] = entry[2]
        start = entry.end()
    raster = (_grass if grass else _esri)(header, text[start:], path.name)
    prj = path.with_suffix(".prj")
    if prj.is_file():
        system = system_of(_text(prj.read_bytes()).strip())
        raster = Raster(**(vars(raster) | {"system": system}))
    return part.cut(raster, path.name)


def _text(data: bytes) -> str:
    """Return what a file says, without the mark that some editors put in front."""
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return data.decode("utf-16")
    return data.removeprefix(codecs.BOM_UTF8).decode("latin-1")


def _esri(header: Header, text: str, name: str) -> Raster:
    number = _numbers_of(header, name)
    rows, columns = _extent(header, "nrows", name), _extent(header, "ncols", name)
    dx, dy = number("dx", "cellsize"), number("dy", "cellsize")
    # a corner is the corner of a cell, half a cell from the sample in its middle
    west = number("xllcenter", "xllcorner") + (0 if "xllcenter" in header else dx / 2)
    south = number("yllcenter", "yllcorner") + (0 if "yllcenter" in header else dy / 2)
    _require_positive(dx, dy, name)
    nodata = next((key for key in ("nodata_value", "nodata") if key in header), None)
    return Raster(
        _values(text, rows, columns, name),
        (dx, dy),
        (west, south + (rows - 1) * dy),
        NODATA if nodata is None else number(nodata),
    )


def _grass(header: Header, text: str, name: str) -> Raster:
    """Read what ``r.out.ascii`` of GRASS writes: edges of the outer cells, null as ``*``."""
    number = _numbers_of(header, name)
    rows, columns = _extent(header, "rows", name), _extent(header, "cols", name)
    north, south, east, west = (number(key) for key in ("north", "south", "east", "west"))
    dx, dy = (east - west) / columns, (north - south) / rows
    _require_positive(dx, dy, name)
    null = header.get("null", "*")
    if not _is_number(null):
        text = re.sub(rf"(?<!\S){re.escape(null)}(?!\S)", "nan", text)
        null = "nan"
    degrees = any(":" in header[key] or header[key][-1] in "NSEW" for key in ("north", "west"))
    return Raster(
        _values(text, rows, columns, name),
        (dx, dy),
        (west + dx / 2, north - dy / 2),
        None if null == "nan" else float(null),
        scale=number("multiplier") if "multiplier" in header else 1.0,
        system=System(angle=DEGREE) if degrees else System(),
    )


def _numbers_of(header: Header, name: str) -> Callable[..., float]:
    """Return what finds the number of the first of some keys that a header has."""

    def number(*keys: str) -> float:
        for key in keys:
            if key in header:
                return _number(header[key], key, name)
        raise InputError(f"expected {' or '.join(keys)} in the header of {name}, got none")

    return number


def _number(word: str, key: str, name: str) -> float:
    parts = DEGREES.match(word.upper())
    if parts is not None and (parts[2] or parts[4]):
        whole, minutes, seconds = (float(part or 0) for part in parts.groups()[:3])
        value = math.copysign(abs(whole) + minutes / 60 + seconds / 3600, whole)
        return -value if parts[4] in ("S", "W") else value
    try:
        return float(word)
    except ValueError:
        raise FileError(f"expected a number for {key} in {name}, got {word[:40]!r}") from None


def _extent(header: Header, key: str, name: str) -> int:
    if key not in header:
        raise InputError(f"expected {key} in the header of {name}, got none")
    number = _number(header[key], key, name)
    if not (math.isfinite(number) and number == int(number) and 1 <= number < 2**31):
        raise FileError(f"expected a whole number above 0 for {key} in {name}, got {number:g}")
    return int(number)


def _require_positive(dx: float, dy: float, name: str) -> None:
    if not (math.isfinite(dx) and math.isfinite(dy) and min(dx, dy) > 0):
        raise InputError(f"expected spacing > 0 in the header of {name}, got {dx:g} x {dy:g}")


def _values(text: str, rows: int, columns: int, name: str) -> npt.NDArray[np.float64]:
    values = _numbers(text, name)
    if values.size != rows * columns:
        raise FileError(
            f"expected {rows} x {columns} = {rows * columns} heights in {name}, "
            f"got {values.size}: truncated?"
        )
    return values.reshape(rows, columns)


def _numbers(text: str, name: str) -> npt.NDArray[np.float64]:
    """Return the numbers in `text`, which holds nothing else."""
    with warnings.catch_warnings():
        # older numpy only warns where a word is no number
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, np.float64, sep=" ")
        except (ValueError, DeprecationWarning):
            pass
    word = next((word for word in text.split() if not _is_number(word)), "")
    raise InputError(f"expected only numbers after the header of {name}, got {word[:40]!r}")


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
