"""Which part of a file is read."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ...arguments import numbers, parts, whole
from ...errors import InputError
from .raster import Raster

Bounds = tuple[float, float, float, float]
Window = tuple[int, int, int, int]

# samples that stand on an edge belong to it, whatever rounding says
_EDGE = 1e-6
_MOST = 2**31  # samples along a side


@dataclass(frozen=True)
class Part:
    """Which part of a file is read; `load` tells what each means."""

    bounds: Bounds | None = None
    window: Window | None = None
    overview: int | None = None
    band: int | None = None

    @classmethod
    def of(cls, bounds: object, window: object, overview: object, band: object) -> Part:
        """Return a part of what a caller gave, or say what is wrong with it."""
        if bounds is not None and window is not None:
            raise InputError("expected bounds or window, got both")
        return cls(
            None if bounds is None else _bounds(bounds),
            None if window is None else _window(window),
            None if overview is None else whole("overview", overview, 0, 64),
            None if band is None else whole("band", band, 1, 65_535),
        )

    @property
    def is_all(self) -> bool:
        return self.bounds is None and self.window is None

    def slices(
        self, shape: tuple[int, int], place: Bounds | None, name: str
    ) -> tuple[slice, slice]:
        """Return the rows and columns of this part of a raster of `shape`.

        Parameters
        ----------
        place : (float, float, float, float) or None
            x and y of the first sample, and the steps to the next column and row.
        """
        rows, columns = shape
        if self.window is not None:
            column, row, width, height = self.window
            part = slice(row, row + height), slice(column, column + width)
            if part[0].stop > rows or part[1].stop > columns:
                raise InputError(
                    f"expected a window within {columns:,} x {rows:,} samples in {name}, got "
                    f"columns {column} to {column + width}, rows {row} to {row + height}"
                )
            return part
        if self.bounds is None:
            return slice(0, rows), slice(0, columns)
        if place is None:
            raise InputError(
                f"expected a file that says where it is with bounds=, got {name}: give window="
            )
        west, south, east, north = self.bounds
        x, y, dx, dy = place
        across, down = _within(west, east, x, dx, columns), _within(south, north, y, dy, rows)
        if min(across.stop - across.start, down.stop - down.start) < 2:
            left, right = sorted((x, x + dx * (columns - 1)))
            low, high = sorted((y, y + dy * (rows - 1)))
            raise InputError(
                f"expected bounds with at least 2 x 2 samples of {name}, which reaches from "
                f"({left:.10g}, {low:.10g}) to ({right:.10g}, {high:.10g}), got "
                f"({west:.10g}, {south:.10g}) to ({east:.10g}, {north:.10g})"
            )
        return down, across

    def cut(self, raster: Raster, name: str) -> Raster:
        """Return this part of a raster that has been read as a whole."""
        if self.overview is not None:
            raise InputError(f"expected a file with overviews for overview=, got {name}, which "
                             "has none")  # fmt: skip
        if self.is_all or raster.values.ndim != 2:
            return raster
        place = None
        if raster.step is not None and raster.origin is not None:
            place = (*raster.origin, raster.step[0], -raster.step[1])
        rows, columns = self.slices(raster.values.shape, place, name)
        mask = None if raster.mask is None else raster.mask[rows, columns]
        raster = replace(raster, values=raster.values[rows, columns], mask=mask)
        if place is None:
            return raster
        x, y, dx, dy = place
        return replace(raster, origin=(x + columns.start * dx, y + rows.start * dy))

    def require_one_band(self, name: str, count: int = 1) -> None:
        """Refuse a band that a file does not have."""
        if self.band is not None and self.band > count:
            raise InputError(f"expected a band from 1 to {count} in {name}, got {self.band}")


def _within(low: float, high: float, first: float, step: float, count: int) -> slice:
    """Return which of `count` places from `first` on lie between `low` and `high`."""
    ends = sorted(((low - first) / step, (high - first) / step))
    start, stop = math.ceil(ends[0] - _EDGE), math.floor(ends[1] + _EDGE) + 1
    start = min(max(start, 0), count)
    return slice(start, max(min(stop, count), start))


def _bounds(bounds: Any) -> Bounds:
    west, south, east, north = numbers("bounds", bounds, "west", "south", "east", "north")
    if west >= east or south >= north:
        raise InputError(
            f"expected bounds from west to east and south to north, got ({west:g}, {south:g}, "
            f"{east:g}, {north:g})"
        )
    return west, south, east, north


def _window(window: Any) -> Window:
    """Return column, row, width and height of a window in any of the forms that rasterio takes."""
    if hasattr(window, "flatten") and not isinstance(window, np.ndarray):
        window = window.flatten()
    if isinstance(window, tuple | list) and len(window) == 2:
        ends = [numbers("window", pair, "start", "stop") for pair in window]
        (row, row_stop), (column, column_stop) = ends
        window = column, row, column_stop - column, row_stop - row
    column, row, width, height = parts("window", window, "column", "row", "width", "height")
    column, row = (whole("window's start", number, 0, _MOST) for number in (column, row))
    width, height = (whole("window's size", number, 2, _MOST) for number in (width, height))
    return column, row, width, height
