"""Kinds of files: how each is told, and what reads it."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from ...errors import FileError, InputError, MissingExtraError
from . import readers_gdal
from .affine import part_of
from .parts import Part
from .raster import Raster
from .readers_array import read_numpy
from .readers_asc import read_asc
from .readers_gdal import EXTRA, read_gdal
from .readers_hgt import read_hgt
from .readers_image import is_deep, open_image, raster_of, world_file
from .readers_tiff import read_plain_tiff, require_nothing_beside


def read_image(path: Path, part: Part) -> Raster:
    """Read an image, in the place that files beside it give."""
    gdal = readers_gdal.has_rasterio()
    with open_image(path) as image:
        if gdal and is_deep(image) and len(image.getbands()) > 1:
            return read_gdal(path, part)
        raster = raster_of(image, path, part.band)
    if not gdal:
        require_nothing_beside(path)
    affine = world_file(path)
    if gdal:
        raster, affine = readers_gdal.place_of_image(path, raster)
    return part_of(raster, affine, part, path.name)


def read_tiff(path: Path, part: Part) -> Raster:
    """Read a TIFF or GeoTIFF."""
    return (read_gdal if readers_gdal.has_rasterio() else read_plain_tiff)(path, part)


@dataclass(frozen=True)
class Format:
    """A kind of file: its title, the endings of its names, its first bytes, what reads it."""

    title: str
    endings: tuple[str, ...]
    starts: tuple[bytes, ...]
    read: Callable[[Path, Part], Raster]


FORMATS: Final = (
    Format("a PNG image", (".png",), (b"\x89PNG\r\n\x1a\n",), read_image),
    Format("a JPEG image", (".jpg", ".jpeg"), (b"\xff\xd8\xff",), read_image),
    Format("a WebP image", (".webp",), (b"RIFF",), read_image),
    Format("a TIFF", (".tif", ".tiff"), (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"), read_tiff),
    Format("a NumPy array", (".npy", ".npz"), (b"\x93NUMPY",), read_numpy),
    Format("an SRTM tile", (".hgt", ".hgt.gz", ".hgt.zip"), (), read_hgt),
    Format("a grid of text", (".asc",), (), read_asc),
    Format("a GDAL raster", (".vrt", ".img", ".bil", ".dem", ".dt2", ".nc", ".jp2", ".zip", ".gz"),
           (), read_gdal),
)  # fmt: skip


def format_of(path: Path) -> tuple[Format, str]:
    """Return what a file is, by its first bytes or else its name, and its name without ending."""
    if not os.path.isfile(path):  # as Path.is_file, but a folder may be closed
        found = "a folder" if os.path.isdir(path) else "nothing"
        raise FileError(f"expected a file of heights, got {found} at {path}")
    try:
        with path.open("rb") as file:
            start = file.read(16)
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror}") from None
    named, name = _by_name(path)
    for form in FORMATS:
        if start.startswith(form.starts) and form.starts:
            return form, name
    if named is not None:
        return named, name
    if readers_gdal.has_rasterio():
        return FORMATS[-1], name
    known = ", ".join(sorted(ending for form in FORMATS for ending in form.endings))
    if path.suffix:
        raise MissingExtraError(
            f"expected a file that ends in one of {known}, got {path.name}, for which there is "
            f"rasterio: {EXTRA}"
        )
    raise InputError(f"expected a file that ends in one of {known}, got {path.name}")


def _by_name(path: Path) -> tuple[Format | None, str]:
    for form in FORMATS:
        for ending in form.endings:
            if path.name.lower().endswith(ending):
                return form, path.name[: -len(ending)]
    return None, path.stem or path.name
