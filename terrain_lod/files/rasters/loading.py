"""Heights from a file: one row of `FORMATS` and one reader for each kind of file."""

from __future__ import annotations

import os
import struct
import warnings
import zipfile
import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from ...arguments import finite, positive
from ...errors import FileError, InputError, TerrainError
from ...ground.heightmap import Heightmap
from .degrees import local_metres
from .readers import (
    Raster,
    read_asc,
    read_hgt,
    read_numpy,
)
from .readers_geo import read_gdal, read_tiff
from .readers_image import read_image


@dataclass(frozen=True)
class Format:
    """A kind of file: its title, the endings of its names, and what reads it."""

    title: str
    endings: tuple[str, ...]
    read: Callable[[Path], Raster]


FORMATS: Final = (
    Format("a PNG image", (".png",), read_image),
    Format("a JPEG image", (".jpg", ".jpeg"), read_image),
    Format("a TIFF", (".tif", ".tiff"), read_tiff),
    Format("a NumPy array", (".npy", ".npz"), read_numpy),
    Format("an SRTM tile", (".hgt", ".hgt.gz", ".hgt.zip"), read_hgt),
    Format("an ESRI ASCII grid", (".asc",), read_asc),
    Format("a GDAL raster", (".vrt", ".img", ".bil"), read_gdal),
)

# what libraries raise where a file is not what its name says
UNREADABLE: Final = (
    OSError, EOFError, ValueError, SyntaxError, KeyError, struct.error, zlib.error,
    zipfile.BadZipFile,
)  # fmt: skip


def load(
    path: str | os.PathLike[str],
    *,
    spacing: float | tuple[float, float] | None = None,
    height_range: tuple[float, float] | None = None,
    nodata: float | None = None,
) -> Heightmap:
    """Load ground from a file of heights.

    ========================  =====================================================================
    .png, .tif                16 bits of grey; 8 bits with a warning; floating point (TIFF)
    .tif                      GeoTIFF: CRS, spacing, origin, nodata; shifted by half a cell where
                              its samples are the middles of cells
    .png, .tif                terrain-RGB of Mapbox or Terrarium, told apart by their colours
    .jpg                      8 bits of grey, with a warning
    .npy, .npz                an array; an archive's only 2-D array, or the one named ``heights``
    .hgt, .hgt.gz, .hgt.zip   SRTM, placed by its name; -32768 is nodata
    .asc                      ESRI ASCII, with the CRS of a .prj file beside it
    .vrt, .img, .bil          whatever GDAL reads, through rasterio
    ========================  =====================================================================

    What a file does not say is a spacing of 1, an origin of (0, 0) and no CRS.

    **Degrees.** A raster in longitude and latitude (.hgt, .asc or GeoTIFF alike) becomes local
    metres at its middle latitude; how much that bends it is logged, and it is refused where that
    is more than 5 % of an east-west length. Its origin is scaled alike, so that x and y divided by
    the metres per degree, which ``crs`` records, are longitude and latitude again. With `spacing`
    given, that decides instead. A raster without CRS whose numbers could be degrees or metres is
    refused until `spacing` is given.

    Parameters
    ----------
    path : str or path
    spacing : float or (float, float), optional
        Distance between samples along x and y in metres, instead of the file's.
    height_range : (float, float), optional
        Heights of the least and the greatest number that the file's integers can hold, such as
        those of 0 and 65535; without it a number is its height.
    nodata : float, optional
        The number in the file that stands for no data, instead of the file's.

    Returns
    -------
    Heightmap
        Named after the file, without its ending.

    Raises
    ------
    FileError
        If the file is missing, truncated or not what its ending says.
    InputError
        If its content is no ground: three channels that are not terrain-RGB, several bands, a
        rotated raster, fewer than 2 x 2 samples, infinities, no data at all; or an argument is out
        of range.
    MissingExtraError
        If the file needs rasterio and it is not installed.

    Warns
    -----
    UserWarning
        If the heights have 8 bits: slopes become stairs.
    """
    path = Path(path)
    form, name = _format_of(path)
    try:
        with warnings.catch_warnings():
            # what libraries mumble over a file is not for the user; what they raise is
            warnings.simplefilter("ignore")
            raster = form.read(path)
    except TerrainError:
        raise
    except UNREADABLE as error:
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise FileError(
            f"expected {form.title} in {path}, got a part of one or something else ({reason})"
        ) from error
    if raster.values.dtype.itemsize == 1:
        warnings.warn(
            f"{path.name} has 8-bit heights: 256 steps, so slopes become stairs; "
            "a 16-bit or floating-point file would not",
            stacklevel=2,
        )
    return ground_of(raster, name, spacing=spacing, height_range=height_range, nodata=nodata)


