"""Arrays as sources: NumPy's in memory or mapped, xarray's, dask's, and whatever is like them."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np

from ..files.rasters.affine import placed
from ..files.rasters.labelled import is_labelled, labelled, name_of
from ..files.rasters.raster import Raster
from ..files.rasters.reading import Reading, reading_of
from ..ground.heightmap import Heightmap
from .source import Heights, fingerprint_of_files, heights_of, is_exact, virtual

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
    scale, offset : float
        An unpacked number is ``scale * value + offset``.
    """

    values: Any
    shape: tuple[int, int]
    reading: Reading
    is_exact: bool
    is_southern_first: bool = False
    scale: float = 1.0
    offset: float = 0.0

    @classmethod
    def of(cls, values: Any, **options: Any) -> Array:
        """Take an array; the options are those of :func:`terrain_lod.load`."""
        southern, name = False, name_of(values)
        if is_labelled(values):
            array, raster, affine = labelled(values)
            if affine is not None:
                raster, southern = placed(raster, affine, name), affine[4] > 0
            values = array.data
        else:
            raster = Raster(virtual(tuple(values.shape), values.dtype))
        reading = reading_of(raster, name, **options)
        rows, columns = (int(extent) for extent in values.shape)
        return cls(
            values, (rows, columns), reading, is_exact(reading, raster), southern,
            raster.scale, raster.offset,
        )  # fmt: skip

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
        mask = None if mask is np.ma.nomask else mask
        raster = Raster(values, mask=mask, scale=self.scale, offset=self.offset)
        return heights_of(self.reading, raster, rows.start, columns.start)

    def fingerprint(self) -> str:
        if isinstance(self.values, np.memmap) and self.values.filename is not None:
            return fingerprint_of_files([Path(self.values.filename)], self.reading)
        said = self.shape, self.reading, self.scale, self.offset
        digest = hashlib.sha256(repr(said).encode())
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
