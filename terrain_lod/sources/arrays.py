"""Arrays as sources: NumPy's in memory or mapped, xarray's, dask's, and whatever is like them."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from ..errors import InputError
from ..files.rasters import mercator
from ..files.rasters.raster import Raster
from ..files.rasters.readers_gdal import system_called
from ..files.rasters.reading import Reading, reading_of
from ..files.rasters.wkt import System, system_of
from ..ground.heightmap import Heightmap
from .source import Heights, fingerprint_of_files, heights_of, is_exact, virtual

# steps between coordinates that are called even differ by less than this part of one
_EVEN: Final = 1e-3
# windows of an array that is looked at to tell it from another
_PROBES: Final = 8


@dataclass(frozen=True, eq=False)
class Array:
    """An array of two dimensions; see :class:`~terrain_lod.sources.source.Source`.

    Attributes
    ----------
    values : array
        Whatever has a shape, a type, and gives windows.
    shape : (int, int)
    reading : Reading
    is_exact : bool
    is_southern_first : bool
        Whether row 0 is the southernmost one.
    """

    values: Any
    shape: tuple[int, int]
    reading: Reading
    is_exact: bool
    is_southern_first: bool = False

    @classmethod
    def of(cls, values: Any, **options: Any) -> Array:
        """Take an array; the options are those of :func:`terrain_lod.load`."""
        labelled = hasattr(values, "coords") and hasattr(values, "dims")
        name = str(getattr(values, "name", None) or "ground")
        if labelled:
            # a band by itself, as rioxarray has it, is no dimension of the ground
            values = values.squeeze(drop=True)
        shape = tuple(int(extent) for extent in values.shape)
        header = virtual(shape, values.dtype)  # type: ignore[arg-type]
        raster, southern = (_header_of_labelled if labelled else _header)(values, header)
        reading = reading_of(raster, name, **options)
        data = values.data if labelled else values
        return cls(data, shape, reading, is_exact(reading, raster), southern)  # type: ignore[arg-type]

    def read(self, rows: slice, columns: slice) -> Heights:
        last = self.shape[0]
        inside = slice(last - rows.stop, last - rows.start) if self.is_southern_first else rows
        window = self.values[inside, columns]
        if hasattr(window, "compute"):
            # in this thread: whoever works here is one of many already
            window = window.compute(scheduler="synchronous")
        mask = np.ma.getmask(window)
        values = np.asarray(np.ma.getdata(window))
        if self.is_southern_first:
            values, mask = values[::-1], mask if mask is np.ma.nomask else mask[::-1]
        raster = Raster(values, mask=None if mask is np.ma.nomask else mask)
        return heights_of(self.reading, raster, rows.start, columns.start)

    def fingerprint(self) -> str:
        if isinstance(self.values, np.memmap) and self.values.filename is not None:
            return fingerprint_of_files([Path(self.values.filename)], self.reading)
        digest = hashlib.sha256(repr((self.shape, self.reading)).encode())
        rows, columns = (
            [int(place) for place in np.linspace(0, extent - 2, _PROBES)] for extent in self.shape
        )
        for row, column in zip(rows, columns, strict=True):
            digest.update(self.read(slice(row, row + 2), slice(column, column + 2)).tobytes())
        return digest.hexdigest()

    def __getstate__(self) -> dict[str, Any]:
        """A map of a file is sent as its place in it, not as what it shows."""
        state = dict(vars(self))
        mapped = self.values
        if isinstance(mapped, np.memmap) and mapped.filename and mapped.flags.c_contiguous:
            place = str(mapped.filename), mapped.dtype, mapped.shape, mapped.offset
            state["values"] = _Mapped(*place)
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        if isinstance(state["values"], _Mapped):
            state["values"] = state["values"].open()
        vars(self).update(state)


@dataclass(frozen=True)
class _Mapped:
    """Where in a file a map of NumPy is."""

    path: str
    dtype: Any
    shape: tuple[int, int]
    offset: int

    def open(self) -> Any:
        return np.memmap(self.path, self.dtype, "r", self.offset, self.shape)


@dataclass(frozen=True, eq=False)
class Ground:
    """A heightmap that is in memory as a source."""

    ground: Heightmap

    @property
    def shape(self) -> tuple[int, int]:
        return self.ground.shape

    @property
    def reading(self) -> Reading:
        ground = self.ground
        return Reading(
            ground.spacing, ground.origin, ground.crs, ground.units, None, 1.0, None, None,
            ground.name, (),
        )  # fmt: skip

    @property
    def is_exact(self) -> bool:
        return self.ground.base == 0.0

    def read(self, rows: slice, columns: slice) -> Heights:
        ground = self.ground
        heights: Heights = ground.heights[rows, columns].copy()
        if ground.base:
            heights = heights + np.float64(ground.base)
        if ground.mask is not None:
            heights[ground.mask[rows, columns]] = np.nan
        return heights

    def fingerprint(self) -> str:
        digest = hashlib.sha256(repr((self.shape, self.reading, self.ground.base)).encode())
        digest.update(self.ground.heights.tobytes())
        if self.ground.mask is not None:
            digest.update(self.ground.mask.tobytes())
        return digest.hexdigest()


def _header(values: Any, header: Any) -> tuple[Raster, bool]:
    return Raster(header), False


def _header_of_labelled(values: Any, header: Any) -> tuple[Raster, bool]:
    """Return what an array of xarray says of itself."""
    if len(values.dims) != 2:
        raise InputError(
            f"expected an array of two dimensions, y and x, got {', '.join(map(str, values.dims))}:"
            " choose one with isel()"
        )
    down, across = (_step(values, dim) for dim in values.dims)
    system, attributes = _system(values), values.attrs
    nodata = attributes.get("_FillValue", attributes.get("missing_value"))
    unit = attributes.get("units")
    raster = Raster(header, nodata=nodata, height_unit=unit, system=system)
    if system.horizontal in mercator.CODES:
        raster = replace(raster, geographic=mercator.geographic)
    if down is None or across is None:
        return raster, False
    (y, dy), (x, dx) = down, across
    if dx <= 0:
        raise InputError(f"expected {values.dims[1]} to grow from west to east, got steps of {dx}")
    southern = dy > 0
    north = y + dy * (header.shape[0] - 1) if southern else y
    return replace(raster, step=(dx, abs(dy)), origin=(x, north)), southern


def _step(values: Any, dim: Any) -> tuple[float, float] | None:
    """Return the first coordinate along a dimension and the step from it, None if it has none."""
    if dim not in values.coords:
        return None
    places = np.asarray(values.coords[dim].values, np.float64)
    step = float(places[-1] - places[0]) / (len(places) - 1)
    even = places[0] + step * np.arange(len(places))
    if not step or np.abs(places - even).max() > _EVEN * abs(step):
        raise InputError(f"expected even steps along {dim}, got others: resample it")
    return float(places[0]), step


def _system(values: Any) -> System:
    """Return the coordinate reference system that rioxarray and CF conventions write."""
    place = values.coords.get("spatial_ref")
    text = place.attrs.get("crs_wkt") if place is not None else None
    named = values.attrs.get("crs")
    if not isinstance(named, str):
        named = None
    if isinstance(text, str):
        return system_of(text, named)
    return System() if named is None else system_called(named)