def ground_of(
    raster: Raster,
    name: str,
    *,
    spacing: float | tuple[float, float] | None = None,
    height_range: tuple[float, float] | None = None,
    nodata: float | None = None,
) -> Heightmap:
    """Return the ground that a file's content makes; arguments as `load`'s."""
    hole = _holes(raster, raster.nodata if nodata is None else nodata)
    heights = raster.values if height_range is None else _stretched(raster, name, height_range)
    given = None if spacing is None else _pair(spacing)
    origin, crs = raster.origin or (0.0, 0.0), raster.crs
    if raster.step is None:
        step = given or (1.0, 1.0)
    elif raster.degrees or _could_be_degrees(raster):
        step = given or _metres(raster, name)
        per_degree = step[0] / raster.step[0], step[1] / raster.step[1]
        origin = origin[0] * per_degree[0], origin[1] * per_degree[1]
        if raster.degrees:
            crs = _local(crs, per_degree)
    else:
        step = given or raster.step
    return Heightmap(heights, spacing=step, origin=origin, mask=hole, crs=crs, name=name)


def _format_of(path: Path) -> tuple[Format, str]:
    """Return what the ending of a file says it is, and its name without the ending."""
    if not path.is_file():
        found = "a folder" if path.is_dir() else "nothing"
        raise FileError(f"expected a file of heights, got {found} at {path}")
    for form in FORMATS:
        for ending in form.endings:
            if path.name.lower().endswith(ending):
                return form, path.name[: -len(ending)]
    known = ", ".join(sorted(ending for form in FORMATS for ending in form.endings))
    raise InputError(f"expected a file that ends in one of {known}, got {path.name}")


def _holes(raster: Raster, nodata: float | None) -> npt.NDArray[np.bool_] | None:
    """Return where the file's own mask or its nodata value is, None if it can be nowhere."""
    if nodata is None:
        return raster.mask
    try:
        value = float(nodata)
    except (TypeError, ValueError):
        raise InputError(f"expected a number for nodata, got {nodata!r}") from None
    # a value that float32 cannot hold is nowhere in a float32 raster
    with np.errstate(over="ignore"):
        hole: npt.NDArray[np.bool_] = raster.values == value
    return hole if raster.mask is None else hole | raster.mask


def _stretched(
    raster: Raster, name: str, height_range: tuple[float, float]
) -> npt.NDArray[np.float64]:
    """Return heights with the whole range of the integers laid over `height_range`."""
    if not isinstance(height_range, Iterable) or len(tuple(height_range)) != 2:
        raise InputError(f"expected height_range as (low, high), got {height_range!r}")
    low, high = (finite("height_range", height) for height in height_range)
    if low >= high:
        raise InputError(f"expected height_range from low to high, got {low:g} to {high:g}")
    if raster.values.dtype.kind not in "iu":
        raise InputError(
            f"expected whole numbers for height_range to stretch, got {raster.values.dtype} "
            f"in {name}: its numbers are heights already"
        )
    least, greatest = np.iinfo(raster.values.dtype).min, np.iinfo(raster.values.dtype).max
    return low + (raster.values - float(least)) * ((high - low) / (float(greatest) - least))


def _pair(spacing: float | tuple[float, float]) -> tuple[float, float]:
    pair = tuple(spacing) if isinstance(spacing, Iterable) else (spacing, spacing)
    if len(pair) != 2:
        raise InputError(f"expected one or two numbers for spacing, got {len(pair)}")
    return positive("spacing", pair[0]), positive("spacing", pair[1])


def _could_be_degrees(raster: Raster) -> bool:
    """Return whether a raster that names no CRS might as well be in degrees as in metres."""
    if raster.crs is not None or raster.step is None or raster.origin is None:
        return False
    (x, y), (dx, dy) = raster.origin, raster.step
    # steps of 72 arc-seconds or 2 cm, and numbers that are longitudes and latitudes
    return 0 < max(dx, dy) < 0.02 and -180 <= x <= 360 and -90 <= y <= 90


def _metres(raster: Raster, name: str) -> tuple[float, float]:
    """Return the spacing of a raster in degrees in local metres."""
    assert raster.step is not None
    if not raster.degrees:
        raise InputError(
            f"expected {name} to name its CRS, got none and steps of {raster.step[0]:g}, which "
            "could be degrees or metres: give spacing= in metres"
        )
    if raster.origin is None:
        raise InputError(
            f"expected a name such as N46E007.hgt that says where the tile is, got {name}: "
            "rename it, or give spacing= in metres"
        )
    return local_metres(raster.step, raster.origin[1], len(raster.values), name)


def _local(crs: str | None, per_degree: tuple[float, float]) -> str:
    """Return WKT for local metres that says how to get back to degrees."""
    of = f" of {crs}" if crs is not None and crs.startswith("EPSG:") else ""
    east, north = per_degree
    return f'LOCAL_CS["degrees{of} times {east:.6f} east, {north:.6f} north",UNIT["metre",1]]'
