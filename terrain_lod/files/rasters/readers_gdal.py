"""What GDAL reads, through rasterio."""

from __future__ import annotations

import math
import warnings
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ...errors import FileError, InputError, MissingExtraError
from . import mercator
from .affine import Affine, first_and_steps, moved, placed, require_upright
from .limits import require_memory
from .parts import Part
from .quiet import quiet_libraries, quiet_rasterio
from .raster import Raster
from .readers_array import HEIGHT_NAMES
from .readers_image import terrain_rgb
from .wkt import GEOGRAPHIC, System, geographic_part, system_of

EXTRA: Final = 'pip install "terrain_lod[geo]"'
# systems of this program's own, which GDAL would add axes to
OWN: Final = "LOCAL_CS"
# raw numbers, with a header in a file beside them
RAW: Final = (".bil", ".bip", ".bsq", ".flt")
# what lies beside rasters in an archive
BESIDE: Final = (".prj", ".xml", ".txt", ".hdr", ".tfw", ".html", ".pdf", ".md", ".json", ".ovr",
                 ".stx", ".clr", ".blw", ".csv", ".msk")  # fmt: skip


def has_rasterio() -> bool:
    try:
        import rasterio  # noqa: F401
    except ImportError:
        return False
    return True


def read_gdal(path: Path, part: Part) -> Raster:
    """Read a raster of any kind that GDAL knows, alone in an archive or plain."""
    with _dataset(path, part) as (file, ways):
        return _from_dataset(file, path.name, part, ways)


@dataclass(frozen=True)
class Extent:
    """Samples of a raster, read or not: how many, of which type, and is row 0 in the south?"""

    shape: tuple[int, int]
    dtype: np.dtype[Any]
    is_southern_first: bool


def extent_gdal(path: Path, part: Part) -> Extent:
    """Return how much there is to read of what :func:`read_gdal` reads, bounds apart."""
    with _dataset(path, part) as (file, _):
        affine, bands = _affine(file), _bands(file, path.name, part)
        dtype = "f8" if len(bands) == 3 else file.dtypes[bands[0] - 1]
        southern = affine is not None and affine[4] > 0
        return Extent((file.height, file.width), np.dtype(dtype), southern)


@contextmanager
def _dataset(path: Path, part: Part) -> Iterator[tuple[Any, str]]:
    """Open the raster in a file, and say which parts of it can be read; errors are our own."""
    if not has_rasterio():
        raise MissingExtraError(f"expected rasterio, for {path.name}, got no such package: {EXTRA}")
    import rasterio
    from rasterio._err import CPLE_BaseError
    from rasterio.errors import RasterioError

    header = path.with_suffix(".hdr")
    if path.suffix.lower() in RAW and not (header.is_file() or path.with_suffix(".HDR").is_file()):
        raise FileError(f"expected {header.name} beside {path.name}, whose header it is, got none")
    try:
        with (
            quiet_rasterio(),
            rasterio.Env(),
            _opened(_source(path), path.name, part) as (file, ways),
        ):
            yield file, ways
    except (RasterioError, CPLE_BaseError) as error:
        reason = str(error.__cause__ or error)
        raise FileError(
            f"expected a raster that GDAL reads in {path.name}, got a part of one or something "
            f"else ({' '.join(reason.split())[:200]})"
        ) from error


@contextmanager
def opened_picture(path: Path) -> Iterator[Any]:
    """Open a picture, whatever its bands are; errors are our own."""
    if not has_rasterio():
        raise MissingExtraError(f"expected rasterio, for {path.name}, got no such package: {EXTRA}")
    import rasterio
    from rasterio._err import CPLE_BaseError
    from rasterio.errors import RasterioError

    try:
        with quiet_rasterio(), rasterio.Env(), warnings.catch_warnings():
            # a picture without a place is one all the same
            warnings.simplefilter("ignore")
            with rasterio.open(path) as file:
                yield file
    except (RasterioError, CPLE_BaseError) as error:
        reason = " ".join(str(error.__cause__ or error).split())[:200]
        raise FileError(f"expected a picture that GDAL reads in {path.name} ({reason})") from error


def place_of_image(path: Path, raster: Raster) -> tuple[Raster, Affine | None]:
    """Return `raster` in the CRS that files beside an image name, and where they say it is."""
    import rasterio
    from rasterio.errors import RasterioError

    try:
        with quiet_rasterio(), rasterio.Env(), _open(path) as file:
            affine = _affine(file)
            return (raster if affine is None else _in_system(raster, file.crs)), affine
    except RasterioError:
        return raster, None


