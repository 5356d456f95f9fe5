"""Checks that arguments share, each with its one clear line: what was expected, what came."""

from __future__ import annotations

import errno
import math
import os
import reprlib
from collections.abc import Collection, Iterable
from pathlib import Path
from types import EllipsisType, UnionType
from typing import Any, Final, TypeVar

import numpy as np
import numpy.typing as npt

from .errors import FileError, InputError

_Some = TypeVar("_Some")
Shape = tuple[int | str | EllipsisType, ...]

# kinds of dtypes that hold real numbers
_REAL: Final = "biuf"
# characters that a message spends on what came
_LONGEST: Final = 60

_shortly = reprlib.Repr()
_shortly.maxstring = _shortly.maxother = _LONGEST


def told(value: object) -> str:
    """Return what came, in a few words: arrays by shape and dtype, what is long cut short."""
    if isinstance(value, np.ndarray) and value.size != 1:
        return f"an array of shape {value.shape}, {value.dtype}"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    text = " ".join(_shortly.repr(value).split())
    return text if len(text) <= 2 * _LONGEST else f"{text[:_LONGEST]}..."


def finite(name: str, value: object) -> float:
    """Return `value` as a float, or say that a finite number was expected."""
    try:
        # float() would read strings, and leave out what is imaginary
        if isinstance(value, str | bytes) or np.iscomplexobj(value) or np.ndim(value):  # type: ignore[arg-type]
            raise TypeError
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"expected a number for {name}, got {told(value)}") from None
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
        raise InputError(
            f"expected a whole number from {low} to {high} for {name}, got {told(value)}"
        )
    return int(number)


def parts(name: str, value: object, *words: str) -> tuple[Any, ...]:
    """Return the parts of `value`, which are as many as the words that say what they are."""
    words_alone = isinstance(value, str | bytes | dict | set)
    made = () if words_alone else tuple(_items(value) or ())
    if len(made) != len(words):
        raise InputError(f"expected {name} as ({', '.join(words)}), got {told(value)}")
    return made


def numbers(name: str, value: object, *words: str) -> tuple[float, ...]:
    """Return the parts of `value` as finite floats; see :func:`parts`."""
    return tuple(finite(name, part) for part in parts(name, value, *words))


def steps(name: str, value: object) -> tuple[float, float]:
    """Return two numbers above zero, along x and y; one stands for both."""
    alone = not isinstance(value, Iterable) or isinstance(value, str)
    if alone or getattr(value, "ndim", None) == 0:
        across = down = value
    else:
        across, down = parts(name, value, "x", "y")
    return positive(name, across), positive(name, down)


def flag(name: str, value: object) -> bool:
    """Return `value` as a bool; 0 and 1 will do."""
    if isinstance(value, bool | np.bool_ | int | np.integer) and value in (0, 1):
        return bool(value)
    raise InputError(f"expected True or False for {name}, got {told(value)}")


def one_of(name: str, value: object, choices: Collection[str]) -> str:
    """Return `value` if it is among `choices`, else list them."""
    if not isinstance(value, str) or value not in choices:
        raise InputError(f"unknown {name} {told(value)}: expected one of {', '.join(choices)}")
    return str(value)


def text(name: str, value: object) -> str:
    """Return `value` if it is a string, as one of Python's own."""
    return str(instance(f"a string for {name}", value, str))


def instance(what: str, value: object, kind: type[_Some] | UnionType) -> _Some:
    """Return `value` if it is one of a class, else say that `what` was expected."""
    if isinstance(value, kind):
        return value
    if isinstance(value, type) and issubclass(value, kind):
        name = value.__name__
        raise InputError(f"expected {what}, got its class {name}: write {name}(...)")
    raise InputError(f"expected {what}, got {told(value)}")


