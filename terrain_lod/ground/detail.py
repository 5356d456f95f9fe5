"""Detail: a small raster laid all over a larger one, again and again; here as arrays alone.

A whole number of its samples stand to a cell of the ground. Between the ground's own samples the
ground is bilinear, and kernels (``terrain/ground.h``) round as :func:`between` does::

    o . . o . . o     o  samples of the ground           here with 3 steps a cell
    . . . . . . .     .  between them, bilinear
    o . . o . . o     everywhere plus a sample of the detail, which begins again after its last
"""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..errors import InputError

# of a cell: how far the detail's spacing may be off a whole part of the ground's
_NEAR: Final = 1e-6

Pair = tuple[float, float]


def steps_between(spacing: Pair, fine: Pair) -> tuple[int, int]:
    """Return how many steps of `fine` there are to one of `spacing`, along x and y."""
    ratios = np.divide(spacing, fine)
    across, down = (max(round(ratio), 1) for ratio in ratios)
    if max(abs(ratios[0] - across), abs(ratios[1] - down)) > _NEAR * max(across, down):
        raise InputError(
            f"expected detail whose spacing divides the ground's, {spacing[0]:g} x "
            f"{spacing[1]:g}, by whole numbers, got {fine[0]:g} x {fine[1]:g}"
        )
    return across, down


def require_float32(heights: npt.NDArray[np.float32], detail: npt.NDArray[np.float32]) -> None:
    """Refuse sums, and differences of neighbours, beyond float32's range."""
    highest, added = (float(np.abs(part).max()) for part in (heights, detail))
    if 2 * (highest + added) > float(np.finfo(np.float32).max):
        raise InputError(
            "expected sums of ground and detail that float32 can hold, got heights up to "
            f"{highest:g} and {added:g}"
        )


def between(heights: npt.NDArray[np.float32], steps: tuple[int, int]) -> npt.NDArray[np.float32]:
    """Return (R, C) `heights` with so many steps a cell along x and y."""
    across, down = steps
    return _between(_between(heights, across, axis=1), down, axis=0)


def reached(mask: npt.NDArray[np.bool_], steps: tuple[int, int]) -> npt.NDArray[np.bool_]:
    """Return where a sample in between needs one of `mask`."""
    across, down = steps
    return _reached(_reached(mask, across, axis=1), down, axis=0)


def repeated(heights: npt.NDArray[np.float32], shape: tuple[int, int]) -> npt.NDArray[np.float32]:
    """Return `heights` over and over again, until they fill `shape`."""
    rows, columns = (
        np.arange(extent) % period for extent, period in zip(shape, heights.shape, strict=True)
    )
    filled: npt.NDArray[np.float32] = heights[np.ix_(rows, columns)]
    return filled


def _neighbours(extent: int, steps: int) -> tuple[npt.NDArray[np.intp], ...]:
    """Return the sample at or before each one in between, the one at or after, steps from one."""
    before, step = np.divmod(np.arange((extent - 1) * steps + 1), steps)
    return before, before + (step > 0), step


def _between(heights: npt.NDArray[np.float32], steps: int, axis: int) -> npt.NDArray[np.float32]:
    before, after, step = _neighbours(heights.shape[axis], steps)
    share = step.astype(np.float32) * np.float32(1 / steps)
    low, high = heights.take(before, axis), heights.take(after, axis)
    high -= low
    high *= share if axis == 1 else share[:, None]
    return np.add(low, high, out=low)


def _reached(mask: npt.NDArray[np.bool_], steps: int, axis: int) -> npt.NDArray[Any]:
    before, after, _ = _neighbours(mask.shape[axis], steps)
    return mask.take(before, axis) | mask.take(after, axis)
