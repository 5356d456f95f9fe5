"""How the numbers of a file become heights, and where these stand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ...arguments import finite, numbers
from ...errors import InputError
from .nodata import is_nodata
from .place import Spacing, height_factor, place_of
from .raster import Raster


@dataclass(frozen=True)
class Reading:
    """What is the same for every part of a raster.

    Attributes
    ----------
    spacing, origin : (float, float)
        Of the ground, in the unit of x and y.
    crs : str or None
    units : (str, str)
    nodata : float or None
        The value that stands for no data, besides the masks of parts.
    factor : float
        What brings unpacked numbers to the unit of heights.
    height_range : (float, float) or None
        Heights of the least and the greatest number, in place of all that.
    metres : float or None
        What one of the file's numbers is in metres; None if it has a height range.
    name : str
    notes : tuple of str
        What a user ought to be warned of.
    """

    spacing: tuple[float, float]
    origin: tuple[float, float]
    crs: str | None
    units: tuple[str, str]
    nodata: float | None
    factor: float
    height_range: tuple[float, float] | None
    metres: float | None
    name: str
    notes: tuple[str, ...]

    def holes(self, raster: Raster) -> npt.NDArray[np.bool_] | None:
        """Return where a part's own mask or the nodata value is, None if it can be nowhere."""
        if self.nodata is None:
            return raster.mask
        hole = is_nodata(raster.values, self.nodata)
        return hole if raster.mask is None else hole | raster.mask

    def heights(self, raster: Raster) -> npt.NDArray[Any]:
        """Return a part's heights in their unit: unpacked, and brought to another unit."""
        if self.height_range is not None:
            low, high = self.height_range
            least, most = np.iinfo(raster.values.dtype).min, np.iinfo(raster.values.dtype).max
            return low + (raster.values - float(least)) * ((high - low) / (float(most) - least))
        if self.is_plain(raster):
            return raster.values
        # what stands in a hole may pass float64's range
        with np.errstate(over="ignore", invalid="ignore"):
            return (raster.values * raster.scale + raster.offset) * self.factor

    def is_plain(self, raster: Raster) -> bool:
        """Whether a number of the file is a height as it is."""
        packed = (raster.scale, raster.offset, self.factor) != (1, 0, 1)
        return self.height_range is None and not packed


def reading_of(
    raster: Raster,
    name: str,
    *,
    spacing: Spacing | None = None,
    height_range: tuple[float, float] | None = None,
    nodata: float | None = None,
    z_unit: str | None = None,
    z_scale: float | None = None,
) -> Reading:
    """Return how a raster is read; of its values, shape and type alone are looked at.

    The options are those of :func:`terrain_lod.load`.

    Raises
    ------
    InputError
        If it is no raster, or an option is out of range.
    """
    if raster.values.ndim != 2 or min(raster.values.shape) < 2:
        raise InputError(
            f"expected heights of at least 2 x 2 samples, got shape {raster.values.shape}"
        )
    value = raster.nodata if nodata is None else nodata
    # it may be infinite, or NaN
    if value is not None and not isinstance(value, float | np.floating):
        value = finite("nodata", value)
    place = place_of(raster, name, spacing)
    notes, factor, metres = raster.notes + place.notes, 1.0, None
    if height_range is not None:
        height_range = _checked_range(raster, name, height_range)
    else:
        factor, doubts = height_factor(raster, place.unit, name, z_unit, z_scale)
        notes += doubts
        metres = abs(factor * raster.scale) * place.unit.metres or 1.0
    # a vertical CRS does not hold of heights that were brought to another unit
    compound = raster.system.height_unit not in (None, place.unit)
    return Reading(
        place.spacing,
        place.origin,
        raster.system.horizontal if compound and place.crs == raster.system.crs else place.crs,
        (place.unit.name, place.unit.name),
        None if value is None else float(value),
        factor,
        height_range,
        metres,
        name,
        notes,
    )


def _checked_range(
    raster: Raster, name: str, height_range: tuple[float, float]
) -> tuple[float, float]:
    """Return the heights that the whole range of the integers is laid over."""
    low, high = numbers("height_range", height_range, "low", "high")
    if low >= high:
        raise InputError(f"expected height_range from low to high, got {low:g} to {high:g}")
    if raster.values.dtype.kind not in "iu":
        raise InputError(
            f"expected whole numbers for height_range to stretch, got {raster.values.dtype} "
            f"in {name}: its numbers are heights already"
        )
    return low, high
