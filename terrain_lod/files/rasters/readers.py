"""Files of plain arrays: what a file of heights says, format by format.

A reader is one function from a path to a `Raster`; ``loading.FORMATS`` says which endings it
reads. It raises `InputError` where the content makes no ground and lets errors of the operating
system and of libraries pass: ``loading`` turns those into one line.
"""

from __future__ import annotations

import gzip
import re
import warnings
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ...errors import FileError, InputError


@dataclass(frozen=True, eq=False)
class Raster:
    """What a file says, before it is ground.

    Attributes
    ----------
    values : (R, C), any dtype
        Samples, row 0 north.
    step : (float, float) or None
        Distance between samples along x and y in the file's unit; None if the file does not say.
    origin : (float, float) or None
        x and y of sample [0, 0] in the file's unit; None if the file does not say.
    nodata : float or None
        The value that stands for no data.
    mask : (R, C) bool or None
        True where there is no data, besides `nodata`.
    crs : str or None
        Coordinate reference system of `origin` and `step`, an authority code or WKT.
    degrees : bool
        True if `origin` and `step` are longitude and latitude.
    """

    values: npt.NDArray[Any]
    step: tuple[float, float] | None = None
    origin: tuple[float, float] | None = None
    nodata: float | None = None
    mask: npt.NDArray[np.bool_] | None = None
    crs: str | None = None
    degrees: bool = False


# what people call the heights among other arrays
HEIGHT_NAMES: Final = ("heights", "height", "elevation", "dem", "z")


def read_numpy(path: Path) -> Raster:
    """Read an array, or of an archive the only 2-D array of numbers or the one named as heights."""
    with path.open("rb") as file:
        content = np.load(file, allow_pickle=False)
        if isinstance(content, np.ndarray):
            return Raster(content)
        arrays = {key: content[key] for key in content.files}
    grids = [key for key, array in arrays.items() if array.ndim == 2 and array.dtype.kind in "iuf"]
    if len(grids) != 1:
        grids = [key for key in HEIGHT_NAMES if key in grids][:1]
    if not grids:
        found = ", ".join(f"{key} {array.shape}" for key, array in arrays.items()) or "nothing"
        raise InputError(
            f"expected one 2-D array of heights in {path.name}, or one named "
            f"{' or '.join(HEIGHT_NAMES)}; got {found}"
        )
    return Raster(arrays[grids[0]])


# SRTM by size in bytes; 16-bit samples, both edges of the degree included. Tiles beyond 50 degrees
# north or south may have half the columns.
HGT_SHAPES: Final = {2 * r * c: (r, c) for r, c in ((1201, 1201), (3601, 3601), (3601, 1801))}
HGT_NODATA: Final = -32768
HGT_NAME: Final = re.compile(r"([NS])(\d\d)([EW])(\d\d\d)", re.IGNORECASE)


def read_hgt(path: Path) -> Raster:
    """Read an SRTM tile of one degree, plain, gzipped or zipped.

    Big-endian int16 metres, row by row from the north; the name, as N46E007, says where its
    south-western sample stands (USGS, "SRTM Topography", 2015, section 2.1).
    """
    data = _hgt_bytes(path)
    if len(data) not in HGT_SHAPES:
        sizes = ", ".join(str(size) for size in HGT_SHAPES)
        raise FileError(
            f"expected an SRTM tile of {sizes} bytes, got {len(data)} in {path.name}: truncated?"
        )
    rows, columns = HGT_SHAPES[len(data)]
    # float32 holds every int16, and says that these are metres already
    values = np.frombuffer(data, ">i2").reshape(rows, columns).astype(np.float32)
    step = 1 / (columns - 1), 1 / (rows - 1)
    place = HGT_NAME.match(path.name)
    if place is None:
        return Raster(values, step, None, HGT_NODATA, degrees=True)
    south = int(place[2]) * (1 if place[1] in "Nn" else -1)
    west = int(place[4]) * (1 if place[3] in "Ee" else -1)
    return Raster(values, step, (west, south + 1.0), HGT_NODATA, crs="EPSG:4326", degrees=True)


def _hgt_bytes(path: Path) -> bytes:
    """Return the samples, unpacked."""
    if path.suffix.lower() == ".gz":
        with gzip.open(path) as file:
            return file.read()
    if path.suffix.lower() == ".zip":
        with zipfile.ZipFile(path) as archive:
            members = [name for name in archive.namelist() if name.lower().endswith(".hgt")]
            if len(members) != 1:
                raise InputError(
                    f"expected one .hgt file in {path.name}, got {', '.join(members) or 'none'}"
                )
            return archive.read(members[0])
    return path.read_bytes()


ASC_ENTRY: Final = re.compile(
    r"\s*(ncols|nrows|[xy]ll(?:corner|center)|cellsize|dx|dy|nodata_value)\s+(\S+)", re.IGNORECASE
)
ASC_NODATA: Final = -9999.0  # where the header has none
GEOGRAPHIC: Final = re.compile(r"\s*(GEOGCS|GEOGCRS|GEODCRS|Projection\s+GEOGRAPHIC)", re.I)


def read_asc(path: Path) -> Raster:
    """Read an ESRI ASCII grid; a .prj file beside it names the coordinate reference system."""
    text = path.read_text(encoding="latin-1")
    header: dict[str, float] = {}
    start = 0
    while entry := ASC_ENTRY.match(text, start):
        header[entry[1].lower()] = float(entry[2])
        start = entry.end()

    def number(*keys: str) -> float:
        for key in keys:
            if key in header:
                return header[key]
        raise InputError(f"expected {' or '.join(keys)} in the header of {path.name}, got none")

    rows, columns = int(number("nrows")), int(number("ncols"))
    dx, dy = number("dx", "cellsize"), number("dy", "cellsize")
    # a corner is the corner of a cell, half a cell from the sample in its middle
    west = number("xllcenter", "xllcorner") + (0 if "xllcenter" in header else dx / 2)
    south = number("yllcenter", "yllcorner") + (0 if "yllcenter" in header else dy / 2)
    values = _numbers(text[start:], path.name)
    if values.size != rows * columns:
        raise FileError(
            f"expected {rows} x {columns} = {rows * columns} heights in {path.name}, "
            f"got {values.size}: truncated?"
        )
    prj = path.with_suffix(".prj")
    crs = prj.read_text(encoding="latin-1").strip() if prj.is_file() else None
    return Raster(
        values.reshape(rows, columns),
        (dx, dy),
        (west, south + (rows - 1) * dy),
        header.get("nodata_value", ASC_NODATA),
        crs=crs,
        degrees=crs is not None and GEOGRAPHIC.match(crs) is not None,
    )


def _numbers(text: str, name: str) -> npt.NDArray[np.float64]:
    """Return the numbers in `text`, which holds nothing else."""
    with warnings.catch_warnings():
        # older numpy only warns where a word is no number
        warnings.simplefilter("error", DeprecationWarning)
        try:
            return np.fromstring(text, np.float64, sep=" ")
        except (ValueError, DeprecationWarning):
            pass
    word = next(word for word in text.split() if not _is_number(word))
    raise InputError(f"expected only numbers after the header of {name}, got {word[:40]!r}")


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
