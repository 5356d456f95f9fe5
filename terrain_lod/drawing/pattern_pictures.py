"""Pictures of tessellation patterns: one patch as SVG, PNG or PDF, many as an animation."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from ..arguments import one_of, whole
from ..errors import InputError
from ..paths import replacing
from ..tessellation.pattern import Pattern
from .pattern_drawing import Factors, draw_pattern

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from PIL import Image

PICTURES: Final = (".svg", ".png", ".pdf")

_STYLE: Final = {
    "svg.hashsalt": "terrain_lod",  # the same names in the file every time
    "svg.fonttype": "none",
    "font.family": ["DejaVu Sans", "sans-serif"],
    "font.size": 9,
}


def save_pattern(
    pattern: Pattern,
    path: str | Path,
    *,
    edge_factors: npt.ArrayLike | None = None,
    inside_factors: npt.ArrayLike | None = None,
    patch: int = 0,
) -> Path:
    """Draw one patch of a pattern.

    Parameters
    ----------
    pattern : Pattern
    path : str or pathlib.Path
        .svg, .png or .pdf; the same bytes for the same numbers.
    edge_factors, inside_factors : (P, n) array_like, optional
        What the pattern was made from, to label it with; levels, where it is semi-uniform.
    patch : int, optional

    Raises
    ------
    InputError
        If the ending is another, there is no such patch, or factors are not of as many patches.
    FileError
        If the file cannot be written.
    """
    final = Path(path)
    ending = one_of("picture format", final.suffix.lower(), PICTURES)
    if pattern.patch_count == 0:
        raise InputError("expected a pattern of at least one patch to draw, got none")
    patch = whole("patch", patch, 0, pattern.patch_count - 1)
    labels = _checked(pattern, edge_factors), _checked(pattern, inside_factors)

    def save(figure: Figure) -> None:
        draw_pattern(figure, pattern, patch, labels)
        dates = {"Date": None} if ending == ".svg" else {}
        dates = {"CreationDate": None} if ending == ".pdf" else dates
        with replacing(final) as temporary:
            figure.savefig(temporary, format=ending[1:], dpi=150, metadata=dates)

    _with_figure((5.6, 6.0), save)
    return final


def save_animation(
    pattern: Pattern,
    path: str | Path,
    *,
    edge_factors: npt.ArrayLike | None = None,
    inside_factors: npt.ArrayLike | None = None,
    seconds: float = 0.06,
    progress: Callable[[int, int], None] | None = None,
) -> Path:
    """Draw all patches of a pattern, one after the other and back, as a GIF.

    Parameters
    ----------
    pattern : Pattern
        A patch a frame.
    path : str or pathlib.Path
        .gif
    edge_factors, inside_factors : (P, n) array_like, optional
        To label each frame with.
    seconds : float, optional
        That a frame is seen.
    progress : callable, optional
        Takes the frames done and the frames in all.

    Raises
    ------
    InputError
        If the ending is another, there are no patches, or factors are not of as many patches.
    FileError
        If the file cannot be written.
    """
    final = Path(path)
    one_of("animation format", final.suffix.lower(), (".gif",))
    if pattern.patch_count == 0:
        raise InputError("expected a pattern of at least one patch to draw, got none")
    labels = _checked(pattern, edge_factors), _checked(pattern, inside_factors)
    pictures: list[npt.NDArray[np.uint8]] = []

    def shoot(figure: Figure) -> None:
        canvas: Any = figure.canvas
        for patch in range(pattern.patch_count):
            figure.clear()
            draw_pattern(figure, pattern, patch, labels)
            canvas.draw()
            pictures.append(np.array(canvas.buffer_rgba())[..., :3])
            if progress is not None:
                progress(patch + 1, pattern.patch_count)

    _with_figure((3.6, 3.85), shoot)
    frames = _with_one_palette(pictures)
    with replacing(final) as temporary:
        frames[0].save(
            temporary,
            save_all=True,
            append_images=[*frames[1:], *frames[-2:0:-1]],
            duration=round(1000 * seconds),
            loop=0,
        )
    return final


def _with_one_palette(pictures: list[npt.NDArray[np.uint8]]) -> list[Image.Image]:
    """Return pictures (height, width, 3) in the same few colours, so that none flickers."""
    from PIL import Image

    some = Image.fromarray(np.concatenate(pictures[:: max(len(pictures) // 6, 1)]))
    palette = some.quantize(64, method=Image.Quantize.MAXCOVERAGE)
    return [
        Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE)
        for picture in pictures
    ]


def _with_figure(size: tuple[float, float], use: Callable[[Figure], None]) -> None:
    """Call `use` with an empty figure of `size` in inches, in our style."""
    import matplotlib as mpl
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=size)
        FigureCanvasAgg(figure)
        use(figure)


def _checked(pattern: Pattern, factors: npt.ArrayLike | None) -> Factors | None:
    if factors is None:
        return None
    rows = np.asarray(factors)
    if rows.ndim != 2 or len(rows) != pattern.patch_count:
        raise InputError(
            f"expected factors of {pattern.patch_count} patches to label, got shape {rows.shape}"
        )
    return rows
