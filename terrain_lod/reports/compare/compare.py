"""Speed against error: every level of detail and every installed peer, on one ground.

Everything is measured from the triangles, by the same code for all: what a maker says of its own
error is not asked.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

from ...arguments import file_path, instance, whole
from ...device import layout
from ...device.device import Device
from ...drawing.graphics import graphics_problem
from ...drawing.picture import draw, save_png
from ...drawing.scales import COMPARED
from ...ground.heightmap import Heightmap
from ...paths import require_made
from ...terrain.lod import PromiseLod, Weighted, unweighted
from ..texts import Steps, csv_text, json_text, write_texts
from .outcome import SweepReport
from .page import comparison_page
from .plots import save_plots
from .sweep import contenders, drawn, installed, partitionings, tile_sizes
from .trials import Course, Result, run
from .verdict import findings, speeds

# of the JSON file; raised when a key changes its meaning
FORMAT: Final = 3

_QUANTITIES: Final = {
    "triangles": "",
    "metres": "m",
    "metres_rms": "m",
    "pixels": "pixels",
    "pixels_rms": "pixels",
    "pop": "pixels",
    "pop_rms": "pixels",
    "uncovered": "samples",
    "mesh_bytes": "bytes",
    "device_bytes": "bytes",
}


def compare(
    ground: Heightmap,
    folder: str | Path,
    *,
    tile: int | None = None,
    views: int = 3,
    device: Device | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> SweepReport:
    """Measure every level of detail and every installed peer over a camera path; write it down.

    The same ground and device give the same ``compare.json``, ``compare.csv`` and plot of
    triangles every time; ``compare.html`` (self-contained) and ``times.csv`` hold times as well.

    Parameters
    ----------
    ground : Heightmap
    folder : str or Path
        Made if it is not there.
    tile : int, optional
        Cells along a tile, of the sweep. Default: 4 in the quadtrees of promises, 15 in the flat
        grids of formulas, as for :class:`Terrain`.
    views : int, optional
        Cameras on a low flight over the ground, 1 to 100.
    device : Device, optional
    progress : callable, optional
        Called with steps done and steps in all.

    Returns
    -------
    SweepReport

    Raises
    ------
    InputError, FileError, DeviceMemoryError
        If an option is not one of these, a file cannot be written, or the device is too small.
    """
    instance("a Heightmap for ground", ground, Heightmap)
    views = whole("views", views, 1, 100)
    tile = None if tile is None else whole("tile", tile, 1, layout.MAX_TILE)
    folder, course = file_path("folder", folder), Course(ground, views, Device.of(device))
    groups = contenders(ground, tile), tile_sizes(ground), partitionings(tile)
    step = Steps(progress, sum(map(len, groups)) + 1)
    require_made(folder)
    sweep, tiles, ways = (run(course, group, step) for group in groups)
    made = SweepReport(
        course,
        sweep,
        tiles,
        ways,
        findings(sweep, tiles, ways),
        speeds(sweep),
        installed()[1],
        {**save_plots(sweep, folder), **_pictures(course, tile, folder)},
    )
    made.files.update(write_texts(folder, _texts(made)))
    step()
    return made


def _pictures(course: Course, tile: int | None, folder: Path) -> dict[str, Path]:
    """Draw the first view of every level of detail, coloured by its factors."""
    if graphics_problem() is not None:
        return {}
    pictures, camera = {}, course.cameras[0]
    for lod in drawn(course.ground, tile):
        name = "Weighted" if isinstance(lod, Weighted) else type(lod).__name__
        terrain = course.terrain(tile, flat=not isinstance(unweighted(lod), PromiseLod))
        mesh = terrain.mesh(camera, lod=lod)
        picture = draw(mesh, camera, style="lod", colour_range=COMPARED["lod"])
        pictures[name] = save_png(picture, folder / f"lod_{name}.png")
    return pictures


def _texts(made: SweepReport) -> dict[str, tuple[str, str]]:
    """Return the page and the numbers, each under the name of its file."""
    return {
        "csv": ("compare.csv", csv_text(_lines(made, _quantities))),
        "times": ("times.csv", csv_text(_lines(made, lambda result: asdict(result.times)))),
        "json": ("compare.json", json_text(FORMAT, _content(made))),
        "html": ("compare.html", comparison_page(made)),
    }


def _who(result: Result) -> dict[str, Any]:
    contender = result.contender
    is_ours = contender.peer is None
    return {
        "family": contender.family,
        "parameter": contender.parameter,
        "unit": contender.unit,
        "edge_rule": contender.edge_rule or None,
        "tile": contender.tile or None,
        "partitioning": (contender.partitioning or None) if is_ours else None,
    }


def _quantities(result: Result) -> dict[str, Any]:
    values = {name: getattr(result, name) for name in _QUANTITIES}
    return {name: None if math.isnan(value) else value for name, value in values.items()}


def _lines(
    made: SweepReport, values: Callable[[Result], dict[str, Any]]
) -> Iterator[Iterable[object]]:
    """Yield a line a contender, in the order of the sweep, under the names of what is in it."""
    lines = [{**_who(result), **values(result)} for result in made.results]
    yield lines[0]
    yield from (line.values() for line in lines)


def _content(made: SweepReport) -> dict[str, Any]:
    ground = made.course.ground
    return {
        "ground": {"name": ground.name, "rows": ground.shape[0], "columns": ground.shape[1]},
        "cameras": [
            {"eye": camera.eye, "target": camera.target, "fov": camera.fov, "size": camera.size}
            for camera in made.course.cameras
        ],
        "device": str(made.course.device.info),
        "peers_missing": made.missing,
        "units": {
            name: made.course.ground.unit_symbols[1] if unit == "m" else unit
            for name, unit in _QUANTITIES.items()
            if unit
        },
        **{
            name: [{**_who(result), **_quantities(result)} for result in getattr(made, name)]
            for name in ("sweep", "tiles", "partitionings")
        },
        "findings": made.findings,
    }
