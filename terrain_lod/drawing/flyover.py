"""Pictures along a camera path, one LOD or two side by side, with their counts in the picture.

A file a picture, written whole or not at all; what is there already is not made again, so a path
that was stopped goes on where it was.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw, ImageFont

from ..camera.camera import Camera
from ..camera.camera_file import camera_fields
from ..errors import FileError, InputError
from ..ground.exaggeration import exaggerated
from ..ground.heightmap import Heightmap
from ..measure.screen_error import screen_error
from ..mesh.mesh import Mesh
from ..mesh.stretched import stretched
from ..paths import replacing, require_made
from ..terrain.lod import AnyLod, checked_lod, unweighted
from ..terrain.terrain import Terrain
from .drape import Drape
from .exaggeration import ExaggeratedTerrain
from .graphics import require_graphics
from .picture import SUN, Picture, draw, save_png
from .scales import COMPARED, metres_above_sea

_NOTES: Final = "frames.json"  # cameras, as a path is read from, and what the pictures show

Shown = dict[str, Any]
"""A level of detail in a picture: its name, triangles, and largest error in pixels."""

_TEXT_HEIGHT: Final = 1 / 36  # of the picture
_GAP: Final = 2  # pixels between two pictures


@dataclass(frozen=True, eq=False)
class Look:
    """How pictures are drawn; see :func:`terrain_lod.render`."""

    style: str = "shaded"
    sun: tuple[float, float] = SUN
    drape: Drape | None = None
    wireframe: bool = False
    counts: bool = True
    exaggeration: float = 1.0
    sky_light: bool = True


def render_path(
    terrain: Terrain,
    cameras: Sequence[Camera],
    directory: str | Path,
    *,
    lods: Sequence[AnyLod],
    look: Look = Look(),
    edge_rule: str | None = None,
    partitioning: str | None = None,
    heights: str = "ground",
    progress: Callable[[int, int], None] | None = None,
) -> tuple[Path, ...]:
    """Write a picture a camera, named 0000.png and on.

    Parameters
    ----------
    terrain : Terrain
    cameras : sequence of Camera
    directory : str or Path
        Made if it is not there. Pictures that are there already stay.
    lods : sequence of Lod, PromiseLod or Weighted
        One, or two to be shown side by side.
    look : Look, optional
    edge_rule, partitioning, heights : str, optional
        As for :meth:`terrain_lod.Terrain.mesh`.
    progress : callable, optional
        Called with pictures done and pictures in all.

    Returns
    -------
    tuple of Path
        All pictures, those that were there included.

    Raises
    ------
    GraphicsError
        If this machine cannot draw.
    InputError
        If there are not one or two LODs, or the folder holds pictures of something else.
    FileError
        If the folder or a picture cannot be written.
    """
    meshing: dict[str, Any] = {
        "edge_rule": edge_rule,
        "partitioning": partitioning,
        "heights": heights,
    }
    if len(lods) not in (1, 2):
        raise InputError(f"expected one or two levels of detail, got {len(lods)}")
    for lod in lods:
        checked_lod(lod)
    require_graphics()
    folder = require_made(Path(directory))
    notes = _description(terrain, cameras, lods, look, meshing)
    drawn = _require_same(folder, notes)
    digits = max(4, len(str(len(cameras) - 1)))
    paths = tuple(folder / f"{number:0{digits}d}.png" for number in range(len(cameras)))
    tall = ExaggeratedTerrain(terrain, look.exaggeration)
    for number, (camera, path) in enumerate(zip(cameras, paths, strict=True)):
        if not path.exists():
            picture, shown = _picture(terrain, tall, camera, lods, look, meshing)
            save_png(picture, path)
            drawn[path.name] = shown
            _write_notes(folder, notes, drawn)
        if progress is not None:
            progress(number + 1, len(cameras))
    return paths


def _picture(
    terrain: Terrain,
    tall: ExaggeratedTerrain,
    camera: Camera,
    lods: Sequence[AnyLod],
    look: Look,
    meshing: dict[str, Any],
) -> tuple[Picture, list[Shown]]:
    """Return the picture of one camera, a part of its width a LOD, and what is in it."""
    width, height = camera.size
    part = (width - _GAP * (len(lods) - 1)) // len(lods)
    picture = np.full((height, width, 3), 255, np.uint8)
    drawn = []
    for number, lod in enumerate(lods):
        seen = replace(camera, size=(max(1, part), height))
        mesh = tall.mesh(seen, lod=lod, **meshing)
        shown = draw(
            mesh,
            seen,
            style=look.style,
            colour_range=COMPARED.get(look.style),
            sun=look.sun,
            height_range=terrain.ground.height_range,
            metres=metres_above_sea(terrain.ground),
            exaggeration=look.exaggeration,
            sky_light=tall.sky_light() if look.sky_light else None,
            drape=look.drape,
            wireframe=look.wireframe,
        )
        entry = _entry(terrain, mesh, lod, seen, look.exaggeration)
        drawn.append(entry)
        if look.counts:
            shown = _labelled(shown, f"{entry['lod']}: {_counted(entry)}")
        left = number * (part + _GAP)
        picture[:, left : left + shown.shape[1]] = shown
    return picture, drawn


def _entry(terrain: Terrain, mesh: Mesh, lod: AnyLod, camera: Camera, exaggeration: float) -> Shown:
    """Return what a picture shows of a level of detail; its error is measured, whatever it is."""
    error = screen_error(
        stretched(mesh, exaggeration),
        exaggerated(terrain.ground, exaggeration),
        camera.lifted(exaggeration),
        device=terrain.device,
    )
    return {
        "lod": type(unweighted(lod)).__name__.removesuffix("Lod"),
        "triangles": len(mesh.triangles),
        "pixels": error.maximum if error.samples else None,
    }


def _counted(entry: Shown) -> str:
    text = f"{entry['triangles']:,} triangles"
    return text if entry["pixels"] is None else f"{text}, error {entry['pixels']:.3g} px"


def _labelled(picture: Picture, text: str) -> Picture:
    """Return the picture with a line of text at its lower left."""
    image = Image.fromarray(picture)
    size = max(9, round(picture.shape[0] * _TEXT_HEIGHT))
    font = ImageFont.load_default(size)
    pen = ImageDraw.Draw(image, "RGBA")
    place = (size // 2, picture.shape[0] - size // 2)
    box = pen.textbbox(place, text, font=font, anchor="ls")
    margin = size // 3
    pen.rectangle(
        (box[0] - margin, box[1] - margin, box[2] + margin, box[3] + margin), (255, 255, 255, 190)
    )
    pen.text(place, text, (20, 26, 36), font=font, anchor="ls")
    return np.asarray(image)


def _description(
    terrain: Terrain,
    cameras: Sequence[Camera],
    lods: Sequence[AnyLod],
    look: Look,
    meshing: dict[str, Any],
) -> dict[str, Any]:
    """Return what makes the pictures what they are."""
    detail = None if terrain.detail is None else _fingerprint(terrain.detail)
    drape = None if look.drape is None else _digest(look.drape.picture)
    return {
        "ground": [_fingerprint(terrain.ground), detail],
        "tiles": [terrain.grid.tile, _digest(terrain.analysis.deviation)],
        "cameras": [camera_fields(camera) for camera in cameras],
        "lods": [repr(lod) for lod in lods],
        **meshing,
        "look": [look.style, list(look.sun), look.wireframe, look.counts, drape],
        "light": [look.exaggeration, look.sky_light],
    }


def _fingerprint(ground: Heightmap) -> list[object]:
    """Return what tells a ground from every other."""
    mask = None if ground.mask is None else _digest(ground.mask)
    return [_digest(ground.heights), mask, ground.base, *ground.spacing, *ground.origin]


def _digest(values: npt.NDArray[Any]) -> str:
    shape = repr((values.shape, values.dtype.str)).encode()
    return sha256(shape + np.ascontiguousarray(values).tobytes()).hexdigest()


def _require_same(folder: Path, description: dict[str, Any]) -> dict[str, list[Shown]]:
    """Make sure that a folder's pictures are of the same; return what is drawn, by file."""
    notes, as_written = folder / _NOTES, json.loads(json.dumps(description))
    try:
        known = json.loads(notes.read_text(encoding="utf-8")) if notes.exists() else None
    except ValueError:
        known = None
    except OSError as error:
        raise FileError(f"cannot read {notes}: {error.strerror}") from None
    if isinstance(known, dict) and known.items() >= as_written.items():
        drawn: dict[str, list[Shown]] = known.get("drawn", {})
        return drawn
    if any(folder.glob("[0-9]*.png")):
        noted = known if isinstance(known, dict) else {}
        changed = ", ".join(name for name in description if noted.get(name) != as_written[name])
        raise InputError(
            f"expected a folder of the same pictures to go on with, got {folder} with other "
            f"{changed}: empty it or choose another"
        )
    _write_notes(folder, description, {})
    return {}


def _write_notes(folder: Path, description: dict[str, Any], drawn: dict[str, list[Shown]]) -> None:
    """Write what the pictures of a folder show; its cameras are read again as a path."""
    with replacing(folder / _NOTES) as temporary:
        text = json.dumps({**description, "drawn": drawn}, indent=1)
        temporary.write_text(text + "\n", encoding="utf-8")
