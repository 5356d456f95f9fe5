"""GeoTIFF of the plain kinds without GDAL: Pillow's samples, and the tags beside them.

Tags and keys are those of the OGC GeoTIFF Standard 1.1.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from PIL import UnidentifiedImageError

from ...errors import InputError, MissingExtraError, TerrainError
from ...ground.units import METRE, Unit, unit_called
from . import mercator
from .affine import Affine, part_of
from .parts import Part
from .quiet import quiet_libraries
from .raster import Raster
from .readers_gdal import EXTRA
from .readers_image import open_image, raster_of, world_file
from .wkt import DEGREE, WGS84, Angle, Ellipsoid, System

# tags and keys of the standard, and GDAL's own tags
PHOTOMETRIC, WHITE_IS_ZERO, BITS_PER_SAMPLE, SAMPLE_FORMAT, METADATA = 262, 0, 258, 339, 42112
PIXEL_SCALE, TIE_POINTS, TRANSFORMATION, KEYS, NODATA = 33550, 33922, 34264, 34735, 42113
DOUBLES, RPC, SUBFILE_TYPE, IS_MASK = 34736, 50844, 254, 4
MODEL_TYPE, RASTER_TYPE, GEOGRAPHIC_CRS, PROJECTED_CRS = 1024, 1025, 2048, 3072
ANGULAR_UNIT, LINEAR_UNIT, VERTICAL_CRS, VERTICAL_UNIT = 2054, 3076, 4096, 4099
AXIS, INVERSE_FLATTENING = 2057, 2059
PROJECTED, GEOGRAPHIC, PIXEL_IS_POINT, USER_DEFINED = 1, 2, 2, 32767
# units by their EPSG codes
LENGTHS: Final = {9001: "metre", 9002: "foot", 9003: "US survey foot", 9036: "kilometre"}
ANGLES: Final = {9102: DEGREE, 9122: DEGREE, 9105: Angle("grad", 0.9)}
# units of the vertical CRSs that rasters most often have, by their codes
HEIGHTS: Final = {5703: "metre", 5773: "metre", 3855: "metre", 5714: "metre", 5701: "metre",
                  5783: "metre", 7837: "metre", 6360: "US survey foot", 6358: "US survey foot",
                  8228: "foot"}  # fmt: skip
# maps of the whole world but that of the web: stretched, and by formulas that PROJ has
WORLD_MAPS: Final = (3395, 3832, 3994, 3410, 3975, 6933, 4087, 4088, 32662, 32663, 8857)
# what of a file beside an image changes the ground
PLACES_BESIDE: Final = (
    b"<GeoTransform",
    b"<SRS",
    b"<NoDataValue",
    b"<Scale",
    b"<Offset",
    b"<GCPList",
)
UNIT_TYPE: Final = re.compile(r'role="unittype"[^>]*>([^<]*)<')


def read_plain_tiff(path: Path, part: Part) -> Raster:
    """Read a TIFF that Pillow knows."""
    if part.overview is not None:
        raise MissingExtraError(f"expected rasterio with overview=, got no such package: {EXTRA}")
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
    require_nothing_beside(path)
    with image:
        _require_no_mask(image, path)
        tags = dict(getattr(image, "tag_v2", {}))
        if tags.get(PHOTOMETRIC) == WHITE_IS_ZERO:
            # Pillow turns such numbers round, the field does not
            raise MissingExtraError(f"expected black as 0 in {path.name}, got white: {EXTRA}")
        try:
            with quiet_libraries():
                raster = raster_of(image, path, part.band)
        except TerrainError:
            raise
        except (ValueError, KeyError, NotImplementedError) as error:
            raise MissingExtraError(
                f"expected a plain TIFF, got one that Pillow does not read in {path.name} "
                f"({error}): {EXTRA}"
            ) from error
    raster = _with_tags(raster, tags, path.name)
    return part_of(raster, _affine(tags, path), part, path.name)


def require_nothing_beside(path: Path) -> None:
    """Refuse a file of GDAL's beside an image, whose place or nodata it says."""
    beside = path.with_name(f"{path.name}.aux.xml")
    if beside.is_file() and any(entry in beside.read_bytes() for entry in PLACES_BESIDE):
        raise MissingExtraError(
            f"expected rasterio, for {beside.name}, got no such package: {EXTRA}"
        )


def _require_no_mask(image: Any, path: Path) -> None:
    """Refuse a mask that stands beside the samples, in the file or in one of its own."""
    masked = path.with_name(path.name + ".msk").is_file()
    try:
        for frame in range(1, getattr(image, "n_frames", 1)):
            image.seek(frame)
            masked |= bool(int(image.tag_v2.get(SUBFILE_TYPE, 0)) & IS_MASK)
    except (SyntaxError, KeyError):
        # of a kind that Pillow does not know, as masks of one bit are
        masked = True
    image.seek(0)
    if masked:
        raise MissingExtraError(f"expected no mask of its own in {path.name}, got one: {EXTRA}")


