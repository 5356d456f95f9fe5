"""The 3-D pictures of a report and their difference: the book's figures 9.22 to 9.24."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from ..drawing.graphics import graphics_problem
from ..drawing.picture import Picture, draw, save_png
from .comparison import Comparison
from .maps import factor_range

# "the difference is very rarely above 15%", says the text to figure 9.24
VISIBLE_DIFFERENCE: Final = 0.15

STYLES: Final = ("lod", "wireframe", "shaded")
COUNT: Final = 2 * len(STYLES) + 1


@dataclass(frozen=True)
class Difference:
    """How much two pictures differ, as shares of black to white.

    Attributes
    ----------
    mean, largest : float
        Over the pixels.
    visible_share : float
        Share of the pixels that differ by more than 15 %.
    similarity : float
        Structural similarity (Wang et al. 2004) of the two in grey: 1 where they are the same.
    """

    mean: float
    largest: float
    visible_share: float
    similarity: float


def save_pictures(
    comparison: Comparison, directory: Path, step: Callable[[], None] = lambda: None
) -> tuple[dict[str, Path], Difference | None]:
    """Draw both levels of detail in every style, and the difference of the shaded pictures.

    Returns
    -------
    dict of str to Path
        Of ``lod_distance``, ``shaded_coplanarity``, ..., ``difference``; empty where this machine
        cannot draw.
    Difference or None
    """
    if graphics_problem() is not None:
        return {}, None
    paths: dict[str, Path] = {}
    shaded: list[Picture] = []
    for style in STYLES:
        for trial in (comparison.distance, comparison.other):
            name = f"{style}_{trial.name}"
            picture = draw(
                trial.mesh,
                comparison.camera,
                style="factor" if style == "lod" else style,
                height_range=comparison.terrain.ground.height_range,
                factor_range=factor_range(comparison),
            )
            paths[name] = save_png(picture, directory / f"{name}.png")
            if style == "shaded":
                shaded.append(picture)
            step()
    picture, difference = differing(*shaded)
    paths["difference"] = save_png(picture, directory / "difference.png")
    step()
    return paths, difference


def differing(first: Picture, second: Picture) -> tuple[Picture, Difference]:
    """Return where and how much two pictures of at least 7 x 7 pixels differ.

    Returns
    -------
    (H, W, 3) uint8
        Black where they are the same, white where one is black and the other white; in between
        the square root of the difference, for small ones would not be seen.
    Difference
    """
    from skimage.metrics import structural_similarity

    share = np.abs(first.astype(np.int16) - second).mean(axis=-1) / 255
    grey = np.repeat(np.round(255 * np.sqrt(share)).astype(np.uint8)[..., None], 3, axis=-1)
    visible = float(np.mean(share > VISIBLE_DIFFERENCE))
    greys = (picture.mean(axis=-1) / 255 for picture in (first, second))
    similarity = float(structural_similarity(*greys, data_range=1.0))
    return grey, Difference(float(share.mean()), float(share.max()), visible, similarity)
