"""What a viewer can be set to: choices and numbers, each with its control.

Windows and pages build their keys, menus and sliders from two tables that every kind of settings
has, so a new setting is a field and a row: `terrain_settings.py`, `mesh_settings.py`. Levels of
detail bring their numbers, and so their sliders, from the table that they stand in.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Final, TypeVar

from ..arguments import finite, flag, one_of, text
from ..device.layout import PARTITIONINGS
from ..numbered import Number, numbers_of, with_number

_Own = TypeVar("_Own", bound="Settings")


@dataclass(frozen=True)
class Choice:
    """A setting with a few values.

    Attributes
    ----------
    name : str
        Field of the settings.
    key : str
        Moves on to the next value.
    values : tuple
    label : str
        What a menu calls it, if not by its name.
    """

    name: str
    key: str
    values: tuple[Any, ...]
    label: str = ""


@dataclass(frozen=True)
class Slider:
    """A setting that is a number.

    Attributes
    ----------
    name : str
        Field of the settings.
    label : str
    low, high : float
    only : (str, tuple) or None
        A choice, and those of its values with which this number matters.
    whole : bool
        Only whole numbers.
    stops : tuple of float
        The only values it takes, if any.
    logarithmic : bool
        Equal steps multiply.
    """

    name: str
    label: str
    low: float
    high: float
    only: tuple[str, tuple[Any, ...]] | None = None
    whole: bool = False
    stops: tuple[float, ...] = ()
    logarithmic: bool = False

    def on_scale(self, value: float | None) -> float:
        """Return where a value is on the slider; at its low end, if found from what is seen."""
        value = self.low if value is None else value
        return math.log10(value) if self.logarithmic else float(value)

    def of_scale(self, position: float) -> float:
        """Return the value at a position of the slider."""
        return 10.0**position if self.logarithmic else position

    def said(self, value: float | None) -> str:
        """Return a value as people read it."""
        if value is None:
            return "by itself"
        return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"

    def nearest(self, value: float) -> float:
        """Return the value that the slider can take next to `value`."""
        held = min(max(finite(self.name, value), self.low), self.high)
        if self.stops:
            return min(self.stops, key=lambda stop: abs(self.on_scale(stop) - self.on_scale(held)))
        return round(held) if self.whole else held


def slider_of(
    name: str, what: Number, diagonal: float, lods: tuple[str, ...] | None = None
) -> Slider:
    """Return the slider of a number, shown with those `lods` that have it."""
    ends = what.slider(diagonal)
    return Slider(
        name,
        name.replace("_", " "),
        *(ends or (0.0, 1.0)),
        only=None if lods is None else ("lod", lods),
        whole=what.step == 1,
        logarithmic=what.logarithmic and ends is not None,
    )


SUN: Final = (
    Slider("azimuth", "sun from", 0.0, 360.0),
    Slider("elevation", "sun above", 0.0, 90.0),
)
SHARED: Final = (
    Choice("partitioning", "p", tuple(PARTITIONINGS)),
    Choice("tessellated", "t", (True, False)),
    Choice("frozen", "f", (False, True)),
)


@dataclass(frozen=True, kw_only=True)
class Settings(ABC):
    """What all scenes can be set to.

    Attributes
    ----------
    diagonal : float
        Of what is looked at, in world units: what distances are measured by.
    mode : str
        What colours mean.
    lod : str
        How detail is chosen.
    formulas : mapping of str to Numbered
        Every level of detail, or formula for edges, with its numbers, by name.
    partitioning : str
    tessellated : bool
        False: every patch as coarse as can be.
    frozen : bool
        The level of detail stays with the camera of the moment it was frozen.
    azimuth, elevation : float
        Of the sun, degrees.
    """

    diagonal: float
    mode: str = "shaded"
    lod: str = "uniform"
    formulas: Mapping[str, Any] = field(default_factory=dict, repr=False)
    partitioning: str = "fractional_odd"
    tessellated: bool = True
    frozen: bool = False
    azimuth: float = 315.0
    elevation: float = 40.0

    def __str__(self) -> str:
        """Return how meshes are made."""
        return f"{self.lod if self.tessellated else 'not tessellated'}, {self.partitioning}"

    @property
    @abstractmethod
    def choices(self) -> tuple[Choice, ...]:
        """Every setting with a few values, that of the mode first."""

    @property
    @abstractmethod
    def numbers(self) -> tuple[Slider, ...]:
        """Every setting that is a number."""

    @property
    def modes(self) -> tuple[str, ...]:
        """What colours can mean."""
        return self.choices[0].values

    @property
    def sliders(self) -> tuple[Slider, ...]:
        """Those numbers that matter with what is chosen."""
        return tuple(
            slider
            for slider in self.numbers
            if slider.only is None or getattr(self, slider.only[0]) in slider.only[1]
        )

    def value(self, name: str) -> Any:
        """Return a setting, or a number of the level of detail that is chosen, else of another."""
        holder = self._holder(name)
        return getattr(self if holder is None else self.formulas[holder], name)

    def _holder(self, name: str) -> str | None:
        """Return the level of detail that has a number: the chosen one, else the first."""
        takers = [lod for lod, made in self.formulas.items() if name in made.numbers()]
        return self.lod if self.lod in takers else next(iter(takers), None)

    def formula_sliders(self) -> tuple[Slider, ...]:
        """Return a slider for each number of the levels of detail that has one."""
        takers: dict[str, list[str]] = {}
        for lod, made in self.formulas.items():
            for name, what in numbers_of(type(made)).items():
                if what.slider(self.diagonal) is not None:
                    takers.setdefault(name, []).append(lod)
        return tuple(
            slider_of(name, self._number(name), self.diagonal, tuple(lods))
            for name, lods in takers.items()
        )

    def _has_slider(self, name: str) -> bool:
        return self._holder(name) is None or bool(self._number(name).slider(self.diagonal))

    def _number(self, name: str) -> Number:
        holder = self._holder(name)
        assert holder is not None
        return numbers_of(type(self.formulas[holder]))[name]

    def _with_number(self: _Own, name: str, value: float) -> _Own:
        """Return settings with a number changed, in all levels of detail that mean the same."""
        what = self._number(name)
        made = {
            lod: with_number(each, name, value, diagonal=self.diagonal)
            if numbers_of(type(each)).get(name) == what
            else each
            for lod, each in self.formulas.items()
        }
        return replace(self, formulas=made)

    def changed(self: _Own, name: str, value: Any) -> _Own:
        """Return these settings with one of them changed, and its opposite made room for.

        Numbers are held in their sliders' ranges.

        Raises
        ------
        InputError
            If there is no such setting, or it cannot have that value.
        """
        if self._holder(text("setting", name)) is None:
            known = [choice.name for choice in self.choices]
            one_of("setting", name, [*known, *(slider.name for slider in self.numbers)])
        for choice in self.choices:
            if choice.name == name:
                words = isinstance(choice.values[0], str)
                value = one_of(name, value, choice.values) if words else flag(name, value)
        for slider in self.numbers:
            if slider.name == name and self._has_slider(name):
                value = slider.nearest(value)
        if self._holder(name) is not None:
            return self._with_number(name, finite(name, value))
        return replace(self, **{name: value})

    def next(self: _Own, name: str) -> _Own:
        """Return these settings with the next value of a choice."""
        values = next(choice.values for choice in self.choices if choice.name == name)
        after = values.index(getattr(self, name)) + 1
        return self.changed(name, values[after % len(values)])
