"""Units of length: what files and people call them, and how long they are."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Final


@dataclass(frozen=True)
class Unit:
    """A unit of length.

    Attributes
    ----------
    name : str
        As the EPSG dataset has it: ``"metre"``, ``"US survey foot"``.
    symbol : str
        What stands behind a number.
    metres : float
        Its length.
    aliases : tuple of str
        What files call it besides, in lower case, without plural and punctuation.
    """

    name: str
    symbol: str
    metres: float
    aliases: tuple[str, ...] = ()


METRE: Final = Unit("metre", "m", 1.0, ("m", "meter", "mt", "mtr"))
UNITS: Final = (
    METRE,
    Unit("foot", "ft", 0.3048, ("ft", "feet", "international foot", "international feet",
                                "foot international", "feet international", "ft int")),
    Unit("US survey foot", "us-ft", 1200 / 3937, (
        "us ft", "ft us", "ftus", "usft", "sft", "foot us", "feet us", "us foot", "us feet",
        "us survey feet", "survey foot", "survey feet", "foot us survey", "feet us survey",
        "ussurveyfoot", "ussurveyfeet", "u s survey foot", "u s survey feet", "us survey ft")),
    Unit("kilometre", "km", 1000.0, ("km", "kilometer")),
    Unit("decimetre", "dm", 0.1, ("dm", "decimeter")),
    Unit("centimetre", "cm", 0.01, ("cm", "centimeter")),
    Unit("millimetre", "mm", 0.001, ("mm", "millimeter")),
    Unit("yard", "yd", 0.9144, ("yd", "international yard")),
    Unit("fathom", "fathom", 1.8288, ("ftm", "fm")),
    Unit("mile", "mi", 1609.344, ("mi", "statute mile")),
    Unit("nautical mile", "nmi", 1852.0, ("nmi", "international nautical mile")),
)  # fmt: skip


def unit_called(name: str) -> Unit | None:
    """Return the unit that a file or a person calls `name`, or None if nobody does."""
    word = " ".join(re.sub(r"[^a-z]+", " ", name.lower()).split())
    for unit in UNITS:
        names = (unit.name.lower(), *unit.aliases)
        if word in names or word.removesuffix("s") in names:
            return unit
    return None


def unit_of_length(name: str, metres: float) -> Unit:
    """Return the unit that is so long, whatever its name; one of that name if it is none of ours.

    The foot and the US survey foot differ by two parts in a million.
    """
    for unit in UNITS:
        if abs(metres / unit.metres - 1) < 1e-7:
            return unit
    return Unit(name, name, metres)


def symbol(name: str) -> str:
    """Return what stands behind a number of the unit called `name`."""
    unit = unit_called(name)
    return name if unit is None else unit.symbol
