"""What a coordinate reference system says of itself: units, ellipsoid, its horizontal part.

Well-known text of both kinds, WKT 1 as GDAL and ESRI write it and WKT 2 (ISO 19162), is a tree of
``KEYWORD[item, item, ...]``, read here as that and no more.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Final

from ...ground.units import Unit, unit_called, unit_of_length


@dataclass(frozen=True)
class Angle:
    """A unit of longitude and latitude: its name, and its size in degrees."""

    name: str
    degrees: float


@dataclass(frozen=True)
class Ellipsoid:
    """A figure of a planet: its semi-major axis in metres and its squared eccentricity."""

    axis: float = 6_378_137.0
    eccentricity_2: float = 0.00669437999014


DEGREE: Final = Angle("degree", 1.0)
WGS84: Final = Ellipsoid()


@dataclass(frozen=True)
class System:
    """A coordinate reference system.

    Attributes
    ----------
    crs : str or None
        Its authority code or WKT; None if a file names none.
    horizontal : str or None
        The same without heights, where `crs` has them.
    angle : Angle or None
        The unit of x and y if they are longitude and latitude.
    unit : Unit or None
        The unit of x and y if they are lengths; None if that is not said.
    height_unit : Unit or None
        The unit of heights; None if that is not said.
    ellipsoid : Ellipsoid
    """

    crs: str | None = None
    horizontal: str | None = None
    angle: Angle | None = None
    unit: Unit | None = None
    height_unit: Unit | None = None
    ellipsoid: Ellipsoid = WGS84


def in_degrees(code: str) -> System:
    """Return the system of longitude and latitude in degrees that has this authority code."""
    return System(code, code, DEGREE)


PROJECTED: Final = ("PROJCS", "PROJCRS", "PROJECTEDCRS")
GEOGRAPHIC: Final = ("GEOGCS", "GEOGCRS", "GEODCRS", "GEOGRAPHICCRS", "GEODETICCRS", "BASEGEOGCRS",
                     "BASEGEODCRS")  # fmt: skip
LOCAL: Final = ("LOCAL_CS", "ENGCRS", "ENGINEERINGCRS")
VERTICAL: Final = ("VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS")
COMPOUND: Final = ("COMPD_CS", "COMPOUNDCRS")
LENGTH, ANGLE = ("UNIT", "LENGTHUNIT"), ("UNIT", "ANGLEUNIT")

# ESRI's own older form: lines of a word and its value
OLD_LINE: Final = re.compile(r"^\s*(Projection|Units|Zunits)\s+(\S+)", re.IGNORECASE | re.MULTILINE)


def system_of(text: str, crs: str | None = None) -> System:
    """Return what well-known text says; `crs` is what it is called, itself if None.

    Text that is not well-known says nothing.
    """
    crs = crs or text
    root = _parsed(text)
    if root is None:
        return _old_system(text)
    projected, geographic = root.first(PROJECTED), root.first(GEOGRAPHIC)
    flat = projected or geographic or root.first(LOCAL)
    if flat is None:
        return System(crs)
    vertical = root.first(VERTICAL)
    # heights of a three-dimensional CRS are the axis with a length among angles
    tall = vertical or (flat if flat is geographic else None)
    angle = _angle(geographic) if flat is geographic and geographic is not None else None
    return System(
        crs,
        _code_of(flat, text) if root.first(COMPOUND) is not None else crs,
        angle,
        None if angle is not None else _length(flat, LENGTH),
        None if tall is None else _length(tall, LENGTH if vertical else ("LENGTHUNIT",)),
        _ellipsoid(flat),
    )


def geographic_part(text: str) -> str | None:
    """Return the text of the geographic system that a WKT 1 projection is built on."""
    root = _parsed(text)
    part = None if root is None else root.first(GEOGRAPHIC[:2])
    return None if part is None else text[part.start : part.stop]


@dataclass
class _Node:
    keyword: str
    start: int
    stop: int = 0
    items: list[_Node | str] = field(default_factory=list)

    def walk(self) -> Iterator[_Node]:
        """Yield this and all below, each before what it holds."""
        rest = [self]
        while rest:
            node = rest.pop()
            yield node
            rest += [item for item in reversed(node.items) if isinstance(item, _Node)]

    def first(self, keywords: tuple[str, ...]) -> _Node | None:
        return next((node for node in self.walk() if node.keyword in keywords), None)

    def child(self, keywords: tuple[str, ...]) -> _Node | None:
        nodes = (item for item in self.items if isinstance(item, _Node))
        return next((node for node in nodes if node.keyword in keywords), None)

    def text(self, place: int) -> str:
        item = self.items[place] if place < len(self.items) else ""
        return item.strip('"') if isinstance(item, str) else ""

    def number(self, place: int) -> float:
        """Return a number among the items, NaN if there is none."""
        try:
            return float(self.text(place))
        except ValueError:
            return math.nan


_TOKEN: Final = re.compile(r'"(?:[^"]|"")*"|[\[\](),]|[^\[\](),"\s]+')


def _parsed(text: str) -> _Node | None:
    """Return the tree of a well-known text, None if it is none."""
    top = _Node("", 0)
    path, word, place = [top], "", 0
    for token in _TOKEN.finditer(text):
        match token[0]:
            case "[" | "(":
                if path[-1].items and path[-1].items[-1] == word:
                    path[-1].items.pop()
                node = _Node(word.upper(), place)
                path[-1].items.append(node)
                path.append(node)
            case "]" | ")":
                if len(path) == 1:
                    return None
                path.pop().stop = token.end()
            case ",":
                pass
            case _:
                word, place = token[0], token.start()
                path[-1].items.append(word)
    nodes = [item for item in top.items if isinstance(item, _Node)]
    return nodes[0] if len(nodes) == 1 and len(path) == 1 else None


def _unit(node: _Node, keywords: tuple[str, ...]) -> tuple[str, float] | None:
    """Return name and size of a node's own unit, or of the first of its axes that has such."""
    axes = [item for item in node.items if isinstance(item, _Node) and item.keyword == "AXIS"]
    for holder in (node, *axes):
        unit = holder.child(keywords)
        if unit is not None and unit.number(1) > 0:
            return unit.text(0), unit.number(1)
    return None


