"""Speed against error: every level of detail and every installed peer, on one ground.

Everything is measured from the triangles, by the same code for all: what a maker says of its own
error is not asked.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.metadata import version
from itertools import count
from pathlib import Path
from typing import Any, Final

from ...arguments import whole
from ...device.device import Device
from ...device.layout import DEFAULT_TILE
from ...drawing.graphics import graphics_problem
from ...drawing.render import render
from ...ground.heightmap import Heightmap
from ...paths import replacing, require_made
from ...terrain.lod import (
    CoplanarityLod,
    DistanceLod,
    MaxErrorLod,
    ScreenErrorLod,
)
from .page import comparison_page
from .plots import save_plots
from .sweep import (
    contenders,
    installed,
    partitionings,
    tile_sizes,
)
from .trials import Course, Result, run
from .verdict import findings, speeds

# of the JSON file; raised when a key changes its meaning
FORMAT: Final = 1

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


@dataclass(frozen=True, eq=False)
class SweepReport:
    """What a comparison found and wrote.

    Attributes
    ----------
    course : Course
        Ground and cameras.
    sweep, tiles, partitionings : list of Result
        Every contender at one tile size; the promises at every tile size; distance LOD in every
        partitioning.
    findings, speeds : list of str
        Sentences: those that hold for every run, and those about time.
    missing : list of str
        Peers that are not installed.
    files : dict of str to Path
        ``html``, ``json``, ``csv``, ``times``, the plots, and pictures where this machine draws.
    """

    course: Course
    sweep: list[Result]
    tiles: list[Result]
    partitionings: list[Result]
    findings: list[str]
    speeds: list[str]
    missing: list[str]
    files: dict[str, Path]

    @property
    def results(self) -> list[Result]:
        return [*self.sweep, *self.tiles, *self.partitionings]


def compare_all(
    ground: Heightmap,
    directory: str | Path,
    *,
    tile: int = DEFAULT_TILE,
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
    directory : str or Path
        Made if it is not there.
    tile : int, optional
        Cells along a tile, of the sweep.
    views : int, optional
        Cameras on a low flight over the ground, 1 to 100.
    device : Device, optional
    progress : callable, optional
        Called with steps done and steps in all.

    Raises
    ------
    InputError, FileError, DeviceMemoryError
        If an option is not one of these, a file cannot be written, or the device is too small.
    """
    views = whole("views", views, 1, 100)
    folder = require_made(Path(directory))
    course = Course(ground, views, device or Device.open())
    course.terrain(tile)  # a wrong tile is refused before anything takes time
    groups = contenders(ground, tile), tile_sizes(ground), partitionings(tile)
    total = sum(map(len, groups)) + 1
    done = count(1)

    def step() -> None:
        if progress is not None:
            progress(next(done), total)

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
    _write_texts(made, folder)
    step()
    return made


def _pictures(course: Course, tile: int, folder: Path) -> dict[str, Path]:
    """Draw the first view of four levels of detail, coloured by their factors."""
    if graphics_problem() is not None:
        return {}
    pictures, terrain, camera = {}, course.terrain(tile), course.cameras[0]
    low, high = course.ground.height_range
    for lod in (
        ScreenErrorLod(1.0),
        MaxErrorLod(max(0.008 * (high - low), 1e-3)),
        DistanceLod(maximum=float(tile)),
        CoplanarityLod(maximum=float(tile)),
    ):
        name = type(lod).__name__
        path = folder / f"lod_{name}.png"
        mesh = terrain.mesh(camera, lod=lod)
        render(mesh, camera, path, style="lod", factor_range=(1.0, max(tile, 2)))
        pictures[name] = path
    return pictures


def _write_texts(made: SweepReport, folder: Path) -> None:
    texts = {
        "csv": ("compare.csv", _csv(made, _quantities)),
        "times": ("times.csv", _csv(made, lambda result: asdict(result.times))),
        "json": ("compare.json", _json(made)),
        "html": ("compare.html", comparison_page(made)),
    }
    for key, (name, text) in texts.items():
        with replacing(folder / name) as temporary:
            temporary.write_text(text, encoding="utf-8", newline="\n")
        made.files[key] = folder / name


def _who(result: Result) -> dict[str, Any]:
    contender = result.contender
    is_ours = contender.peer is None
    return {
        "family": contender.family,
        "parameter": contender.parameter,
        "unit": contender.unit,
        "edges": contender.edges or None,
        "tile": contender.tile or None,
        "partitioning": contender.partitioning if is_ours else None,
    }


def _quantities(result: Result) -> dict[str, Any]:
    values = {name: getattr(result, name) for name in _QUANTITIES}
    return {name: None if math.isnan(value) else value for name, value in values.items()}


def _csv(made: SweepReport, values: Callable[[Result], dict[str, Any]]) -> str:
    """Return a line a contender, in the order of the sweep."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    for index, result in enumerate(made.results):
        line = {**_who(result), **values(result)}
        if index == 0:
            writer.writerow(line)
        writer.writerow("" if value is None else value for value in line.values())
    return stream.getvalue()


def _json(made: SweepReport) -> str:
    ground = made.course.ground
    content = {
        "format": FORMAT,
        "terrain_lod": version("terrain_lod"),
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
    return json.dumps(content, indent=2, allow_nan=False) + "\n"
