"""Samples in the world by a linear rule, which has to run eastwards and north or south."""

from __future__ import annotations

import math
from dataclasses import replace

from ...errors import InputError
from .parts import Bounds, Part
from .raster import Raster

# (a, b, x0, d, e, y0): a sample stands at x = x0 + a column + b row, y = y0 + d column + e row
Affine = tuple[float, float, float, float, float, float]

# no sample of a raster taken for upright is further off than this part of a cell
_UPRIGHT = 0.01


def require_upright(affine: Affine, shape: tuple[int, int], name: str) -> None:
    """Refuse a raster that is rotated or mirrored."""
    a, b, _, d, e, _ = affine
    rows, columns = shape
    turned = abs(b) * rows > _UPRIGHT * abs(a) or abs(d) * columns > _UPRIGHT * abs(e)
    if not all(map(math.isfinite, affine)) or turned or a <= 0 or e == 0:
        raise InputError(
            f"expected a north-up raster, got a rotated or mirrored one in {name}: "
            "straighten it with gdalwarp"
        )


def first_and_steps(affine: Affine | None) -> Bounds | None:
    """Return x and y of the first sample of an upright raster, and the steps from it."""
    return None if affine is None else (affine[2], affine[5], affine[0], affine[4])


def moved(affine: Affine, rows: slice, columns: slice) -> Affine:
    """Return the affine of a part, whose first sample is another."""
    a, b, x0, d, e, y0 = affine
    row, column = rows.start, columns.start
    return a, b, x0 + a * column + b * row, d, e, y0 + d * column + e * row


def part_of(raster: Raster, affine: Affine | None, part: Part, name: str) -> Raster:
    """Return a part of a raster that is in memory, in its place; counted as in the file."""
    if affine is None:
        return part.cut(raster, name)
    require_upright(affine, raster.values.shape, name)
    rows, columns = part.slices(raster.values.shape, first_and_steps(affine), name)
    mask = None if raster.mask is None else raster.mask[rows, columns]
    raster = replace(raster, values=raster.values[rows, columns], mask=mask)
    return placed(raster, moved(affine, rows, columns), name)


def placed(raster: Raster, affine: Affine, name: str) -> Raster:
    """Return `raster` with step and origin, its rows turned to begin in the north."""
    require_upright(affine, raster.values.shape, name)
    a, _, x0, _, e, y0 = affine
    if e > 0:
        mask = None if raster.mask is None else raster.mask[::-1]
        y0 += e * (len(raster.values) - 1)
        raster = replace(raster, values=raster.values[::-1], mask=mask)
    return replace(raster, step=(a, abs(e)), origin=(x0, y0))