def _source(path: Path) -> str:
    """Return what GDAL calls a file, or the one raster within an archive."""
    place = path.absolute()
    with path.open("rb") as file:
        start = file.read(4)
    if start.startswith(b"\x1f\x8b"):
        return f"/vsigzip/{place}"
    if start != b"PK\3\4":
        return str(place)
    with zipfile.ZipFile(path) as archive:
        names = [name for name in archive.namelist() if not name.endswith("/")]
    members = [name for name in names if PurePosixPath(name).suffix.lower() not in BESIDE]
    if len(members) != 1:
        found = ", ".join(members[:8]) or "none"
        raise InputError(f"expected one raster in {path.name}, got {found}: unpack it")
    return f"/vsizip/{{{place}}}/{members[0]}"


@contextmanager
def _opened(source: str, name: str, part: Part) -> Iterator[tuple[Any, str]]:
    """Open the one raster of heights in what GDAL calls `source`."""
    with _open(source) as file:
        inner = _of_several(file, name) if file.subdatasets else None
        overviews = file.overviews(1) if file.count else []
    source = inner or source
    options = {}
    if part.overview is not None:
        if part.overview >= len(overviews):
            found = f"0 to {len(overviews) - 1}" if overviews else "none"
            raise InputError(f"expected an overview that {name} has, {found}, got {part.overview}")
        options = {"overview_level": part.overview}
    with _open(source, **options) as file:
        ways = "overview=, window= or bounds=" if overviews else "window= or bounds="
        yield file, ways


def _open(source: str | Path, **options: Any) -> Any:
    import rasterio

    with quiet_libraries():
        file = rasterio.open(source, **options)
        _ = file.subdatasets  # GDAL reads the rest of a header when it is first asked
        return file


def _of_several(file: Any, name: str) -> str | None:
    """Return the dataset of heights among several in a file, None if the file is one itself."""
    if file.count:
        return None
    titles = [dataset.rpartition(":")[2].rpartition("/")[2] for dataset in file.subdatasets]
    chosen = [k for k, title in enumerate(titles) if title.lower().strip('"') in HEIGHT_NAMES]
    if len(chosen) != 1:
        raise InputError(
            f"expected one dataset of heights in {name}, or one named {' or '.join(HEIGHT_NAMES)}, "
            f"got {', '.join(titles)}: take one out with gdal_translate"
        )
    return str(file.subdatasets[chosen[0]])


def _from_dataset(file: Any, name: str, part: Part, ways: str) -> Raster:
    refused = _refusal_of_crs(file)
    affine = _affine(file)
    if file.gcps[0] or (affine is None and file.rpcs):
        what = "ground control points" if file.gcps[0] else "a camera's polynomials (RPC)"
        raise InputError(
            f"expected a north-up raster, got {what} in {name}: straighten it with gdalwarp"
        )
    if affine is not None:
        require_upright(affine, file.shape, name)
    rows, columns = part.slices(file.shape, first_and_steps(affine), name)
    window = (rows.start, rows.stop), (columns.start, columns.stop)
    bands = _bands(file, name, part)
    extent = rows.stop - rows.start, columns.stop - columns.start
    dtype = np.dtype("f8" if len(bands) == 3 else file.dtypes[bands[0] - 1])
    require_memory(*extent, dtype, name, ways)
    mask = _mask(file, bands[0], window)
    if len(bands) == 3:
        colours = np.moveaxis(_read(file, bands, window), 0, 2)
        hole = np.zeros(extent, bool) if mask is None else mask
        raster = Raster(terrain_rgb(colours, hole, name), mask=mask, coloured=True)
    else:
        band = bands[0] - 1
        raster = Raster(
            _read(file, bands[0], window),
            nodata=file.nodatavals[band],
            mask=mask,
            scale=float(file.scales[band]),
            offset=float(file.offsets[band]),
            height_unit=file.units[band] or None,
        )
    if refused is None:
        raster = _in_system(raster, file.crs)
    else:
        note = f"{name} has a CRS that PROJ refuses ({refused}): loaded without it, in metres"
        raster = replace(raster, notes=(note,))
    return raster if affine is None else placed(raster, moved(affine, rows, columns), name)


def _affine(file: Any) -> Affine | None:
    """Return where samples stand, None if the file does not say."""
    a, b, x0, d, e, y0 = tuple(file.transform)[:6]
    # some drivers leave the numbers as they found them
    nothing = not any(abs(number) > 1e-200 for number in (a, b, d, e))
    if file.transform.is_identity or nothing:
        return None
    # GDAL's transform is of the corners of cells, whatever the file's pixels are
    return a, b, x0 + (a + b) / 2, d, e, y0 + (d + e) / 2


