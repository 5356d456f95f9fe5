"""Errors as bytes: the steps of a logarithm, always rounded up."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

STEPS: Final = 8
"""Codes an octave: one is 9 % more than the one before."""
LEAST: Final = -12
"""Code 1 stands for 2 to the power of this, in the unit of heights."""
UNKNOWN: Final = 255
"""Stands for infinity: no bound is known."""

Codes = npt.NDArray[np.uint8]


def _rounded_up(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float32]:
    near = values.astype(np.float32)
    return np.where(near < values, np.nextafter(near, np.float32(np.inf)), near)


_VALUES: Final = _rounded_up(
    np.concatenate(([0.0], 2.0 ** (np.arange(UNKNOWN - 1) / STEPS + LEAST), [np.inf]))
)


def encode(errors: npt.NDArray[Any]) -> Codes:
    """Return the least code that stands for no less than each error; 0 stands for 0."""
    return np.searchsorted(_VALUES, errors, side="left").astype(np.uint8)


def decode(codes: Codes) -> npt.NDArray[np.float32]:
    """Return the errors that codes stand for, never rounded down."""
    return _VALUES[codes]
