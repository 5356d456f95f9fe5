"""Numbers that formulas are made with: what each may be, and how people are asked for it.

Levels of detail, factors of edges, surfaces and curves describe their numbers here once. Checks,
the command line with its help, sliders and comparisons are made from that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, field, fields, is_dataclass, replace
from typing import Any, ClassVar, Final, TypeVar

from .arguments import finite, flag, numbers, text, whole
from .errors import InputError

TILE: Final = "tile"
"""As many as a tile has cells: what a :class:`Number` can start at."""

# of a field's metadata
_KEY: Final = "number"
# a number and the other that must not lie below it: least, most, and what parts them in diagonals
_PAIRS: Final = (("minimum", "maximum", 0.0), ("near", "far", 0.01))


@dataclass(frozen=True)
class Number:
    """What one number may be.

    Parameters
    ----------
    default : float or None, optional
        None: found from what is looked at.
    low, high : float, optional
        Its range, both included. Without `low` it must be above 0.
    step : float, optional
        It is a multiple of this; with 1 a whole number.
    help : str, optional
        What it is, as an option's help; a few words, lower case.
    unit : str, optional
        ``"m"`` (lengths in the world, whatever the raster's unit), ``"pixels"``, ``"segments"``,
        ``"triangles"``, ``"degrees"`` or any other word.
    shown : (float, float), optional
        Where a slider ends, in diagonals of what is looked at if the unit is ``"m"``. Default: its
        range; one without an end has no slider.
    logarithmic : bool, optional
        Equal steps of a slider multiply.
    start : float or "tile", optional
        What a viewer begins with, also in diagonals; the cells of a tile. Default: `default`.
    required : bool, optional
        There is no default.
    """

    default: float | None = None
    low: float | None = None
    high: float = math.inf
    step: float = 0.0
    help: str = ""
    unit: str = ""
    shown: tuple[float, float] | None = None
    logarithmic: bool = False
    start: float | str | None = None
    required: bool = False

    def __post_init__(self) -> None:
        for name in ("default", "low", "high", "step", "start"):
            value = getattr(self, name)
            endless = name in ("low", "high") and isinstance(value, float) and math.isinf(value)
            missing = value is None and name in ("default", "low", "start")
            from_tile = name == "start" and isinstance(value, str) and value == TILE
            if not (endless or missing or from_tile):
                object.__setattr__(self, name, finite(name, value))
        if self.shown is not None:
            object.__setattr__(self, "shown", numbers("shown", self.shown, "low", "high"))
        text("help", self.help), text("unit", self.unit)
        flag("logarithmic", self.logarithmic), flag("required", self.required)

    def checked(self, name: str, value: object) -> float:
        """Return `value` as a float, or an int where only whole numbers will do.

        Raises
        ------
        InputError
            If it is no number, or not in its range.
        """
        number = finite(name, value)
        if self.step == 1 and self.low is not None and math.isfinite(self.high):
            return whole(name, value, int(self.low), int(self.high))
        if self.step and number % self.step != 0:
            raise InputError(f"expected a multiple of {self.step:g} for {name}, got {number:g}")
        ends = math.isfinite(self.high)
        if self.low is None and not 0 < number <= self.high:
            asked = f"{name} above 0, at most {self.high:g}" if ends else f"{name} > 0"
        elif self.low is not None and not self.low <= number <= self.high:
            low = f"{self.low:g}"
            asked = f"{name} from {low} to {self.high:g}" if ends else f"{name} >= {low}"
        else:
            return number
        raise InputError(f"expected {asked}, got {number:g}")

    def slider(self, diagonal: float) -> tuple[float, float] | None:
        """Return where a slider ends, for something of such a `diagonal`; None without a slider."""
        if self.shown is not None:
            scale = self._scale(diagonal)
            return scale * self.shown[0], scale * self.shown[1]
        if self.low is None or not math.isfinite(self.high) or not math.isfinite(self.low):
            return None
        return self.low, self.high

    def begin(self, diagonal: float, tile: int | None = None) -> float | None:
        """Return what a viewer of something of such a `diagonal` begins with."""
        if self.start == TILE:
            return self.default if tile is None else finite("tile", tile)
        if isinstance(self.start, float):
            return self._scale(diagonal) * self.start
        slider = self.slider(diagonal)
        return slider[0] if self.default is None and slider else self.default

    def _scale(self, diagonal: float) -> float:
        return finite("diagonal", diagonal) if self.unit == "m" else 1.0


def number(default: float | Number | object | None = MISSING, **what: Any) -> Any:
    """Return a dataclass field that is a :class:`Number`; its other arguments are those of that.

    Parameters
    ----------
    default : float, None or Number, optional
        Without one the number is required. None: the class finds it from what is looked at. A whole
        :class:`Number` may be shared by several classes.

    Examples
    --------
    >>> @dataclass(frozen=True)
    ... class SteepLod(Lod):
    ...     steep: float = number(30.0, low=1, high=90, help="slope with all detail")
    """
    if default is MISSING:
        made = Number(required=True, **what)
    elif isinstance(default, Number):
        made = replace(default, **what)
    else:
        made = Number(default, **what)  # type: ignore[arg-type]
    return field(default=MISSING if made.required else made.default, metadata={_KEY: made})


class Numbered:
    """A dataclass whose fields are numbers: checked as they come, kept as float or int.

    Fields of :func:`number` say their range and what they are; others take any finite number.
    Where there are ``minimum`` and ``maximum``, or ``near`` and ``far``, they are in order.

    Attributes
    ----------
    swept : str
        The number that a comparison tries several values of. Default: the first.
    needs_camera : bool
    """

    swept: ClassVar[str] = ""
    needs_camera: ClassVar[bool] = True

    def __post_init__(self) -> None:
        for name, what in numbers_of(type(self)).items():
            value = getattr(self, name)
            if value is not None or what.default is not None or what.required:
                object.__setattr__(self, name, what.checked(name, value))
        for low, high, apart in _PAIRS:
            least, most = getattr(self, low, None), getattr(self, high, None)
            if least is None or most is None:
                continue
            if apart and most <= least:
                raise InputError(
                    f"expected {high} > {low}, got {high} {most:g} and {low} {least:g}"
                )
            if most < least:
                raise InputError(f"expected {high} >= {low}, got {most:g} and {least:g}")

    def numbers(self) -> dict[str, float]:
        """Return its numbers by name."""
        return {name: getattr(self, name) for name in numbers_of(type(self))}


_Some = TypeVar("_Some", bound=Numbered)


def numbers_of(kind: type[Numbered]) -> dict[str, Number]:
    """Return what the numbers of a class may be, by name, in the order of its fields.

    Raises
    ------
    InputError
        If the class is no dataclass.
    """
    if not is_dataclass(kind):
        raise InputError(f"expected @dataclass(frozen=True) above class {kind.__name__}, got none")
    return {each.name: each.metadata.get(_KEY) or _any(each.default) for each in fields(kind)}


def _any(default: object) -> Number:
    return Number(
        default if isinstance(default, int | float) else None,
        low=-math.inf,
        required=default is MISSING,
    )


def summary_of(kind: type[Numbered]) -> str:
    """Return the first sentence of the class's docstring, as help says it: lower case, no dot."""
    words = " ".join((kind.__doc__ or kind.__name__).strip().split("\n\n")[0].split())
    return words[:1].lower() + words[1:].rstrip(".")


def begin(kind: type[_Some], diagonal: float, tile: int | None = None) -> _Some:
    """Return one of `kind` as a viewer of something of such a `diagonal` begins with it.

    Raises
    ------
    InputError
        If the class does not say what to begin with.
    """
    begun = {name: what.begin(diagonal, tile) for name, what in numbers_of(kind).items()}
    for name, what in numbers_of(kind).items():
        if what.required and begun[name] is None:
            raise InputError(
                f"expected a default, a start or a range for {name} of {kind.__name__}, got none"
            )
    return kind(**{name: value for name, value in begun.items() if value is not None})


def with_number(made: _Some, name: str, value: float, *, diagonal: float) -> _Some:
    """Return `made` with another number, its opposite moved out of the way."""
    known, changes = made.numbers(), {name: value}
    for low, high, apart in _PAIRS:
        if name == low and known.get(high) is not None and known[high] <= value:
            changes[high] = value + apart * diagonal
        if name == high and known.get(low) is not None and known[low] >= value:
            changes[low] = max(0.0, value - apart * diagonal)
    return replace(made, **changes)  # type: ignore[type-var]


def checked_numbers(
    what: str, expected: Mapping[str, Number], given: Mapping[str, object]
) -> dict[str, float]:
    """Return all numbers by name, in the order of `expected`.

    Raises
    ------
    InputError
        If `what` has no such number, or one is not in its range.
    """
    for name in given:
        if name not in expected:
            known = ", ".join(expected) or "none"
            raise InputError(f"unknown {name}= for {what}: expected {known}")
    return {
        name: number.checked(name, given.get(name, number.default))
        for name, number in expected.items()
    }


def refuse_names(given: Mapping[str, Number], taken: tuple[str, ...]) -> None:
    """Refuse numbers whose names mean something else."""
    for name in given:
        if name in taken:
            raise InputError(f"expected a number of another name, {name} is taken")


def defaults_of(expected: Mapping[str, Number]) -> dict[str, float]:
    """Return the defaults of numbers that all have one."""
    return checked_numbers("defaults", expected, {})
