"""Ground from a file of heights, or from an array of xarray."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

from ...arguments import file_path
from ...errors import FileError, InputError, TerrainError
from ...ground.heightmap import Heightmap
from .formats import Format, format_of
from .labelled import is_labelled, name_of, read_labelled
from .mercator import checked_tile, tile_of, with_tile
from .nodata import suspects
from .parts import Part
from .raster import Raster
from .reading import reading_of
from .reprojection import reprojected


def load(
    path: str | os.PathLike[str] | Any,
    *,
    spacing: float | tuple[float, float] | Literal["map"] | None = None,
    height_range: tuple[float, float] | None = None,
    nodata: float | None = None,
    bounds: tuple[float, float, float, float] | None = None,
    window: tuple[int, int, int, int] | None = None,
    overview: int | None = None,
    band: int | None = None,
    z_unit: str | None = None,
    z_scale: float | None = None,
    tile: tuple[int, int, int] | None = None,
    crs: str | None = None,
) -> Heightmap:
    """Load ground from a file of heights, or from an array of xarray.

    ========================  =====================================================================
    .png, .tif                16 bits of grey; 8 bits with a warning; floating point (TIFF)
    .tif                      GeoTIFF: CRS, units, spacing, origin, nodata; shifted by half a cell
                              where its samples are the middles of cells
    .png, .webp, .tif         terrain-RGB of Mapbox or Terrarium, told apart by their colours
    .jpg                      8 bits of grey, with a warning
    .npy, .npz                an array; an archive's only 2-D array, or the one named ``heights``
    .hgt, .hgt.gz, .hgt.zip   SRTM, placed by its name; -32768 is nodata
    .asc                      ESRI ASCII or GRASS ASCII, with the CRS of a .prj file beside it
    .vrt, .img, .bil, .dem,   whatever GDAL reads, through rasterio: these and all others, by what
    .dt2, .nc, .jp2, ...      is in them, whatever they are called
    .zip, .gz                 the same, packed; of an archive the only raster
    ========================  =====================================================================

    An ``xarray.DataArray`` is taken with what it says of itself: coordinates in even steps, rows
    from north to south or from south to north, ``_FillValue``, ``scale_factor`` and ``add_offset``,
    ``units`` of heights and of coordinates, and the CRS as WKT in ``spatial_ref`` or in the grid
    mapping that CF names. Of an array of dask, the chunks of the part are computed. What cannot be
    honoured is refused: rotated or uneven coordinates, a third dimension, a CRS in another form.

    What a file does not say is a spacing of 1, with a warning, an origin of (0, 0), no CRS and
    metres.

    **Units.** Horizontal and vertical unit are read where the file says them (CRS, vertical CRS,
    unit of the band). Heights are brought to the unit of x and y, which is that of the CRS, and
    ``units`` names both. Heights whose unit is not said are metres, or feet beside a CRS in feet,
    with a warning.

    **Degrees.** A raster in longitude and latitude, in degrees, grads or what else, becomes local
    metres at its middle latitude; how much that bends it is logged, and it is refused where that
    is more than 5 % of an east-west length. Its origin is scaled alike, so that x and y divided by
    the metres per degree, which ``crs`` records, are longitude and latitude again. With `spacing`
    given, that decides instead. A raster without CRS whose numbers could be degrees or metres is
    refused until `spacing` is given.

    **Stretched maps.** EPSG:3857, the map of the web, shows everything too large, at 60 degrees
    twice. It becomes true to scale, as any projection does that is off by more than 5 % in the
    middle of the raster; origin and ``crs`` as with degrees.

    Parameters
    ----------
    path : str, path or xarray.DataArray
    spacing : float, (float, float) or "map", optional
        Distance between samples along x and y in metres (in the unit of the CRS, if that is
        another), instead of the file's. ``"map"`` takes the file's numbers as they are, stretched
        or not.
    height_range : (float, float), optional
        Heights of the least and the greatest number that the file's integers can hold, such as
        those of 0 and 65535, in the unit of `spacing`; without it a number is its height.
    nodata : float, optional
        The number in the file that stands for no data, instead of the file's.
    bounds : (west, south, east, north), optional
        Read only the samples within these, in the file's own CRS.
    window : (column, row, width, height), optional
        Read only these samples, counted in the file. A rasterio ``Window``, or
        ``((row, stop), (column, stop))``, will do.
    overview : int, optional
        Read a smaller version that the file holds, 0 the largest of them. Window and bounds apply
        to that.
    band : int, optional
        Which band holds the heights, from 1, whatever its colour is said to be.
    z_unit : str, optional
        Unit of the file's heights, such as ``"foot"``, instead of what the file says.
    z_scale : float, optional
        A number of the file times this is a height: in `z_unit` where that is given, else in the
        unit of x and y whatever the file says.
    tile : (z, x, y), optional
        Which tile of the web's map an image is. It gives terrain-RGB its spacing, origin and CRS;
        a path that ends in ``z/x/y.png`` does so, too.
    crs : str, optional
        Bring the ground to this projection, a code such as ``"EPSG:32632"`` or WKT; ``"utm"`` is
        the zone of Universal Transverse Mercator that its middle is in. Samples of the new grid
        are bilinear between the file's, `spacing` apart where that is given. A warning says how
        far this ground is from the file's own samples at most. Needs rasterio.

    Returns
    -------
    Heightmap
        Named after the file, without its ending.

    Raises
    ------
    FileError
        If the file is missing, truncated or not what its ending says.
    InputError
        If its content is no ground: pictures, several bands, a rotated raster, ground control
        points or a camera's polynomials, fewer than 2 x 2 samples, infinities, no data at all; if
        it needs more memory than is free, which is said before any is taken; or if an argument is
        out of range.
    MissingExtraError
        If the file needs rasterio and it is not installed.

    Warns
    -----
    UserWarning
        If the heights have 8 bits (slopes become stairs); if spacing or the unit of heights is a
        guess; if PROJ refuses the CRS; if a value that no ground has (-9999, -32768, 3.4e38 ...)
        stands among heights and nobody said that it is nodata; with `crs`, how far the ground is
        from the file's own samples.
    """
    part = Part.of(bounds, window, overview, band)
    numbered = None if tile is None else checked_tile(tile)
    if is_labelled(path):
        if numbered is not None:
            raise InputError("expected a file with tile=, got it with an array")
        name = name_of(path)
        with _within_memory(name):
            raster = read_labelled(path, part)
    else:
        path = file_path("path", path)
        form, name = format_of(path)
        raster = read_raster(form, path, part)
    if numbered is None and raster.coloured and raster.step is None and part.is_all:
        numbered = tile_of(path)
    if numbered is not None:
        if not part.is_all:
            raise InputError("expected a whole tile with tile=, got bounds or window")
        raster = with_tile(raster, numbered, path.name)
    with _within_memory(name):
        ground, notes = _ground_of(
            raster, name, spacing=spacing, height_range=height_range, nodata=nodata,
            z_unit=z_unit, z_scale=z_scale, crs=crs,
        )  # fmt: skip
    for note in notes:
        warnings.warn(note, stacklevel=2)
    return ground


def read_raster(form: Format, path: Path, part: Part) -> Raster:
    """Return what a part of a file says, or one line that says why not.

    Raises
    ------
    FileError, InputError, MissingExtraError
        As :func:`load` has them.
    """
    try:
        with _within_memory(path.name), warnings.catch_warnings():
            # what libraries mumble over a file is not for the user; what they raise is
            warnings.simplefilter("ignore")
            raster = form.read(path, part)
    except TerrainError:
        raise
    except Exception as error:
        # a damaged file makes libraries raise whatever there is
        reason = (str(error).splitlines() or [""])[0][:200] or type(error).__name__
        raise FileError(
            f"expected {form.title} in {path}, got a part of one or something else ({reason})"
        ) from error
    if raster.values.dtype.itemsize == 1:
        stairs = (
            f"{path.name} has 8-bit heights: 256 steps, so slopes become stairs; "
            "a 16-bit or floating-point file would not"
        )
        raster = replace(raster, notes=(stairs, *raster.notes))
    return raster


@contextmanager
def _within_memory(name: str) -> Iterator[None]:
    """Say so where memory runs out all the same."""
    try:
        yield
    except MemoryError:
        raise InputError(
            f"expected a raster that fits into memory, got {name}, which does not: read a part "
            "with window= or bounds="
        ) from None


def ground_of(
    raster: Raster, name: str, *, height_range: tuple[float, float] | None = None
) -> Heightmap:
    """Return the ground that content known to be sound makes."""
    return _ground_of(raster, name, height_range=height_range)[0]


def _ground_of(
    raster: Raster,
    name: str,
    *,
    spacing: float | tuple[float, float] | Literal["map"] | None = None,
    height_range: tuple[float, float] | None = None,
    nodata: float | None = None,
    z_unit: str | None = None,
    z_scale: float | None = None,
    crs: str | None = None,
) -> tuple[Heightmap, tuple[str, ...]]:
    """Return the ground that a file's content makes, and what a user ought to be warned of."""
    off = None
    if crs is not None:
        if height_range is not None:
            raise InputError("expected height_range or crs, got both: a map has heights already")
        raster, off = reprojected(raster, nodata, name, crs, spacing)
        nodata, spacing = None, "map"
    reading = reading_of(
        raster, name, spacing=spacing, height_range=height_range, nodata=nodata,
        z_unit=z_unit, z_scale=z_scale,
    )  # fmt: skip
    hole, notes = reading.holes(raster), reading.notes
    if off is not None:
        off *= abs(raster.scale * reading.factor)
        notes += (
            f"{name} is brought to {str(crs)[:60]}: within {off:.3g} {reading.units[1]} of its own "
            "samples",
        )
    elif reading.metres is not None and raster.values.dtype.kind in "iuf" and raster.offset == 0:
        notes += suspects(raster, hole, name, reading.metres)
    ground = Heightmap(
        reading.heights(raster), spacing=reading.spacing, origin=reading.origin, mask=hole,
        crs=reading.crs, units=reading.units, name=name,
    )  # fmt: skip
    return ground, notes
