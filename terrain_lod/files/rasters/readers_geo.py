"""GeoTIFF and what else GDAL reads: samples with their place in the world.

Through rasterio where it is installed; else TIFF of the plain kinds through Pillow, with the tags
of the OGC GeoTIFF Standard 1.1.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from PIL import UnidentifiedImageError

from ...errors import InputError, MissingExtraError
from .readers import Raster
from .readers_image import open_image, raster_of, terrain_rgb

# (a, b, x0, d, e, y0): a sample stands at x = x0 + a column + b row, y = y0 + d column + e row
Affine = tuple[float, float, float, float, float, float]

EXTRA: Final = 'pip install "terrain_lod[geo]"'
# tags and keys of the standard, and GDAL's own tags
BITS_PER_SAMPLE, SAMPLE_FORMAT, METADATA = 258, 339, 42112
PIXEL_SCALE, TIE_POINTS, TRANSFORMATION, KEYS, NODATA = 33550, 33922, 34264, 34735, 42113
MODEL_TYPE, RASTER_TYPE, GEOGRAPHIC_CRS, PROJECTED_CRS = 1024, 1025, 2048, 3072
GEOGRAPHIC, PIXEL_IS_POINT, USER_DEFINED = 2, 2, 32767


def read_tiff(path: Path) -> Raster:
    """Read a TIFF or GeoTIFF."""
    return _with_rasterio(path) if _has_rasterio() else _with_pillow(path)


def read_gdal(path: Path) -> Raster:
    """Read a raster of any other kind that GDAL knows."""
    if not _has_rasterio():
        raise MissingExtraError(f"expected rasterio, for {path.name}, got no such package: {EXTRA}")
    return _with_rasterio(path)


def _has_rasterio() -> bool:
    try:
        import rasterio  # noqa: F401
    except ImportError:
        return False
    return True


def _with_rasterio(path: Path) -> Raster:
    import rasterio
    from rasterio.enums import ColorInterp, MaskFlags

    with rasterio.open(path) as file:
        if file.gcps[0]:
            raise InputError(
                f"expected a north-up raster, got ground control points in {path.name}: "
                "straighten it with gdalwarp"
            )
        bands = [k for k, use in enumerate(file.colorinterp, 1) if use != ColorInterp.alpha]
        # the file's own mask or alpha channel, besides its nodata value
        masked = MaskFlags.per_dataset in file.mask_flag_enums[bands[0] - 1]
        mask = file.read_masks(bands[0]) == 0 if masked else None
        if len(bands) == 3 and file.dtypes[bands[0] - 1] == "uint8":
            hole = np.zeros(file.shape, bool) if mask is None else mask
            colours = np.moveaxis(file.read(bands), 0, 2)
            raster = Raster(terrain_rgb(colours, hole, path.name), mask=mask)
        elif len(bands) == 1:
            raster = replace(_band(file, bands[0]), mask=mask)
        else:
            raise InputError(
                f"expected one band of heights, got {len(bands)} in {path.name}: "
                f"take one out with gdal_translate -b 1 {path.name} heights.tif"
            )
        if file.crs:
            authority = file.crs.to_authority()
            crs = ":".join(authority) if authority else file.crs.to_wkt()
            raster = replace(raster, crs=crs, degrees=file.crs.is_geographic)
        if file.transform.is_identity:
            return raster
        # GDAL's transform is of the corners of cells, whatever the file's pixels are
        a, b, x0, d, e, y0 = tuple(file.transform)[:6]
    return _placed(raster, (a, b, x0 + (a + b) / 2, d, e, y0 + (d + e) / 2), path.name)


def _band(file: Any, band: int) -> Raster:
    """Return one band, its packed numbers unpacked if the file says how."""
    values, nodata = file.read(band), file.nodatavals[band - 1]
    scale, offset = file.scales[band - 1], file.offsets[band - 1]
    if (scale, offset) == (1, 0):
        return Raster(values, nodata=nodata)
    return Raster(np.where(values == nodata, np.nan, values * float(scale) + offset))


def _with_pillow(path: Path) -> Raster:
    try:
        image = open_image(path)
    except UnidentifiedImageError:
        with path.open("rb") as file:
            if file.read(4) not in (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"):
                raise
        raise MissingExtraError(
            f"expected a plain TIFF, got one of another kind, or a part of one, in {path.name}: "
            f"{EXTRA}"
        ) from None
    with image:
        raster = raster_of(image, path.name)
        tags = dict(getattr(image, "tag_v2", {}))
    return _with_tags(raster, tags, path.name)


def _with_tags(raster: Raster, tags: dict[int, Any], name: str) -> Raster:
    """Return `raster` with what the tags of a GeoTIFF say."""
    # Pillow widens some numbers and takes int8 for uint8
    if raster.values.dtype.kind != "f":
        kind = "i" if tags.get(SAMPLE_FORMAT, (1,))[0] == 2 else "u"
        size = -(-tags.get(BITS_PER_SAMPLE, (8,))[0] // 8)
        raster = replace(raster, values=raster.values.astype(f"{kind}{size}"))
    if 'role="scale"' in tags.get(METADATA, "") or 'role="offset"' in tags.get(METADATA, ""):
        raise MissingExtraError(f"expected plain numbers, got packed ones in {name}: {EXTRA}")
    if NODATA in tags:
        raster = replace(raster, nodata=float(tags[NODATA].strip("\0 ")))
    # entries of four: key, where its value is, count, value
    entries = np.reshape(tags.get(KEYS, ()), (-1, 4))[1:]
    keys = {int(key): int(value) for key, where, _, value in entries if where == 0}
    degrees = keys.get(MODEL_TYPE) == GEOGRAPHIC
    code = keys.get(GEOGRAPHIC_CRS if degrees else PROJECTED_CRS, USER_DEFINED)
    crs = f"EPSG:{code}" if code != USER_DEFINED else None
    raster = replace(raster, crs=crs, degrees=degrees)
    if TRANSFORMATION in tags:
        a, b, _, x0, d, e, _, y0 = tags[TRANSFORMATION][:8]
    elif PIXEL_SCALE in tags and len(tags.get(TIE_POINTS, ())) == 6:
        column, row, _, x, y, _ = tags[TIE_POINTS]
        a, b, d, e = tags[PIXEL_SCALE][0], 0.0, 0.0, -tags[PIXEL_SCALE][1]
        x0, y0 = x - column * a, y - row * e
    else:
        return raster
    if keys.get(RASTER_TYPE) != PIXEL_IS_POINT:
        x0, y0 = x0 + (a + b) / 2, y0 + (d + e) / 2
    return _placed(raster, (a, b, x0, d, e, y0), name)


def _placed(raster: Raster, affine: Affine, name: str) -> Raster:
    """Return `raster` with step and origin, its rows turned to begin in the north."""
    a, b, x0, d, e, y0 = affine
    if b or d or a <= 0 or e == 0:
        raise InputError(
            f"expected a north-up raster, got a rotated or mirrored one in {name}: "
            "straighten it with gdalwarp"
        )
    if e > 0:
        mask = None if raster.mask is None else raster.mask[::-1]
        y0 += e * (len(raster.values) - 1)
        raster = replace(raster, values=raster.values[::-1], mask=mask)
    return replace(raster, step=(a, abs(e)), origin=(x0, y0))
