"""A file of heights as a source; what GDAL and NumPy read is read window by window."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np

from ..files.rasters.formats import format_of, read_tiff
from ..files.rasters.loading import read_raster
from ..files.rasters.parts import Part
from ..files.rasters.raster import Raster
from ..files.rasters.readers_array import read_numpy
from ..files.rasters.readers_gdal import Extent, extent_gdal, has_rasterio, read_gdal
from ..files.rasters.reading import Reading, reading_of
from .source import Heights, fingerprint_of_files, heights_of, is_exact, virtual


@dataclass(frozen=True)
class RasterFile:
    """A file that `load` reads, too; see :class:`~terrain_lod.sources.source.Source`.

    Attributes
    ----------
    path : pathlib.Path
    band : int or None
    shape : (int, int)
    reading : Reading
    is_exact : bool
    is_southern_first : bool
        Whether the file's row 0 is the southernmost one.
    """

    path: Path
    band: int | None
    shape: tuple[int, int]
    reading: Reading
    is_exact: bool
    is_southern_first: bool

    @classmethod
    def of(cls, path: Path, *, band: int | None = None, **options: Any) -> RasterFile:
        """Look at the header of a file; the options are those of :func:`terrain_lod.load`."""
        header, southern = header_of(path, band)
        reading = reading_of(header, format_of(path)[1], **options)
        rows, columns = header.values.shape
        exact = is_exact(reading, header)
        return cls(path.absolute(), band, (rows, columns), reading, exact, southern)

    def read(self, rows: slice, columns: slice) -> Heights:
        if self.is_southern_first:
            last = self.shape[0]
            in_file = slice(last - rows.stop, last - rows.start)
        else:
            in_file = rows
        raster = _window(self.path, self.band, in_file, columns)
        return heights_of(self.reading, raster, rows.start, columns.start)

    def fingerprint(self) -> str:
        return fingerprint_of_files(files_of(self.path), (self.band, self.reading))


def header_of(path: Path, band: int | None) -> tuple[Raster, bool]:
    """Return what a file says of itself, its values but a shape, and whether it begins southmost.

    Where a file is no use window by window, all of it is read, and remembered.
    """
    form, _ = format_of(path)
    extent = _extent(path, band)
    if extent is None:
        return _whole(path, band, _stamp(path)), False
    # its place, read with its first samples; what begins in the south was turned around
    first = read_raster(form, path, Part.of(None, (0, 0, 2, 2), None, band))
    header = replace(first, values=virtual(extent.shape, extent.dtype), mask=None)
    if extent.is_southern_first and first.origin is not None and first.step is not None:
        north = first.origin[1] + (extent.shape[0] - 2) * first.step[1]
        header = replace(header, origin=(first.origin[0], north))
    return header, extent.is_southern_first


def _extent(path: Path, band: int | None) -> Extent | None:
    """Return how much a file holds, None if it is read as a whole or not at all."""
    form, _ = format_of(path)
    if form.read is read_gdal or (form.read is read_tiff and has_rasterio()):
        return extent_gdal(path, Part.of(None, None, None, band))
    if form.read is read_numpy and path.suffix.lower() == ".npy":
        values = np.load(path, mmap_mode="r")
        return Extent(values.shape, values.dtype, False) if values.ndim == 2 else None
    return None


def _window(path: Path, band: int | None, rows: slice, columns: slice) -> Raster:
    if _extent(path, band) is None:
        whole = _whole(path, band, _stamp(path))
        mask = None if whole.mask is None else whole.mask[rows, columns]
        return replace(whole, values=whole.values[rows, columns], mask=mask)
    height, width = rows.stop - rows.start, columns.stop - columns.start
    part = Part.of(None, (columns.start, rows.start, width, height), None, band)
    return read_raster(format_of(path)[0], path, part)


@lru_cache(maxsize=2)
def _whole(path: Path, band: int | None, stamp: int) -> Raster:
    return read_raster(format_of(path)[0], path, Part.of(None, None, None, band))


def _stamp(path: Path) -> int:
    return path.stat().st_mtime_ns


def files_of(path: Path) -> list[Path]:
    """Return a file, and those that it only names, as a virtual raster of GDAL does."""
    if path.suffix.lower() != ".vrt":
        return [path]
    try:
        named = ElementTree.parse(path).iter("SourceFilename")
        inner = [
            path.parent / (entry.text or "") if entry.get("relativeToVRT") == "1"
            else Path(entry.text or "")
            for entry in named
        ]  # fmt: skip
    except ElementTree.ParseError:
        return [path]
    return [path, *sorted({file for file in inner if file.is_file()})]
