"""Checks that arguments share, each with its one clear line."""

from __future__ import annotations

import math
from collections.abc import Collection

from .errors import InputError


def finite(name: str, value: object) -> float:
    """Return `value` as a float, or say that a finite number was expected."""
    try:
        if isinstance(value, str | bytes):  # float() would read them
            raise TypeError
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"expected a number for {name}, got {value!r}") from None
    if not math.isfinite(number):
        raise InputError(f"expected a finite {name}, got {number}")
    return number


def positive(name: str, value: object) -> float:
    """Return `value` as a float above zero."""
    number = finite(name, value)
    if number <= 0:
        raise InputError(f"expected {name} > 0, got {number:g}")
    return number


def whole(name: str, value: object, low: int, high: int) -> int:
    """Return `value` as an int in low..high."""
    number = finite(name, value)
    if number != int(number) or not low <= number <= high:
        raise InputError(f"expected a whole number from {low} to {high} for {name}, got {value!r}")
    return int(number)


def one_of(name: str, value: str, choices: Collection[str]) -> str:
    """Return `value` if it is among `choices`, else list them."""
    if value not in choices:
        raise InputError(f"unknown {name} {value!r}: expected one of {', '.join(choices)}")
    return value
