"""The 3-D pictures of a report and their difference: the book's figures 9.22 to 9.24."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from ..camera.camera import Camera
from ..drawing.graphics import graphics_problem
from ..drawing.picture import Picture, draw, save_png
from ..drawing.scales import COMPARED
from .comparison import Comparison

# "the difference is very rarely above 15%", says the text to figure 9.24
VISIBLE_DIFFERENCE: Final = 0.15

COUNT: Final = 4  # steps: three kinds of pictures, and the difference

# triangles that a close-up shows, more or less, and how near it goes
_CLOSE: Final = 120
_ZOOM: Final = (3.0, 60.0)


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
    """Draw every level of detail as asked for, and close by with as many triangles.

    Returns
    -------
    dict of str to Path
        Of ``lod_distance``, ``shaded_coplanarity``, ``close_screen-error``, ..., and
        ``difference``, that of the first two shaded pictures; empty where this machine cannot
        draw.
    Difference or None
    """
    if graphics_problem() is not None:
        return {}, None
    camera, paths = comparison.camera, dict[str, Path]()

    def save(name: str, picture: Picture) -> Picture:
        paths[name] = save_png(picture, directory / f"{name}.png")
        return picture

    height_range = comparison.terrain.ground.height_range
    for trial in comparison.asked:
        save(
            f"lod_{trial.name}", draw(trial.mesh, camera, style="lod", colour_range=COMPARED["lod"])
        )
    step()
    shaded = [
        save(f"shaded_{trial.name}", draw(trial.mesh, camera, height_range=height_range))
        for trial in comparison.asked
    ]
    step()
    near, close = close_camera(comparison), comparison.equal_triangles or comparison.asked
    for asked, trial in zip(comparison.asked, close, strict=True):
        seen = draw(trial.mesh, near, style="wireframe")
        save(f"close_{asked.name}", seen)
    step()
    picture, difference = differing(*shaded[:2])
    save("difference", picture)
    step()
    return paths, difference


def close_camera(comparison: Comparison) -> Camera:
    """Return the camera turned to where distance LOD is farthest off in it, and zoomed in."""
    camera, ground = comparison.camera, comparison.terrain.ground
    trial = (comparison.equal_triangles or comparison.asked)[0]
    zoom = float(np.clip(np.sqrt(trial.triangles / _CLOSE), *_ZOOM))
    target = camera.target
    if trial.seen.where is not None:
        row, column = trial.seen.where
        (x, y), (dx, dy) = ground.origin, ground.spacing
        height = ground.base + float(ground.heights[row, column])
        target = (x + column * dx, y - row * dy, height)
    fov = 2 * np.degrees(np.arctan(np.tan(np.radians(camera.fov) / 2) / zoom))
    height_seen = None if camera.height is None else camera.height / zoom
    return replace(camera, target=target, fov=float(fov), height=height_seen)


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