def _bands(file: Any, name: str, part: Part) -> list[int]:
    """Return the band of heights, or the three of colours that heights may be packed in."""
    from rasterio.enums import ColorInterp

    if part.band is not None:
        part.require_one_band(name, file.count)
        return [part.band]
    uses = dict(enumerate(file.colorinterp, 1))
    bands = [band for band, use in uses.items() if use != ColorInterp.alpha]
    if not bands:
        what = "a band of alpha alone" if file.count else "no band"
        raise InputError(f"expected a band of heights in {name}, got {what}: band= reads it anyway")
    if len(bands) == 1 and uses[bands[0]] == ColorInterp.palette:
        raise InputError(
            f"expected heights in {name}, got a picture whose numbers stand for colours of a "
            "palette: band=1 reads the numbers anyway"
        )
    if len(bands) == 1 or (len(bands) == 3 and file.dtypes[bands[0] - 1] == "uint8"):
        return bands
    called = [file.descriptions[band - 1] or uses[band].name for band in bands]
    shown = ", ".join(called[:6]) + (" ..." if len(called) > 6 else "")
    raise InputError(
        f"expected one band of heights, got {len(bands)} in {name} ({shown}): choose with band="
    )


def _read(file: Any, bands: int | Sequence[int], window: Any) -> np.ndarray[Any, Any]:
    with quiet_libraries():
        return np.asarray(file.read(bands, window=window))


def _mask(file: Any, band: int, window: Any) -> npt.NDArray[np.bool_] | None:
    """Return where alpha, or a mask of the file's own besides its nodata, says there is nothing.

    GDAL takes alpha for a mask in whole numbers without sign alone.
    """
    from rasterio.enums import ColorInterp, MaskFlags

    hole = None
    flags = file.mask_flag_enums[band - 1]
    if MaskFlags.per_dataset in flags and MaskFlags.alpha not in flags:
        with quiet_libraries():
            hole = file.read_masks(band, window=window) == 0
    for alpha, use in enumerate(file.colorinterp, 1):
        if use == ColorInterp.alpha and alpha != band:
            clear = ~(_read(file, alpha, window) > 0)
            hole = clear if hole is None else hole | clear
    return hole


def _refusal_of_crs(file: Any) -> str | None:
    """Return why PROJ refuses the CRS of a dataset, None if it does not."""
    from rasterio._err import CPLE_BaseError
    from rasterio.errors import CRSError

    try:
        if file.crs:
            file.crs.to_wkt()
        # what GDAL could not say then, rasterio raises where it asks next, once
        tuple(file.colorinterp)
    except (CRSError, CPLE_BaseError) as error:
        return " ".join(str(error).split())[:160]
    return None


def _in_system(raster: Raster, crs: Any) -> Raster:
    """Return `raster` with what a coordinate reference system of rasterio says of itself."""
    if not crs:
        return raster
    text, authority = crs.to_wkt(), crs.to_authority()
    system = system_of(text, ":".join(authority) if authority else text)
    return replace(raster, system=system, geographic=_geographic(crs, text, system))


def in_system_called(raster: Raster, name: str) -> Raster:
    """Return `raster` in the system that a code such as ``"EPSG:25832"``, or WKT, stands for."""
    if name.startswith(OWN):
        return replace(raster, system=system_of(name))
    with crs_called(name) as crs:
        return _in_system(raster, crs)


def wkt_called(name: str) -> str:
    """Return the well-known text of the system that a code, or WKT, stands for."""
    if name.startswith(OWN):
        return name
    with crs_called(name) as crs:
        return str(crs.to_wkt())


@contextmanager
def crs_called(name: str) -> Iterator[Any]:
    """Yield the system of rasterio that a code, or WKT, stands for."""
    if not has_rasterio():
        raise MissingExtraError(
            f"expected rasterio, for the CRS {name[:60]}, got no such package: {EXTRA}"
        )
    import rasterio
    from rasterio.errors import CRSError

    try:
        with quiet_rasterio(), rasterio.Env():
            yield rasterio.CRS.from_user_input(name)
    except CRSError:
        raise InputError(f"expected a CRS that PROJ knows, got {name[:60]!r}") from None


def _geographic(
    crs: Any, text: str, system: System
) -> Callable[[float, float], tuple[float, float]] | None:
    """Return what takes x and y of a projection to longitude and latitude in degrees."""
    if system.horizontal in mercator.CODES:
        return mercator.geographic
    base = geographic_part(text)
    if system.angle is not None or base is None or text.startswith(GEOGRAPHIC):
        return None
    degrees = (system_of(base).angle or system.angle).degrees  # type: ignore[union-attr]

    def geographic(x: float, y: float) -> tuple[float, float]:
        import rasterio
        from rasterio._err import CPLE_BaseError
        from rasterio.errors import RasterioError
        from rasterio.warp import transform

        try:
            with rasterio.Env():
                longitude, latitude = transform(crs, rasterio.CRS.from_wkt(base), [x], [y])
        except (RasterioError, CPLE_BaseError):
            return math.nan, math.nan
        return longitude[0] * degrees, latitude[0] * degrees

    return geographic
