"""What a picture says of itself, on a strip along its foot: colours, scale, north, light, camera.

::

    +--------------------------------------------------------------+
    |  title of the colours, unit    who and where           N     |
    |  [############ bar ########]   camera and light    |--2 km--| |
    |  440     1,000    2,000        triangles, error              |
    +--------------------------------------------------------------+
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache, lru_cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

from ..camera.camera import Camera
from ..ground.heightmap import Heightmap
from ..ground.place import said_in_degrees
from .colours import ramp, to_bytes
from .scales import Scale, nice, shortly

_INK: Final = (20, 26, 36, 255)
_GLASS: Final = (255, 255, 255, 205)
_TEXT: Final = 1 / 42  # of a picture's height
_SHARE: Final = 0.3  # of a picture's height, the most that a strip takes
_ROWS: Final = 3  # of text beside which bar and compass stand
_SMALLEST, _LARGEST = 10, 200  # pixels of a letter
_WINDS: Final = ("north", "north-east", "east", "south-east", "south", "south-west", "west",
                 "north-west")  # fmt: skip

Strip = npt.NDArray[np.uint8]
"""(H, W, 4) red, green, blue, opacity; row 0 at the top."""


def letter_size(height: int) -> int:
    """Return the size of letters in a picture so many pixels high."""
    return min(max(_SMALLEST, round(height * _TEXT)), _LARGEST)


def noted(
    picture: npt.NDArray[np.uint8],
    camera: Camera,
    lines: Sequence[str],
    *,
    scale: Scale | None = None,
    unit: str | None = None,
) -> npt.NDArray[np.uint8]:
    """Return a picture with a strip of notes over its foot; without where it has no room for one.

    Parameters
    ----------
    picture : (H, W, 3) uint8
    camera : Camera
        That it was taken with.
    lines : sequence of str
        What is said in words.
    scale : Scale, optional
        What its colours stand for.
    unit : str, optional
        Of x and y; None for what is no ground, which has neither north nor a scale bar.
    """
    strip = foot(camera, lines, scale=scale, unit=unit)
    if strip.shape[0] > _SHARE * picture.shape[0]:
        return picture
    part = picture[-strip.shape[0] :]
    shares = strip[..., 3:].astype(np.float32) / 255
    made = picture.copy()
    made[-strip.shape[0] :] = np.round(strip[..., :3] * shares + part * (1 - shares))
    return made


def foot(
    camera: Camera, lines: Sequence[str], *, scale: Scale | None = None, unit: str | None = None
) -> Strip:
    """Return the strip, as wide as the camera's picture."""
    width, height = camera.size
    size = letter_size(min(height, width))
    line, margin = _line(size), size * 3 // 4
    sides = (
        None if scale is None else bar(scale, size, max(width // 4, 8 * size)),
        None if unit is None else compass(camera, unit, size, max(width // 6, 6 * size)),
    )
    if sum(side.shape[1] for side in sides if side is not None) > width:
        sides = None, None  # hardly a picture: no room for either
    left, right = (0 if side is None else side.shape[1] for side in sides)
    font, room = _font(size), width - left - right - 2 * margin
    words = [part for text in lines for part in _wrapped(text, font, room)]
    rows = max(len(words), *(0 if side is None else _ROWS for side in sides))
    image = Image.new("RGBA", (width, rows * line + margin), _GLASS)
    pen = ImageDraw.Draw(image)
    for number, text in enumerate(words):
        pen.text((left + margin, margin // 2 + number * line), text, _INK, font=font)
    strip = np.array(image)
    for side, at in zip(sides, (0, width - right), strict=True):
        if side is not None:
            strip[: side.shape[0], at : at + side.shape[1]] = side
    return strip


@lru_cache(maxsize=64)
def bar(scale: Scale, size: int, width: int) -> Strip:
    """Return a colour bar with its title above and its numbers below, in letters of `size`."""
    line, margin = _line(size), size * 3 // 4
    image = Image.new("RGBA", (width, _ROWS * line + margin), _GLASS)
    _draw_bar(image, scale, (margin, margin // 2, width - 2 * margin, line), _font(size))
    return np.asarray(image)


def compass(camera: Camera, unit: str, size: int, width: int) -> Strip:
    """Return an arrow to the north above a bar of a round length, as long as it is mid-picture."""
    depth = math.dist(camera.eye, camera.target)
    pixels = camera.focal / (1.0 if camera.height is not None else depth)  # a unit of length
    # what is drawn from is rounded, so that a camera that moves a little has it drawn already
    east, north, _ = camera.axes[0]  # what points to the right of the picture is level
    turn = round(math.degrees(math.atan2(north, east)))
    return _compass(turn, float(f"{pixels:.2g}"), unit, size, width)


@lru_cache(maxsize=256)
def _compass(turn: int, pixels: float, unit: str, size: int, width: int) -> Strip:
    line, margin = _line(size), size * 3 // 4
    image = Image.new("RGBA", (width, _ROWS * line + margin), _GLASS)
    box = margin, margin // 2, width - 2 * margin, line
    _draw_compass(ImageDraw.Draw(image), turn, pixels, unit, box, _font(size))
    return np.asarray(image)


def _line(size: int) -> int:
    return round(1.35 * size)


def said_of(camera: Camera, sun: tuple[float, float] | None, exaggeration: float = 1.0) -> str:
    """Return where a camera looks, what lights the picture, and whether heights are exaggerated."""
    x, y, z = camera.axes[2]
    heading, pitch = math.degrees(math.atan2(x, y)) % 360, math.degrees(math.asin(z))
    level = "level" if abs(pitch) < 0.5 else f"{abs(pitch):.0f}° {'down' if pitch < 0 else 'up'}"
    if abs(pitch) > 89:
        view = "seen from straight above" if pitch < 0 else "seen from straight below"
    else:
        view = f"looking {_WINDS[round(heading / 45) % 8]} ({heading:.0f}°), {level}"
    lens = "parallel" if camera.height is not None else f"field of view {camera.fov:g}°"
    light = "" if sun is None else f"; sun from {sun[0] % 360:.0f}°, {sun[1]:.0f}° up"
    tall = "" if exaggeration == 1 else f"; heights × {exaggeration:g}"
    return f"{view}; {lens}{light}{tall}"


def said_of_ground(ground: Heightmap) -> str:
    """Return what a ground is called, how large it is and where its middle is."""
    across, _ = ground.unit_symbols
    width, depth = (_length(extent, across) for extent in ground.extent)
    x, y, _ = ground.centre
    place = said_in_degrees(ground.crs, x, y)
    return f"{ground.name}, {width} by {depth}" + (f", {place}" if place else "")


def _length(value: float, unit: str) -> str:
    if unit == "m" and value >= 1000:
        return f"{shortly(value / 1000)} km"
    return f"{shortly(value)} {unit}"


def _draw_bar(image: Image.Image, scale: Scale, box: tuple[int, int, int, int], font: Any) -> None:
    pen = ImageDraw.Draw(image)
    left, top, width, line = box
    title = f"{scale.title}, {scale.unit}" if scale.unit else scale.title
    pen.text((left, top), title, _INK, font=font)
    shares = np.linspace(0.0, 1.0, width, dtype=np.float32)
    colours = to_bytes(ramp(scale.stops, 1 - shares if scale.reverse else shares))
    bar = np.repeat(colours[None], line * 2 // 3, axis=0)
    place = left, top + line + line // 8
    image.paste(Image.fromarray(bar), place)
    under = place[1] + bar.shape[0]
    pen.rectangle((*place, left + width - 1, under), outline=_INK)
    ends = -1.0
    for at, text in scale.marks():
        extent = font.getlength(text)
        x = min(max(left + at * width - extent / 2, left), left + width - extent)
        last = left + width - font.getlength(scale.marks()[-1][1]) - line / 3
        if x < ends or (0 < at < 1 and x + extent > last):
            continue
        tick = left + min(at * width, width - 1)
        pen.line((tick, under, tick, under + line // 6), _INK)
        pen.text((x, under + line // 8), text, _INK, font=font)
        ends = x + extent + line / 3


def _draw_compass(
    pen: Any, turn: int, pixels: float, unit: str, box: tuple[int, int, int, int], font: Any
) -> None:
    left, top, width, line = box
    length = nice(0.9 * width / pixels)
    while length * pixels > 0.9 * width:
        length = nice(length / 2.5)
    extent, below = length * pixels, top + _ROWS * line - line // 8
    middle, thick = left + width / 2, max(2, line // 10)
    pen.line((middle - extent / 2, below, middle + extent / 2, below), _INK, thick)
    for end in (middle - extent / 2, middle + extent / 2):
        pen.line((end, below - line // 4, end, below), _INK, thick)
    label = f"{_length(length, unit)} mid-picture"
    if font.getlength(label) > width:
        label = _length(length, unit)
    pen.text((middle, below - line // 3), label, _INK, font=font, anchor="ms")
    # north as it is seen from above, turned with the camera; y goes down
    across, up = math.sin(math.radians(turn)), math.cos(math.radians(turn))
    ahead, side = np.array([across, -up]) * 0.62 * line, np.array([up, across]) * 0.28 * line
    centre = np.array([middle, top + 0.75 * line])
    corners = (centre + ahead, centre + side - 0.8 * ahead, centre - 0.4 * ahead,
               centre - side - 0.8 * ahead)  # fmt: skip
    pen.polygon([tuple(corner) for corner in corners], fill=_INK)
    pen.text((centre[0] + line, centre[1]), "N", _INK, font=font, anchor="lm")


def _wrapped(text: str, font: Any, room: float) -> list[str]:
    """Return a text in lines that are no longer than there is room."""
    lines, line = [], ""
    for word in text.split():
        longer = f"{line} {word}".strip()
        if line and font.getlength(longer) > room:
            lines.append(line)
            longer = word
        line = longer
    return [*lines, line]


@cache
def _font(size: int) -> Any:
    """Return the font that matplotlib brings: it has all signs that are written here."""
    found = find_spec("matplotlib")
    assert found is not None  # a dependency
    assert found.origin is not None
    path = Path(found.origin).parent / "mpl-data" / "fonts" / "ttf" / "DejaVuSans.ttf"
    return ImageFont.truetype(path, size) if path.exists() else ImageFont.load_default(size)