def _length(node: _Node, keywords: tuple[str, ...]) -> Unit | None:
    found = _unit(node, keywords)
    return None if found is None else unit_of_length(*found)


def _angle(node: _Node) -> Angle:
    found = _unit(node, ANGLE)
    if found is None:
        return DEGREE
    degrees = math.degrees(found[1])
    return DEGREE if abs(degrees - 1) < 1e-7 else Angle(found[0], degrees)


def _ellipsoid(node: _Node) -> Ellipsoid:
    figure = node.first(("SPHEROID", "ELLIPSOID"))
    if figure is None or not figure.number(1) > 0:
        return WGS84
    inverse = figure.number(2)
    flattening = 1 / inverse if inverse > 1 else 0.0
    return Ellipsoid(figure.number(1), flattening * (2 - flattening))


def _code_of(node: _Node, text: str) -> str:
    """Return a part's authority code, or its text."""
    code = node.child(("AUTHORITY", "ID"))
    return text[node.start : node.stop] if code is None else f"{code.text(0)}:{code.text(1)}"


def _old_system(text: str) -> System:
    words = {key.lower(): value for key, value in OLD_LINE.findall(text)}
    height_unit = unit_called(words.get("zunits", ""))
    if "projection" not in words:
        return System(text)
    if words["projection"].upper() == "GEOGRAPHIC":
        # DS are decimal seconds
        seconds = words.get("units", "").upper() == "DS"
        angle = Angle("second", 1 / 3600) if seconds else DEGREE
        return System(text, text, angle, height_unit=height_unit)
    return System(text, text, unit=unit_called(words.get("units", "")), height_unit=height_unit)
