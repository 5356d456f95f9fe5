"""Samples that stand for no data: those declared, and those that look like it."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from .raster import Raster

# what programs write where they know no height
SENTINELS: Final = (-32767.0, -32768.0, -9999.0, -99999.0, 3.4028234663852886e38,
                    -3.4028234663852886e38)  # fmt: skip
# metres: deeper than any sea, higher than any mountain
LOWEST, HIGHEST = -12_000.0, 9_000.0
# beyond this a number is no height: how many digits of it were written does not matter
HUGE: Final = 1e30
# a file is asked for so many values of this kind at most; more are a landscape of its own
FEW: Final = 3


def is_nodata(values: npt.NDArray[Any], nodata: float) -> npt.NDArray[np.bool_]:
    """Return where `values` are `nodata`, to the digits that float32 and text files keep.

    Whole numbers are compared as they are. Floating-point ones may have been through float32 on
    one side and not on the other, and numbers such as 1.70141e+38 were often cut as well.
    """
    if values.dtype.kind != "f":
        return np.asarray(values == nodata)
    limit = np.finfo(values.dtype).max
    slack = abs(nodata) * (1e-5 if abs(nodata) > HUGE else 2.0**-24)
    # inclusive on both sides, and within what the values' own type can hold
    with np.errstate(over="ignore"):
        low, high = (
            values.dtype.type(min(max(edge, -limit), limit))
            for edge in (nodata - slack, nodata + slack)
        )
    hole: npt.NDArray[np.bool_] = values >= low
    hole &= values <= high
    return hole


def suspects(
    raster: Raster, hole: npt.NDArray[np.bool_] | None, name: str, metres: float
) -> tuple[str, ...]:
    """Return what to warn a user of: values that look like nodata, as :func:`undeclared` has it."""
    return tuple(
        f"{name} holds {value:g} in {count:,} of {raster.values.size:,} samples, which "
        f"looks like nodata that is not declared: nodata={value:.9g} leaves them out"
        for value, count in undeclared(raster.values, hole, metres)
    )


def undeclared(
    values: npt.NDArray[Any], hole: npt.NDArray[np.bool_] | None, metres: float
) -> list[tuple[float, int]]:
    """Return the few values that no ground has while all else is ground, and how many there are.

    Parameters
    ----------
    values : (R, C)
        As the file has them.
    hole : (R, C) bool or None
        Where there is no data already.
    metres : float
        What one of the file's numbers is in metres.
    """
    known = values if hole is None or not hole.any() else values[~hole]
    if not known.size or known.dtype.kind not in "iuf":
        return []
    least, most = _range(known)
    lowest, highest = LOWEST / metres, HIGHEST / metres
    if np.isnan(least) or (least >= lowest and most <= highest and least > max(SENTINELS[:4])):
        return []
    odd = (known < lowest) | (known > highest) | np.isin(known, np.array(SENTINELS, known.dtype)
                                                         if known.dtype.kind == "f"
                                                         else SENTINELS)  # fmt: skip
    found, counts = np.unique(known[odd], return_counts=True)
    if not found.size or found.size > FEW or found.size == known.size or odd.all():
        return []
    rest = known[~odd]
    low, high = _range(rest)
    return [
        (float(value), int(count))
        for value, count in zip(found, counts, strict=True)
        if np.isfinite(value) and _apart(float(value), low, high)
    ]


def _range(values: npt.NDArray[Any]) -> tuple[float, float]:
    """Return the least and the most, whatever is NaN; NaN if all is."""
    return float(np.fmin.reduce(values, axis=None)), float(np.fmax.reduce(values, axis=None))


def _apart(value: float, low: float, high: float) -> bool:
    """Return whether no slope leads from the ground to `value`: nothing is near it."""
    gap = low - value if value < low else value - high
    known = any(np.isclose(value, sentinel, rtol=1e-5) for sentinel in SENTINELS)
    return gap > (0.1 * abs(value) if known else high - low)
