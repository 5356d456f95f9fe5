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
from functools import cache
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
_SMALLEST, _LARGEST = 10, 200  # pixels of a letter
_BAR: Final = 1 / 5  # of a line, the most that a scale bar takes
_WINDS: Final = ("north", "north-east", "east", "south-east", "south", "south-west", "west",
                 "north-west")  # fmt: skip


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
    """Return a picture with a strip of notes over its foot.

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
    strip = foot(camera, lines, scale=scale, unit=unit)[-picture.shape[0] :]
    part = picture[-strip.shape[0] :]
    shares = strip[..., 3:].astype(np.float32) / 255
    made = picture.copy()
    made[-strip.shape[0] :] = np.round(strip[..., :3] * shares + part * (1 - shares))
    return made


def foot(
    camera: Camera, lines: Sequence[str], *, scale: Scale | None = None, unit: str | None = None
) -> npt.NDArray[np.uint8]:
    """Return the strip: (H, W, 4) uint8, as wide as the camera's picture, the last opacity."""
    width, height = camera.size
    size = letter_size(min(height, width))
    font, margin = _font(size), size * 3 // 4
    left = 0 if scale is None else max(width // 4, 8 * size)
    right = 0 if unit is None else max(width // 6, 6 * size)
    if left + right > width:  # hardly a picture: no room for either
        left = right = 0
    room = width - left - right - 2 * margin
    words = [part for line in lines for part in _wrapped(line, font, room)]
    rows = max(len(words), 3 if scale is not None or unit is not None else 1)
    line = round(1.35 * size)
    image = Image.new("RGBA", (width, rows * line + margin), _GLASS)
    pen = ImageDraw.Draw(image)
    top = margin // 2
    if scale is not None and left:
        _draw_bar(image, pen, scale, (margin, top, left - 2 * margin, line), font)
    for number, text in enumerate(words):
        pen.text((left + margin, top + number * line), text, _INK, font=font)
    if unit is not None and right:
        _draw_scale(pen, camera, unit, (width - right, top, right - margin, line), font)
    return np.asarray(image)


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


def _draw_bar(
    image: Image.Image, pen: Any, scale: Scale, box: tuple[int, int, int, int], font: Any
) -> None:
    """Draw a colour bar with its title above and its numbers below."""
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
    for at, text in _in_order(scale.marks()):
        extent = font.getlength(text)
        x = min(max(left + at * width - extent / 2, left), left + width - extent)
        last = left + width - font.getlength(scale.marks()[-1][1]) - line / 3
        if x < ends or (0 < at < 1 and x + extent > last):
            continue
        tick = left + min(at * width, width - 1)
        pen.line((tick, under, tick, under + line // 6), _INK)
        pen.text((x, under + line // 8), text, _INK, font=font)
        ends = x + extent + line / 3


def _in_order(marks: tuple[tuple[float, str], ...]) -> list[tuple[float, str]]:
    return sorted(marks)


def _draw_scale(
    pen: Any, camera: Camera, unit: str, box: tuple[int, int, int, int], font: Any
) -> None:
    """Draw an arrow to the north and a bar of a round length, as long as it is mid-picture."""
    left, top, width, line = box
    target = np.array(camera.target)
    depth = float(np.linalg.norm(np.subtract(camera.eye, target)))
    pixels = camera.focal / (1.0 if camera.height is not None else depth)  # a unit of length
    longest = 0.9 * width
    length = nice(longest / pixels)
    while length * pixels > longest:
        length = nice(length / 2.5)
    extent, foot = length * pixels, top + 3 * line - line // 8
    middle = left + width / 2
    pen.line((middle - extent / 2, foot, middle + extent / 2, foot), _INK, max(2, line // 10))
    for end in (middle - extent / 2, middle + extent / 2):
        pen.line((end, foot - line // 4, end, foot), _INK, max(2, line // 10))
    label = f"{_length(length, unit)} mid-picture"
    if font.getlength(label) > width:
        label = _length(length, unit)
    pen.text((middle, foot - line // 4), label, _INK, font=font, anchor="ms")
    # north as it is seen from above, turned with the camera
    east, north_, _ = camera.axes[0]  # what points to the right of the picture is level
    north = np.array([north_, east]) / (np.hypot(east, north_) or 1.0)
    reach, centre = 0.62 * line, np.array([middle, top + 0.85 * line])
    ahead, side = north * [1, -1] * reach, np.array([north[1], north[0]]) * reach * 0.45
    pen.polygon(
        [tuple(centre + ahead), tuple(centre - ahead * 0.8 + side), tuple(centre - ahead * 0.4),
         tuple(centre - ahead * 0.8 - side)],
        fill=_INK,
    )  # fmt: skip
    pen.text(tuple(centre + (line, 0)), "N", _INK, font=font, anchor="lm")


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
