"""What colours stand for: numbers with a unit, as a bar or as patches of colour."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from ..ground.heightmap import Heightmap
from ..ground.units import unit_called
from ..mesh.mesh import Patches
from .colours import ERROR_STOPS, HEAT_STOPS, LOD_STOPS, Colours, Stops, height_stops, ramp

Values = npt.NDArray[np.floating]

# numbers of the first and the last colour in pictures that stand side by side or follow each other:
# cells along a segment, cells along a patch, segments
COMPARED: Final = {"lod": (1.0, 64.0), "size": (1.0, 1024.0), "factor": (1.0, 16.0)}

_MARKS: Final = 6  # numbers beside a bar, about


@dataclass(frozen=True)
class Scale:
    """Numbers as colours.

    Attributes
    ----------
    title : str
        What the numbers are.
    unit : str
        Behind each of them; empty where they are counts.
    low, high : float
        Numbers of the first and the last colour; those beyond have them, too.
    stops : tuple
        Colours at positions from 0 to 1.
    logarithmic : bool
        Equal steps of colour multiply.
    reverse : bool
        The last colour stands for `low`.
    """

    title: str
    unit: str
    low: float
    high: float
    stops: Stops
    logarithmic: bool = False
    reverse: bool = False

    def position(self, values: npt.ArrayLike) -> npt.NDArray[np.float32]:
        """Return where numbers are on the scale, 0 to 1 between `low` and `high`."""
        numbers, ends = np.asarray(values, np.float64), np.array([self.low, self.high])
        if self.logarithmic:
            numbers, ends = np.log(np.maximum(numbers, 1e-30)), np.log(np.maximum(ends, 1e-30))
        extent = float(ends[1] - ends[0])
        # a single number has the colour of the middle
        shares = (numbers - ends[0]) / extent if extent > 0 else np.full(numbers.shape, 0.5)
        held: npt.NDArray[np.float32] = np.clip(shares, 0.0, 1.0).astype(np.float32)
        return held

    def colours(self, values: npt.ArrayLike) -> Colours:
        """Return the colour of each number (N,)."""
        at = self.position(values)
        return ramp(self.stops, 1 - at if self.reverse else at)

    def marks(self) -> tuple[tuple[float, str], ...]:
        """Return positions and numbers that stand beside the bar."""
        if not self.low < self.high:
            return ((0.5, shortly(self.low)),)
        if self.logarithmic:
            first, last = math.ceil(math.log2(self.low)), math.floor(math.log2(self.high))
            every = 1 + (last - first) // (_MARKS + 2)
            inner = [2.0**octave for octave in range(first, last + 1, every)]
        else:
            step = nice((self.high - self.low) / (_MARKS - 1))
            first, last = math.ceil(self.low / step), math.floor(self.high / step)
            inner = [step * number for number in range(first, last + 1)]
        at = self.position(inner)
        # the ends are said, and what stands close to them is not
        kept = [(float(x), shortly(v)) for x, v in zip(at, inner, strict=True) if 0.12 < x < 0.88]
        return ((0.0, shortly(self.low)), *kept, (1.0, shortly(self.high)))

    def said(self) -> str:
        """Return the scale in words."""
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.title}, {shortly(self.low)} to {shortly(self.high)}{unit}"


def tints(height_range: tuple[float, float], unit: str, metres: float | None) -> Scale:
    """Return the tints of heights; see :func:`~terrain_lod.drawing.colours.hypsometric`."""
    title = "height" if metres is None else "height above the sea"
    return Scale(title, unit, *height_range, height_stops(height_range, metres))


def metres_above_sea(ground: Heightmap) -> float | None:
    """Return the length of the unit of heights where they are above the sea, else None.

    Ground that is on a map has its heights from there, to a geoid's difference from the sea; of
    ground that is nowhere, nobody knows.
    """
    unit = unit_called(ground.units[1])
    return None if ground.crs is None or unit is None else unit.metres


def segments(patches: Patches) -> Scale:
    """Return the colours of what segments span, over what is there."""
    return _of_patches("a triangle's side", "cells", patches.segment_cells[patches.drawn], True)


def sizes(patches: Patches) -> Scale:
    """Return the colours of how large patches are, over what is there."""
    return _of_patches("size of a patch", "cells", patch_sizes(patches)[patches.drawn], True)


def factors(values: Values) -> Scale:
    """Return the colours of tessellation factors (N,), over what is there."""
    found = values[values > 0]
    low, high = (float(found.min()), float(found.max())) if len(found) else (1.0, 1.0)
    return Scale("tessellation factor", "", low, high, LOD_STOPS)


def patch_sizes(patches: Patches) -> npt.NDArray[np.float64]:
    """Return the cells along each patch; (P,)."""
    lengths: npt.NDArray[np.float64] = np.sqrt(patches.areas[:, 2:].prod(axis=1, dtype=np.float64))
    return lengths


def deviations(rough: float, unit: str) -> Scale:
    """Return the colours of deviations from a plane, `rough` the brightest."""
    return Scale("deviation from a plane", unit, 0.0, rough or 1.0, HEAT_STOPS)


def errors(largest: float, unit: str) -> Scale:
    """Return the colours of vertical errors up to the largest, above the ground and below."""
    top = largest or 1.0
    return Scale("mesh above the ground", unit, -top, top, ERROR_STOPS)


def _of_patches(title: str, unit: str, values: Values, fine_is_last: bool) -> Scale:
    low, high = (float(values.min()), float(values.max())) if len(values) else (1.0, 1.0)
    return Scale(title, unit, low, high, LOD_STOPS, logarithmic=True, reverse=fine_is_last)


def nice(length: float) -> float:
    """Return 1, 2 or 5 times a power of ten, the next above or at a length > 0."""
    power = 10.0 ** math.floor(math.log10(length) + 1e-12)
    return next(step * power for step in (1, 2, 5, 10) if step * power >= length * (1 - 1e-9))


def shortly(value: float) -> str:
    """Return a number as people read it, of at most four digits or whole."""
    if abs(value) >= 1000:
        return f"{value:,.0f}"
    return f"{value:.3g}"
