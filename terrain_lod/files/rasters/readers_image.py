"""Images: grey levels, and heights packed into red, green and blue."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from PIL import Image

from ...errors import FileError, InputError
from .limits import require_memory
from .parts import Part
from .raster import Raster

_LIMIT: Final = threading.Lock()
GREY: Final = ("L", "I", "I;16", "I;16B", "I;16L", "I;16N", "F")
# Pillow's words for what is no height, and people's
PICTURES: Final = {
    "P": "a picture whose numbers stand for colours of a palette",
    "PA": "a picture whose numbers stand for colours of a palette",
    "1": "a picture in black and white",
    "CMYK": "a picture in the colours of a printer (CMYK)",
    "YCbCr": "a picture in colours (YCbCr)",
    "LAB": "a picture in colours (LAB)",
    "HSV": "a picture in colours (HSV)",
}
# bytes of a sample in memory; deflate makes at most so many bytes of one
PIXEL_BYTES: Final = {"L": 1, "I": 4, "F": 4, "LA": 2, "RGB": 3, "RGBA": 4}
DEFLATE: Final = 1040


def open_image(path: Path) -> Image.Image:
    """Open an image of any size: Pillow's guard against decompression bombs stops large DEMs."""
    with _LIMIT:
        guard, Image.MAX_IMAGE_PIXELS = Image.MAX_IMAGE_PIXELS, None
        try:
            return Image.open(path)
        finally:
            Image.MAX_IMAGE_PIXELS = guard


def raster_of(image: Image.Image, path: Path, band: int | None = None) -> Raster:
    """Return the samples of an open image: grey as it is, terrain-RGB as metres.

    `band` takes one of several channels as it is.
    """
    name = path.name
    _require_whole(image, path)
    # Pillow cuts 16-bit colour, and grey with alpha, to 8 bits
    if image.mode not in GREY and is_deep(image):
        raise InputError(
            f"expected one channel of 16 bits in {name}, got {image.mode}: "
            "save it as 16-bit grey without colour or alpha"
        )
    channels = len(image.getbands())
    Part(band=band).require_one_band(name, channels)
    if image.mode in GREY:
        values = np.asarray(image)
        # older Pillow opens 16-bit PNG as int32
        if image.format == "PNG" and image.mode != "L":
            values = values.astype(np.uint16)
        clear = image.info.get("transparency")
        return Raster(values, nodata=clear if isinstance(clear, int) else None)
    if band is not None:
        pixels = np.asarray(image).reshape(*image.size[::-1], channels)
        return Raster(pixels[..., band - 1])
    if image.mode == "LA":
        values, alpha = np.moveaxis(np.asarray(image), 2, 0)
        return Raster(values, mask=alpha == 0)
    if image.mode not in ("RGB", "RGBA"):
        what = PICTURES.get(image.mode, f"a picture of the kind {image.mode}")
        raise InputError(f"expected a grey or terrain-RGB image, got {what} in {name}")
    pixels = np.asarray(image)
    mask = pixels[..., 3] == 0 if image.mode == "RGBA" else np.zeros(pixels.shape[:2], bool)
    return Raster(terrain_rgb(pixels[..., :3], mask, name), mask=mask, coloured=True)


def is_deep(image: Image.Image) -> bool:
    """Return whether the samples have 16 bits in the file."""
    return ";16" in str(getattr(image, "tile", ""))


def _require_whole(image: Image.Image, path: Path) -> None:
    """Refuse an image that cannot be in memory, or in so small a file, before it is unpacked."""
    columns, rows = image.size
    # colours become heights in float64
    dtype = np.float64 if image.mode in ("RGB", "RGBA") else f"V{PIXEL_BYTES.get(image.mode, 2)}"
    require_memory(rows, columns, dtype, path.name, "a smaller image")
    size = path.stat().st_size
    if image.format == "PNG" and rows * columns > 8 * DEFLATE * size:
        raise FileError(
            f"expected {rows:,} x {columns:,} samples in {path.name}, got {size:,} bytes, too few "
            "to hold them: truncated?"
        )


def world_file(path: Path) -> tuple[float, float, float, float, float, float] | None:
    """Return the affine of the world file beside an image, None if there is none.

    Six lines: steps in x and in y to the next column, in x and in y to the next row, x and y of
    the first sample. It is named as the image, with the first and the last letter of its ending
    and a w (ESRI, "World files for raster datasets").
    """
    ending = path.suffix[1:]
    short = ending[:1] + ending[-1:] + "w"
    for suffix in (short, short.upper(), ending + "w", "wld"):
        beside = path.with_suffix(f".{suffix}")
        if not beside.is_file():
            continue
        try:
            a, d, b, e, x0, y0 = map(float, beside.read_text().split()[:6])
        except ValueError:
            raise FileError(f"expected six numbers in {beside.name}, got others") from None
        return a, b, x0, d, e, y0
    return None


def terrain_rgb(
    pixels: npt.NDArray[Any], mask: npt.NDArray[np.bool_], name: str
) -> npt.NDArray[np.float64]:
    """Return the heights in metres that colours stand for.

    Mapbox Terrain-RGB:  -10000 + (65536 R + 256 G + B) / 10
    Terrarium:           -32768 + 256 R + G + B / 256

    Ground from 11 km below the sea to 9 km above has R of 0 to 2 in the one and of 85 to 163 in
    the other, so the two are told apart by their red. Mapbox's with no red at all, ground wholly
    deeper than 3446 m, is taken for a picture.

    Parameters
    ----------
    pixels : (R, C, 3) uint8
    mask : (R, C) bool
        True where there is no data.
    name : str
        Of the file, for the message.

    Raises
    ------
    InputError
        If the colours are no heights in either encoding.
    """
    red, green, blue = (pixels[..., channel].astype(np.float64) for channel in range(3))
    if pixels.dtype == np.uint8 and not ((red == green) & (green == blue)).all():
        mapbox = -10000 + (65536 * red + 256 * green + blue) / 10
        if red.any() and _looks_like_ground(mapbox, red, mask, 6553.6):
            return mapbox
        terrarium = -32768 + 256 * red + green + blue / 256
        if _looks_like_ground(terrarium, red, mask, 256.0):
            return terrarium
    raise InputError(
        f"expected one channel of heights or terrain-RGB (Mapbox or Terrarium), "
        f"got three channels of colour in {name}"
    )


def _looks_like_ground(
    heights: npt.NDArray[np.float64],
    red: npt.NDArray[np.float64],
    mask: npt.NDArray[np.bool_],
    red_step: float,
) -> bool:
    """Return whether heights are on this planet, and carry over where red steps by one.

    Where red changes in ground, green and blue wrap around and the height stays near; in a picture
    it jumps by what a step of red is worth.
    """
    known = heights[~mask]
    if not known.size or known.min() < -11_000 or known.max() > 9_000:
        return False
    heights = np.where(mask, np.nan, heights)
    jumps = np.abs(np.concatenate([np.diff(heights, axis=axis).ravel() for axis in (0, 1)]))
    turns = np.concatenate([np.diff(red, axis=axis).ravel() != 0 for axis in (0, 1)])
    seen = ~np.isnan(jumps)
    return _median(jumps[seen]) < 500 and _median(jumps[seen & turns]) < red_step / 2


def _median(values: npt.NDArray[np.float64]) -> float:
    return float(np.median(values)) if values.size else 0.0
