"""Ground as tiles ask for it: heights in metres at longitudes and latitudes, samples by windows."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from ..ground.heightmap import Heightmap
from ..ground.units import unit_called
from .ellipsoid import Floats, radii
from .mapped import MappedGround
from .place import Place
from .schemes import Bounds

# samples looked at together: some 100 MB of what is worked out for each
_TOGETHER: Final = 1 << 20
# heights are bilinear as far beyond the last sample, in samples, as a lattice's step and this
_RIM: Final = 1.0


@dataclass(frozen=True, eq=False)
class Samples:
    """Samples of a part of the raster that have data, in any order.

    Attributes
    ----------
    rows, columns : (S,) int
        Of the raster.
    longitude, latitude, height : (S,) float64
    """

    rows: npt.NDArray[np.int64]
    columns: npt.NDArray[np.int64]
    longitude: Floats
    latitude: Floats
    height: Floats

    def chosen(self, which: npt.NDArray[np.bool_] | npt.NDArray[np.int64]) -> Samples:
        return Samples(*(values[which] for values in vars(self).values()))


@dataclass(frozen=True, eq=False)
class Source:
    """A ground on the Earth.

    Attributes
    ----------
    ground : Heightmap or MappedGround
    place : Place
        Of its x and y.
    metres : float
        A unit of its heights.
    filled : (R, C) float32
        Heights relative to the ground's base; where it has no data, that of the nearest sample.
    away : (R, C) float32 or None
        How far that is, in samples; None where data is everywhere.
    bounds : (west, south, east, north)
        Degrees that hold every sample.
    """

    ground: Heightmap | MappedGround
    place: Place
    metres: float
    filled: npt.NDArray[np.float32]
    away: npt.NDArray[np.float32] | None
    bounds: Bounds

    @classmethod
    def of(cls, ground: Heightmap | MappedGround) -> Source:
        """Find out where a ground is.

        Raises
        ------
        InputError
            If it has no CRS, lies at a pole or across the 180th meridian, or its heights have a
            unit that nobody knows.
        """
        place = Place.of(ground.crs)
        unit = unit_called(ground.units[1])
        if unit is None:
            raise InputError(f"expected heights in a known unit, got {ground.units[1]!r}")
        filled, away = ground.heights, None
        if ground.mask is not None:
            from scipy.ndimage import distance_transform_edt

            distance, nearest = distance_transform_edt(ground.mask, return_indices=True)
            filled, away = ground.heights[tuple(nearest)], distance.astype(np.float32)
        return cls(ground, place, unit.metres, filled, away, _bounds(ground, place))

    def __reduce__(self) -> tuple[Callable[[Heightmap | MappedGround], Source], tuple[Any]]:
        # a mapped ground is not sent, but mapped anew; what is filled is worked out
        return Source.of, (self.ground,)

    @property
    def step(self) -> float:
        """Metres on the Earth between samples in the middle of the ground, of both axes."""
        rows, columns = self.ground.shape
        row = np.array([rows // 2, rows // 2, rows // 2 - 1], np.float64)
        column = np.array([columns // 2, columns // 2 - 1, columns // 2], np.float64)
        lon, lat = self.degrees(row, column)
        east, north = radii(lat)
        lengths = np.hypot((lon[1:] - lon[0]) * east[0], (lat[1:] - lat[0]) * north[0])
        return float(np.sqrt(lengths[0] * lengths[1]))

    @property
    def height_range(self) -> tuple[float, float]:
        low, high = self.ground.height_range
        return low * self.metres, high * self.metres

    def degrees(self, rows: Floats, columns: Floats) -> tuple[Floats, Floats]:
        """Return longitudes and latitudes of places on the raster."""
        (x, y), (dx, dy) = self.ground.origin, self.ground.spacing
        return self.place.to_degrees(x + columns * dx, y - rows * dy)

    def pixels(self, longitude: Floats, latitude: Floats) -> tuple[Floats, Floats]:
        """Return rows and columns, with fractions, of places on the Earth."""
        (x, y), (dx, dy) = self.ground.origin, self.ground.spacing
        east, north = self.place.from_degrees(longitude, latitude)
        return (y - north) / dy, (east - x) / dx

    def heights(self, longitude: Floats, latitude: Floats, reach: float) -> Floats:
        """Return heights in metres, bilinear between samples; NaN where there are none.

        Beyond the raster's border, and in holes, the nearest sample counts as far as `reach`
        samples and one more. What is returned for a place depends on that place alone.
        """
        rows, columns = self.pixels(longitude, latitude)
        last_row, last_column = self.ground.shape[0] - 1, self.ground.shape[1] - 1
        far = reach + _RIM
        with np.errstate(invalid="ignore"):
            there = (rows >= -far) & (rows <= last_row + far)
            there &= (columns >= -far) & (columns <= last_column + far)
        rows = np.clip(np.where(there, rows, 0.0), 0, last_row)
        columns = np.clip(np.where(there, columns, 0.0), 0, last_column)
        row = np.minimum(rows.astype(np.int64), last_row - 1)
        column = np.minimum(columns.astype(np.int64), last_column - 1)
        down, across = rows - row, columns - column
        index = row * (last_column + 1) + column
        north = self._taken(index) * (1 - across) + self._taken(index + 1) * across
        index += last_column + 1
        south = self._taken(index) * (1 - across) + self._taken(index + 1) * across
        heights = (self.ground.base + north * (1 - down) + south * down) * self.metres
        if self.away is not None:
            nearest = np.rint(rows).astype(np.int64), np.rint(columns).astype(np.int64)
            there &= self.away[nearest] <= far
        heights[~there] = np.nan
        return np.asarray(heights)

    def _taken(self, numbers: npt.NDArray[np.int64]) -> npt.NDArray[np.float32]:
        """Return filled heights of samples that are numbered row by row."""
        if isinstance(self.ground, MappedGround):
            return self.ground.take(numbers)
        return np.asarray(self.filled.reshape(-1)[numbers])

    def samples(self, bounds: Bounds) -> Iterator[Samples]:
        """Yield the samples within `bounds`, its edges included, in parts of a limited size."""
        first, stop = self._window(bounds)
        west, south, east, north = bounds
        together = max(_TOGETHER // max(stop[1] - first[1], 1), 1)
        for top in range(first[0], stop[0], together):
            part = slice(top, min(top + together, stop[0])), slice(first[1], stop[1])
            row, column = np.mgrid[part]
            lon, lat = self.degrees(row.astype(np.float64), column.astype(np.float64))
            inside = (lon >= west) & (lon <= east) & (lat >= south) & (lat <= north)
            if self.ground.mask is not None:
                inside &= ~self.ground.mask[part]
            if inside.any():
                heights = self.ground.heights[part][inside].astype(np.float64)
                heights = (heights + self.ground.base) * self.metres
                if isinstance(self.ground, MappedGround):
                    self.ground.release()
                yield Samples(row[inside], column[inside], lon[inside], lat[inside], heights)

    def _window(self, bounds: Bounds) -> tuple[tuple[int, int], tuple[int, int]]:
        """Return the first row and column, and the ends, of a window that holds all of `bounds`."""
        west, south, east, north = (
            max(bounds[0], self.bounds[0]),
            max(bounds[1], self.bounds[1]),
            min(bounds[2], self.bounds[2]),
            min(bounds[3], self.bounds[3]),
        )
        if west > east or south > north:
            return (0, 0), (0, 0)
        share = np.linspace(0, 1, 33)
        lon, lat = np.meshgrid(west + (east - west) * share, south + (north - south) * share)
        rows, columns = self.pixels(lon, lat)
        first, stop = [], []
        for places, extent in zip((rows, columns), self.ground.shape, strict=True):
            low, high = float(np.nanmin(places)), float(np.nanmax(places))
            # an outline that bends between the points looked at
            spare = 2 + 0.01 * (high - low)
            first.append(int(np.clip(np.floor(low - spare), 0, extent)))
            stop.append(int(np.clip(np.ceil(high + spare) + 1, 0, extent)))
        return (first[0], first[1]), (stop[0], stop[1])


def _bounds(ground: Heightmap | MappedGround, place: Place) -> Bounds:
    """Return the degrees that hold the raster, or say why there are none."""
    rows, columns = ground.shape
    (x, y), (dx, dy) = ground.origin, ground.spacing
    share = np.linspace(0, 1, 257)
    grid = np.meshgrid(x + share * (columns - 1) * dx, y - share * (rows - 1) * dy)
    lon, lat = place.to_degrees(*grid)
    if not (np.isfinite(lon).all() and np.isfinite(lat).all()):
        raise InputError(
            f"expected ground within what {place.name[:60]} maps, got some beyond it: "
            "is its CRS the right one?"
        )
    if np.abs(lat).max() > 89.9:
        raise InputError(
            f"expected ground between latitudes -89.9 and 89.9, got {lat.min():.3f} to "
            f"{lat.max():.3f}: tiles meet in one point at a pole; take a part that leaves it out"
        )
    jumps = max(np.abs(np.diff(lon, axis=axis)).max() for axis in (0, 1))
    if jumps > 180 or lon.min() < -180 or lon.max() > 180:
        raise InputError(
            "expected ground that does not cross the 180th meridian, got "
            f"longitudes {lon.min():.3f} to {lon.max():.3f}: take the parts of both sides"
        )
    # what bends between the points looked at is less than a hundredth of their distance
    rim = 0.01 / 256 * max(float(np.ptp(lon)), float(np.ptp(lat)))
    return (
        max(float(lon.min()) - rim, -180.0),
        max(float(lat.min()) - rim, -90.0),
        min(float(lon.max()) + rim, 180.0),
        min(float(lat.max()) + rim, 90.0),
    )
