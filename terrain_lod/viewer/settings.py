"""What a viewer can be set to: every choice and every number, with its control.

Windows and web pages build their keys, menus and sliders from the two tables here, so a new setting
is a field and a row.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import Any, Final

from ..arguments import finite, one_of, whole
from ..errors import InputError
from ..layout import DEFAULT_TILE, MAX_TILE, PARTITIONINGS
from ..lod import (
    BudgetLod,
    CoplanarityLod,
    DistanceLod,
    Lod,
    MaxErrorLod,
    PromiseLod,
    ScreenErrorLod,
    UniformLod,
)

MODES: Final = ("shaded", "wireframe", "lod", "deviation", "error", "normals")
LODS: Final = ("screen-error", "max-error", "budget", "coplanarity", "distance", "uniform")
_PROMISES: Final = LODS[:3]
_RANGED: Final = ("coplanarity", "distance")


@dataclass(frozen=True)
class Choice:
    """A setting with a few values.

    Attributes
    ----------
    name : str
        Field of :class:`Settings`.
    key : str
        Moves on to the next value.
    values : tuple
    """

    name: str
    key: str
    values: tuple[Any, ...]


CHOICES: Final = (
    Choice("mode", "m", MODES),
    Choice("lod", "l", LODS),
    Choice("partitioning", "p", tuple(PARTITIONINGS)),
    Choice("edges", "e", ("edge", "min", "max")),
    Choice("tile", "k", (7, 15, 31, 63)),
    Choice("tessellated", "t", (True, False)),
    Choice("frozen", "f", (False, True)),
)


@dataclass(frozen=True)
class Slider:
    """A setting that is a number.

    Attributes
    ----------
    name : str
        Field of :class:`Settings`.
    label : str
    low, high : float
    lods : tuple of str
        Levels of detail that it belongs to.
    whole : bool
        Only whole numbers.
    logarithmic : bool
        Equal steps multiply.
    """

    name: str
    label: str
    low: float
    high: float
    lods: tuple[str, ...] = LODS
    whole: bool = False
    logarithmic: bool = False

    def on_scale(self, value: float) -> float:
        """Return where a value is on the slider."""
        return math.log10(value) if self.logarithmic else float(value)

    def of_scale(self, position: float) -> float:
        """Return the value at a position of the slider."""
        return 10.0**position if self.logarithmic else position

    def said(self, value: float) -> str:
        """Return a value as people read it."""
        return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.3g}"

    def nearest(self, value: float) -> float:
        """Return the value that the slider can take next to `value`."""
        held = min(max(finite(self.name, value), self.low), self.high)
        return round(held) if self.whole else held


def sliders(diagonal: float) -> tuple[Slider, ...]:
    """Return every slider for ground of this `diagonal`, in world units."""
    return (
        Slider("pixels", "error, pixels", 0.25, 32.0, ("screen-error",), logarithmic=True),
        Slider(
            "metres",
            "error, metres",
            1e-6 * diagonal,
            1e-2 * diagonal,
            ("max-error",),
            logarithmic=True,
        ),
        Slider("triangles", "triangles", 1e4, 1e6, ("budget",), whole=True, logarithmic=True),
        Slider("near", "near", 0.0, diagonal, _RANGED),
        Slider("far", "far", 0.01 * diagonal, 2 * diagonal, _RANGED),
        Slider("minimum", "least factor", 1.0, MAX_TILE, _RANGED),
        Slider("maximum", "most factor", 1.0, MAX_TILE, _RANGED),
        Slider("falloff", "falloff", 0.25, 8.0, ("distance",), logarithmic=True),
        Slider("flat_weight", "weight of flat", 0.0, 1.0, ("coplanarity",)),
        Slider("factor", "factor", 1.0, MAX_TILE, ("uniform",)),
        Slider("azimuth", "sun from", 0.0, 360.0),
        Slider("elevation", "sun above", 0.0, 90.0),
    )


@dataclass(frozen=True)
class Settings:
    """What a viewer is set to.

    Attributes
    ----------
    diagonal : float
        Of the ground, in world units: what distances are measured by.
    mode : str
        One of :data:`MODES`.
    lod : str
        One of :data:`LODS`.
    pixels, metres, triangles, near, far, minimum, maximum, falloff, flat_weight, factor : float
        Parameters of the levels of detail; each uses its own.
    partitioning, edges : str
    tessellated : bool
        False: every patch is two triangles.
    frozen : bool
        The level of detail stays with the camera of the moment it was frozen.
    tile : int
    azimuth, elevation : float
        Of the sun, degrees.
    """

    diagonal: float
    mode: str = "shaded"
    lod: str = "screen-error"
    pixels: float = 1.0
    metres: float = field(default=0.0)
    triangles: int = 100_000
    near: float = 0.0
    far: float = field(default=0.0)
    minimum: float = 1.0
    maximum: float = float(DEFAULT_TILE)
    falloff: float = 1.0
    flat_weight: float = 0.0
    factor: float = float(DEFAULT_TILE)
    partitioning: str = "fractional_odd"
    edges: str = "edge"
    tessellated: bool = True
    frozen: bool = False
    tile: int = DEFAULT_TILE
    azimuth: float = 315.0
    elevation: float = 40.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "metres", self.metres or 2e-4 * self.diagonal)
        object.__setattr__(self, "far", self.far or self.diagonal)

    def changed(self, name: str, value: Any) -> Settings:
        """Return these settings with one of them changed, and its opposite made room for.

        Numbers are held in their sliders' ranges.

        Raises
        ------
        InputError
            If there is no such setting, or it cannot have that value.
        """
        for choice in CHOICES:
            if choice.name == name and isinstance(choice.values[0], str):
                one_of(name, value, choice.values)
        if name == "tile":
            value = whole(name, value, 1, MAX_TILE)
        for slider in sliders(self.diagonal):
            if slider.name == name:
                value = slider.nearest(value)
        if name not in {setting.name for setting in fields(self)}:
            raise InputError(f"unknown setting {name!r}")
        new = replace(self, **{name: value})
        if name in ("minimum", "maximum") and new.minimum > new.maximum:
            new = replace(new, minimum=value, maximum=value)
        if name == "near" and new.far <= new.near:
            new = replace(new, far=new.near + 0.01 * self.diagonal)
        if name == "far" and new.far <= new.near:
            new = replace(new, near=max(0.0, new.far - 0.01 * self.diagonal))
        return new

    def next(self, name: str) -> Settings:
        """Return these settings with the next value of a choice."""
        values = next(choice.values for choice in CHOICES if choice.name == name)
        value = getattr(self, name)
        after = values.index(value) + 1 if value in values else 0
        return self.changed(name, values[after % len(values)])

    @property
    def sliders(self) -> tuple[Slider, ...]:
        """Those that matter with the level of detail that is chosen."""
        return tuple(slider for slider in sliders(self.diagonal) if self.lod in slider.lods)

    @property
    def edge_rule(self) -> str:
        """The edge rule, as far as the level of detail has it."""
        promises = self.tessellated and self.lod in _PROMISES
        return self.edges if promises or self.edges != "edge" else "min"

    def detail(self) -> Lod | PromiseLod:
        """Return the level of detail."""
        if not self.tessellated:
            return UniformLod(1.0)
        ranged = {name: getattr(self, name) for name in ("near", "far", "minimum", "maximum")}
        match self.lod:
            case "screen-error":
                return ScreenErrorLod(self.pixels)
            case "max-error":
                return MaxErrorLod(self.metres)
            case "budget":
                return BudgetLod(int(self.triangles))
            case "coplanarity":
                return CoplanarityLod(**ranged, flat_weight=self.flat_weight)
            case "distance":
                return DistanceLod(**ranged, falloff=self.falloff)
        return UniformLod(self.factor)
