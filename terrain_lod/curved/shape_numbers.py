"""The numbers that shape parametric surfaces and curves: defaults, ranges, checks."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from ..arguments import finite
from ..errors import InputError


class Number(NamedTuple):
    """A number's default and range; above 0 unless a least value is given.

    Attributes
    ----------
    default, low, high : float
    step : float
        The number is a multiple of it; 0 where any will do.
    """

    default: float
    low: float = math.nan
    high: float = 1e18
    step: float = 0.0


def shape_numbers(
    what: str, expected: Mapping[str, Number], given: Mapping[str, float]
) -> dict[str, float]:
    """Return all numbers by name, in the order of `expected`.

    Raises
    ------
    InputError
        If `what` has no such number, or one is not in its range.
    """
    for name in given:
        if name not in expected:
            raise InputError(f"unknown {name}= for {what}: expected {', '.join(expected)}")
    return {
        name: _checked(name, number, given.get(name, number.default))
        for name, number in expected.items()
    }


def _checked(name: str, number: Number, value: object) -> float:
    checked = finite(name, value)
    if number.step and checked % number.step != 0:
        raise InputError(f"expected a multiple of {number.step:g} for {name}, got {checked:g}")
    if math.isnan(number.low):
        if not 0 < checked <= number.high:
            raise InputError(f"expected {name} above 0, at most {number.high:g}, got {checked:g}")
    elif not number.low <= checked <= number.high:
        raise InputError(f"expected {name} from {number.low:g} to {number.high:g}, got {checked:g}")
    return checked
