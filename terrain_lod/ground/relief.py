"""What a terrain shows: a heightmap, and perhaps a small one laid all over it, again and again.

Detail makes ground finer. A whole number of its samples stand to a cell of the ground, and the sum
of both is only found where it is read, by kernels (``ground.h``) as by :meth:`Relief.sum`::

    o . . o . . o     o  samples of the ground           here with 3 steps a cell
    . . . . . . .     .  between them, bilinear
    o . . o . . o     everywhere plus a sample of the detail, which begins again after its last
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from .heightmap import Heightmap

# of a cell: how far the detail's spacing may be off a whole part of the ground's
_NEAR: Final = 1e-6


@dataclass(frozen=True, eq=False)
class Relief:
    """A heightmap and its detail; :meth:`Heightmap.with_detail` describes the sum.

    Attributes
    ----------
    ground : Heightmap
    detail : Heightmap or None
    steps : (int, int)
        Samples of the detail a cell of the ground, along x and y; 1 without detail.

    Raises
    ------
    InputError
        If the detail does not fit the ground.
    """

    ground: Heightmap
    detail: Heightmap | None = None
    steps: tuple[int, int] = field(init=False, default=(1, 1))

    def __post_init__(self) -> None:
        if self.detail is not None:
            object.__setattr__(self, "steps", _steps(self.ground, self.detail))
            _require_float32(self.ground, self.detail)

    @property
    def shape(self) -> tuple[int, int]:
        """Samples of the sum along y and x."""
        (rows, columns), (across, down) = self.ground.shape, self.steps
        return (rows - 1) * down + 1, (columns - 1) * across + 1

    @property
    def spacing(self) -> tuple[float, float]:
        """Of the sum, along x and y."""
        (dx, dy), (across, down) = self.ground.spacing, self.steps
        return dx / across, dy / down

    @property
    def base(self) -> float:
        """Added to every sum of heights."""
        return self.ground.base + (0.0 if self.detail is None else self.detail.base)

    def touching(self, rows: slice, columns: slice) -> tuple[slice, slice]:
        """Return the samples of the sum that depend on these of the ground, start and stop given.

        Those up to the next samples of the ground on either side do.
        """
        (all_rows, all_columns), (across, down) = self.shape, self.steps
        return _around(rows, down, all_rows), _around(columns, across, all_columns)

    def sum(self) -> Heightmap:
        """Return ground and detail in one, in as much memory as that takes."""
        ground, (across, down) = self.ground, self.steps
        heights = _between(_between(ground.heights, across, axis=1), down, axis=0)
        if self.detail is not None:
            rows, columns = (
                np.arange(extent) % period
                for extent, period in zip(self.shape, self.detail.shape, strict=True)
            )
            heights += self.detail.heights[np.ix_(rows, columns)]
        mask = ground.mask
        if mask is not None:
            mask = _reached(_reached(mask, across, axis=1), down, axis=0)
        return Heightmap(
            heights,
            spacing=self.spacing,
            origin=ground.origin,
            base=self.base,
            mask=mask,
            crs=ground.crs,
            units=ground.units,
            name=ground.name,
        )


def _steps(ground: Heightmap, detail: Heightmap) -> tuple[int, int]:
    """Return the samples of the detail a cell of the ground, or say why it does not fit."""
    if not isinstance(detail, Heightmap):
        raise InputError(f"expected detail as a Heightmap, got {type(detail).__name__}")
    if detail.mask is not None:
        raise InputError(
            f"expected detail with data everywhere, got {int(detail.mask.sum())} of "
            f"{detail.mask.size} samples without: set them to 0, which adds nothing"
        )
    if detail.crs not in (None, ground.crs):
        raise InputError(
            f"expected detail without a CRS, or in the ground's ({ground.crs}), got {detail.crs}"
        )
    ratios = np.divide(ground.spacing, detail.spacing)
    across, down = (max(round(ratio), 1) for ratio in ratios)
    if max(abs(ratios[0] - across), abs(ratios[1] - down)) > _NEAR * max(across, down):
        (dx, dy), (fine_x, fine_y) = ground.spacing, detail.spacing
        raise InputError(
            f"expected detail whose spacing divides the ground's, {dx:g} x {dy:g}, by whole "
            f"numbers, got {fine_x:g} x {fine_y:g}"
        )
    return across, down


def _require_float32(ground: Heightmap, detail: Heightmap) -> None:
    """Refuse sums, and differences of neighbours, beyond float32's range."""
    highest, added = (float(np.abs(part.heights).max()) for part in (ground, detail))
    if 2 * highest + added > float(np.finfo(np.float32).max):
        raise InputError(
            "expected sums of ground and detail that float32 can hold, got heights up to "
            f"{highest:g} and {added:g}"
        )


def _around(part: slice, steps: int, extent: int) -> slice:
    return slice(max((part.start - 1) * steps + 1, 0), min(part.stop * steps, extent))


def _neighbours(extent: int, steps: int) -> tuple[npt.NDArray[np.intp], ...]:
    """Return the sample at or before each one in between, the one at or after, steps from one."""
    before, step = np.divmod(np.arange((extent - 1) * steps + 1), steps)
    return before, before + (step > 0), step


def _between(heights: npt.NDArray[np.float32], steps: int, axis: int) -> npt.NDArray[np.float32]:
    """Return `heights` with so many steps a cell along `axis`; kernels round as this does."""
    before, after, step = _neighbours(heights.shape[axis], steps)
    share = step.astype(np.float32) * np.float32(1 / steps)
    low, high = heights.take(before, axis), heights.take(after, axis)
    high -= low
    high *= share if axis == 1 else share[:, None]
    return np.add(low, high, out=low)


def _reached(mask: npt.NDArray[np.bool_], steps: int, axis: int) -> npt.NDArray[Any]:
    """Return where a sample in between needs one of `mask`."""
    before, after, _ = _neighbours(mask.shape[axis], steps)
    return mask.take(before, axis) | mask.take(after, axis)