def list_of(name: str, value: object, kind: type[_Some]) -> list[_Some]:
    """Return `value` as a list of one class."""
    each = _items(value)
    if each is None:
        raise InputError(f"expected {name} as a list of {kind.__name__}, got {told(value)}")
    return [instance(f"a {kind.__name__} for each of {name}", one, kind) for one in each]


def items(name: str, value: object) -> list[Any]:
    """Return `value` as a list of whatever is in it."""
    each = _items(value)
    if each is None:
        raise InputError(f"expected {name} as a list, got {told(value)}")
    return each


def _items(value: object) -> list[Any] | None:
    """Return what is in `value`, None where nothing can be."""
    try:
        return list(value)  # type: ignore[call-overload, no-any-return]
    except TypeError:
        return None


def file_path(name: str, value: object) -> Path:
    """Return `value` as a path."""
    try:
        path = Path(os.fsdecode(value))  # type: ignore[arg-type]
    except TypeError:
        raise InputError(f"expected a file name for {name}, got {told(value)}") from None
    try:
        os.lstat(path)
    except ValueError:
        raise InputError(
            f"expected a file name without zero bytes for {name}, got {told(value)}"
        ) from None
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            raise FileError(f"cannot use {told(value)}: {error.strerror}") from None
    return path


def array(
    name: str,
    value: object,
    shape: Shape,
    dtype: npt.DTypeLike | None = np.float64,
    *,
    is_finite: bool = True,
) -> npt.NDArray[Any]:
    """Return `value` as an array of real numbers in C order; not a copy, if it is one already.

    Parameters
    ----------
    name : str
    value : array_like
    shape : tuple of int or str
        What each extent is; a string stands for any, and ... for any that follow.
    dtype : optional
        Whole numbers want whole numbers; None leaves them what they are.
    is_finite : bool, optional
        Refuse NaN and infinities, and what becomes one in `dtype`.
    """
    extents = ["..." if extent is ... else str(extent) for extent in shape]
    wanted = f"({', '.join(extents)}{',' * (len(shape) == 1)})"
    try:
        given = np.asarray(value)
    except (TypeError, ValueError, OverflowError):  # rows of different lengths
        given = np.empty((), object)
    dtype = np.dtype(given.dtype if dtype is None else dtype)
    kinds = "biu" if dtype.kind in "biu" and given.size else _REAL
    if given.dtype.kind not in kinds:
        real = "real" if kinds == _REAL else "whole"
        raise InputError(f"expected {name} as {real} numbers {wanted}, got {told(value)}")
    if not _fits(given.shape, shape):
        raise InputError(f"expected {name} of shape {wanted}, got {given.shape}")
    with np.errstate(over="ignore", invalid="ignore"):
        made = np.asarray(given, dtype, order="C")
    if dtype.kind != "f":
        if made.dtype != given.dtype and (changed := made != given).any():
            raise InputError(f"expected {name} that {made.dtype} can hold, got {given[changed][0]}")
    elif is_finite and not (sound := np.isfinite(made)).all():
        place = tuple(np.argwhere(~sound)[0].tolist())
        fine = np.isfinite(given[place])
        kind = f"{name} that {made.dtype} can hold" if fine else f"finite {name}"
        raise InputError(f"expected {kind}, got {given[place]:g} at {list(place)}")
    return made


def each(
    name: str, value: object, shape: tuple[int, ...], dtype: npt.DTypeLike = np.float64
) -> npt.NDArray[Any]:
    """Return `value` as an array of finite numbers, where one number serves for all."""
    if getattr(value, "ndim", isinstance(value, list | tuple)):
        return array(name, value, shape, dtype)
    return array(name, np.full(shape, finite(name, value)), shape, dtype)


def _fits(shape: tuple[int, ...], wanted: Shape) -> bool:
    if wanted[-1:] == (...,):
        shape, wanted = shape[: len(wanted) - 1], wanted[:-1]
    return len(shape) == len(wanted) and all(
        isinstance(extent, str) or extent == got for extent, got in zip(wanted, shape, strict=True)
    )