def _with_tags(raster: Raster, tags: dict[int, Any], name: str) -> Raster:
    """Return `raster` with what the tags of a GeoTIFF say of its numbers and its CRS."""
    # Pillow widens some numbers and takes int8 for uint8
    if raster.values.dtype.kind != "f":
        kind = "i" if tags.get(SAMPLE_FORMAT, (1,))[0] == 2 else "u"
        size = -(-tags.get(BITS_PER_SAMPLE, (8,))[0] // 8)
        raster = replace(raster, values=raster.values.astype(f"{kind}{size}"))
    metadata = str(tags.get(METADATA, ""))
    if 'role="scale"' in metadata or 'role="offset"' in metadata:
        raise MissingExtraError(f"expected plain numbers, got packed ones in {name}: {EXTRA}")
    unit = UNIT_TYPE.search(metadata)
    raster = replace(raster, height_unit=unit[1] if unit else None)
    if NODATA in tags:
        raster = replace(raster, nodata=float(tags[NODATA].strip("\0 ")))
    raster = replace(raster, system=_system(_keys(tags), name))
    if raster.system.horizontal == mercator.CODE:
        raster = replace(raster, geographic=mercator.geographic)
    return raster


def _affine(tags: dict[int, Any], path: Path) -> Affine | None:
    """Return where samples stand, by the tags or else a world file; None if nothing says."""
    if TRANSFORMATION in tags:
        a, b, _, x0, d, e, _, y0 = tags[TRANSFORMATION][:8]
    elif PIXEL_SCALE in tags and len(tags.get(TIE_POINTS, ())) == 6:
        column, row, _, x, y, _ = tags[TIE_POINTS]
        a, b, d, e = tags[PIXEL_SCALE][0], 0.0, 0.0, -tags[PIXEL_SCALE][1]
        x0, y0 = x - column * a, y - row * e
    elif TIE_POINTS in tags or RPC in tags:
        what = "ground control points" if TIE_POINTS in tags else "a camera's polynomials (RPC)"
        raise InputError(
            f"expected a north-up raster, got {what} in {path.name}: straighten it with gdalwarp"
        )
    else:
        return world_file(path)
    if _keys(tags).get(RASTER_TYPE) != PIXEL_IS_POINT:
        x0, y0 = x0 + (a + b) / 2, y0 + (d + e) / 2
    return a, b, x0, d, e, y0


def _keys(tags: dict[int, Any]) -> dict[int, float]:
    """Return the numbers among a file's keys: in entries of key, where, count, value."""
    entries = np.reshape(tags.get(KEYS, ()), (-1, 4))[1:].astype(int).tolist()
    doubles = tags.get(DOUBLES, ())
    keys: dict[int, float] = {key: value for key, where, _, value in entries if where == 0}
    keys |= {key: doubles[value] for key, where, _, value in entries
             if where == DOUBLES and value < len(doubles)}  # fmt: skip
    return keys


def _system(keys: dict[int, float], name: str) -> System:
    """Return what the keys say, or refuse what takes a database of codes to know."""
    degrees = keys.get(MODEL_TYPE) == GEOGRAPHIC
    code = int(keys.get(GEOGRAPHIC_CRS if degrees else PROJECTED_CRS, USER_DEFINED))
    crs = f"EPSG:{code}" if code != USER_DEFINED else None
    height_unit = _length(keys, VERTICAL_UNIT, name)
    if height_unit is None and VERTICAL_CRS in keys:
        height_unit = unit_called(HEIGHTS.get(int(keys[VERTICAL_CRS]), ""))
        if height_unit is None:
            raise MissingExtraError(f"expected a vertical CRS that is known in {name}: {EXTRA}")
    ellipsoid = WGS84
    if keys.get(AXIS, 0) > 0:
        inverse = keys.get(INVERSE_FLATTENING, 0.0)
        flattening = 1 / inverse if inverse > 1 else 0.0
        ellipsoid = Ellipsoid(keys[AXIS], flattening * (2 - flattening))
    if degrees:
        angle = ANGLES.get(int(keys.get(ANGULAR_UNIT, 9102)))
        if angle is None:
            raise MissingExtraError(
                f"expected degrees or grads, got another unit in {name}: {EXTRA}"
            )
        return System(crs, crs, angle, height_unit=height_unit, ellipsoid=ellipsoid)
    if code in WORLD_MAPS:
        raise MissingExtraError(
            f"expected a map that is about true to scale in {name}, got {crs}, which it takes PROJ "
            f"to straighten: {EXTRA}"
        )
    unit = _length(keys, LINEAR_UNIT, name)
    if unit is None and keys.get(MODEL_TYPE) == PROJECTED:
        if not (crs == mercator.CODE or _is_utm(code)):
            raise MissingExtraError(
                f"expected {name} to name its unit, got {crs or 'a CRS of its own'} alone: {EXTRA}"
            )
        unit = METRE
    return System(crs, crs, unit=unit, height_unit=height_unit)


def _length(keys: dict[int, float], key: int, name: str) -> Unit | None:
    code = keys.get(key)
    if code is None:
        return None
    unit = unit_called(LENGTHS.get(int(code), ""))
    if unit is None:
        raise MissingExtraError(f"expected metres or feet, got another unit in {name}: {EXTRA}")
    return unit


def _is_utm(code: int) -> bool:
    """Return whether a code is a zone of UTM on WGS 84, ETRS89 or NAD83: metres."""
    return code // 100 in (326, 327, 258, 269)
