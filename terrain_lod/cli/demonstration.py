"""The main job on one ground: a mesh, a picture, a report, and a list of what was made."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from ..camera.viewpoint import default_camera
from ..device.device import Device
from ..drawing.graphics import graphics_problem
from ..drawing.render import render
from ..ground.heightmap import Heightmap
from ..measure.cracks import crack_report
from ..measure.screen_error import screen_error
from ..paths import require_made
from ..reports.report import report
from ..terrain.terrain import Terrain

_CONTENTS: Final = {
    "html": "the report, to read or to mail",
    "json": "its numbers",
    "csv": "its numbers as a table",
    "maps": "ground, detail and error from above",
    "lod_distance": "detail, distance LOD",
    "lod_coplanarity": "detail, coplanarity LOD",
    "lod_screen-error": "detail, screen-error LOD",
    "close_distance": "single triangles, distance LOD",
    "close_coplanarity": "single triangles, coplanarity LOD",
    "close_screen-error": "single triangles, screen-error LOD",
    "shaded_distance": "picture, distance LOD",
    "shaded_coplanarity": "picture, coplanarity LOD",
    "shaded_screen-error": "picture, screen-error LOD",
    "difference": "difference of the first two pictures",
}


@dataclass(frozen=True)
class Demo:
    """What was made.

    Attributes
    ----------
    rows : tuple of (str, str, str)
        File name, what it holds, its size.
    verdict : tuple of str
        Of the report, in sentences.
    no_pictures : str or None
        Why there are no 3-D pictures.
    """

    rows: tuple[tuple[str, str, str], ...]
    verdict: tuple[str, ...]
    no_pictures: str | None


def make_demo(
    ground: Heightmap,
    folder: str | Path,
    *,
    tile: int | None = None,
    levels: int | None = None,
    plane: str = "least_squares",
    device: Device | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Demo:
    """Write a GLB mesh, a picture and a report of `ground`, as :func:`terrain_lod.report` takes it.

    Raises what that does.
    """
    device = Device.of(device)
    camera = default_camera(ground)
    options: dict[str, Any] = {"tile": tile, "levels": levels, "plane": plane, "device": device}
    mesh = Terrain(ground, **options).mesh(camera, cull=False)
    folder = require_made(Path(folder))
    path = mesh.save(folder / f"{ground.name}.glb")
    sound = "cracks in it" if crack_report(mesh) else "watertight"
    error = screen_error(mesh, ground, camera, device=device)
    within = f"within {error.maximum:.3g} pixels"
    rows = [_row(path, f"mesh: {len(mesh.triangles):,} triangles, {sound}, {within}")]
    problem = graphics_problem()
    if problem is None:
        path = folder / f"{ground.name}.png"
        render(mesh, path, camera=camera, height_range=ground.height_range)
        rows.append(_row(path, "picture of it"))
    made = report(ground, folder, camera=camera, **options, progress=progress)
    rows += [_row(made.files[kind], what) for kind, what in _CONTENTS.items() if kind in made.files]
    return Demo(tuple(rows), made.verdict, problem)


def _row(path: Path, what: str) -> tuple[str, str, str]:
    count = path.stat().st_size
    size = f"{count / 1e6:.1f} MB" if count >= 1e5 else f"{count / 1e3:.1f} kB"
    return str(path), what, size
