"""A report on a ground: levels of detail at one camera, in numbers, pictures and words."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Final

from ..arguments import file_path, instance
from ..camera.camera import Camera
from ..camera.viewpoint import default_camera
from ..device.device import Device
from ..drawing.graphics import graphics_problem
from ..ground.heightmap import Heightmap
from ..paths import require_made
from ..terrain.lod import AnyLod, checked_lod, unweighted
from ..terrain.lod_formulas import CoplanarityLod, DistanceLod
from ..terrain.terrain import Terrain
from .comparison import Comparison, compare_at
from .maps import save_maps
from .page import page
from .pictures import COUNT, Difference, save_pictures
from .tables import Row, rows_of
from .texts import Steps, csv_text, json_text, write_texts
from .verdict import verdict

# of the JSON file; raised when a key changes its meaning
FORMAT: Final = 4

_STEPS: Final = 1 + 3 + COUNT + 1 + 1  # terrain, trials, pictures, maps, texts


@dataclass(frozen=True, eq=False)
class Report:
    """What a report found and wrote.

    Attributes
    ----------
    comparison : Comparison
    rows : tuple of Row
        Every number, with its unit.
    verdict : tuple of str
        Sentences.
    files : dict of str to Path
        ``html``, ``json``, ``csv``, ``maps`` and, where this machine can draw, the pictures.
    no_pictures : str or None
        Why there are no 3-D pictures.
    """

    comparison: Comparison
    rows: tuple[Row, ...]
    verdict: tuple[str, ...]
    files: dict[str, Path]
    no_pictures: str | None


def report(
    ground: Heightmap,
    folder: str | Path,
    *,
    camera: Camera | None = None,
    tile: int | None = None,
    levels: int | None = None,
    plane: str = "least_squares",
    lod: AnyLod | None = None,
    distance: DistanceLod | None = None,
    edge_rule: str | None = None,
    partitioning: str = "fractional_odd",
    device: Device | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Report:
    """Compare distance, coplanarity and screen-error LOD at one camera, and write it down.

    As asked for, with as many triangles, and as far off in the picture: :class:`DistanceLod` and
    :class:`ScreenErrorLod` are tuned until they draw as many triangles as `lod` does, and until
    their largest error in the picture is that of `lod`.

    Writes ``report.html`` (self-contained), ``report.json``, ``report.csv``, ``maps.svg`` and,
    where this machine can draw, PNG pictures of each in several styles and of a difference. The
    same ground, camera and device give the same files, save for times.

    Parameters
    ----------
    ground : Heightmap
    folder : str or Path
        Made if it is not there.
    camera : Camera, optional
        Default: an oblique view over the ground.
    tile, levels, plane, device : optional
        As for :class:`Terrain`. Formulas are tried on its flat grid, which is the book's, unless
        `levels` are given.
    lod : Lod, PromiseLod or Weighted, optional
        What distance and screen-error LOD are compared with. Default: ``CoplanarityLod()``.
    distance : DistanceLod, optional
        Default: ``DistanceLod()``.
    edge_rule, partitioning : str, optional
        Of formulas, as for :meth:`Terrain.mesh`.
    progress : callable, optional
        Called with steps done and steps in all.

    Returns
    -------
    Report

    Raises
    ------
    InputError
        If an option is not one of these.
    FileError
        If the folder or a file cannot be written.
    DeviceMemoryError
        If the device cannot hold the ground or a mesh.
    """
    lod = CoplanarityLod() if lod is None else checked_lod(lod)
    distance = DistanceLod() if distance is None else distance
    instance("a DistanceLod for distance", distance, DistanceLod)
    folder = file_path("folder", folder)
    step = Steps(progress, _STEPS)
    terrain = Terrain(ground, tile=tile, levels=levels or 1, plane=plane, device=device)
    tree = Terrain(ground, tile=tile, levels=levels, plane=plane, device=device)
    step()
    camera = default_camera(ground) if camera is None else camera
    comparison = compare_at(
        terrain,
        instance("a Camera for camera", camera, Camera),
        distance=distance,
        lod=lod,
        tree=tree,
        edge_rule=edge_rule,
        partitioning=partitioning,
        step=step,
    )
    folder = require_made(folder)
    files, difference = save_pictures(comparison, folder, step)
    files["maps"] = save_maps(comparison, folder / "maps.svg")
    step()
    made = Report(
        comparison,
        tuple(rows_of(comparison)),
        tuple(verdict(comparison)),
        files,
        graphics_problem(),
    )
    made.files.update(write_texts(folder, _texts(made, difference)))
    step.finish()
    return made


def _texts(made: Report, difference: Difference | None) -> dict[str, tuple[str, str]]:
    """Return the page and the numbers, each under the name of its file."""
    text = page(
        made.comparison,
        made.rows,
        made.verdict,
        made.files,
        difference,
        no_pictures=made.no_pictures,
    )
    return {
        "html": ("report.html", text),
        "json": ("report.json", json_text(FORMAT, _content(made, difference))),
        "csv": ("report.csv", csv_text(_lines(made))),
    }


def _lines(made: Report) -> Iterator[list[str]]:
    """Yield a line a quantity: its key, its unit, a value a trial."""
    yield ["quantity", "unit", *(trial.name for trial in made.comparison.trials)]
    for row in made.rows:
        values = ["" if value is None else repr(value) for value in row.values]
        yield [row.key, row.unit, *values]


def _content(made: Report, difference: Difference | None) -> dict[str, Any]:
    """Return everything: what was compared, every quantity of every trial, the verdict."""
    comparison, terrain = made.comparison, made.comparison.terrain
    ground = terrain.ground
    low, high = ground.height_range
    return {
        "ground": {
            "name": ground.name,
            "rows": ground.shape[0],
            "columns": ground.shape[1],
            "spacing": ground.spacing,
            "origin": ground.origin,
            "lowest": low,
            "highest": high,
            "nodata": 0 if ground.mask is None else int(ground.mask.sum()),
            "crs": ground.crs,
        },
        "camera": asdict(comparison.camera),
        "edge_rule": comparison.edge_rule,
        "partitioning": comparison.partitioning,
        "device": str(terrain.device.info),
        "trials": {
            trial.name: {
                "lod": type(unweighted(trial.lod)).__name__,
                "tile": trial.terrain.grid.tile,
                "parameters": trial.parameters,
                "worst_sample": trial.error.where,
                "worst_point": trial.error.point,
                "quantities": {row.key: row.values[index] for row in made.rows},
            }
            for index, trial in enumerate(comparison.trials)
        },
        "as_asked_for": [trial.name for trial in comparison.asked],
        "equal_triangles": [trial.name for trial in comparison.equal_triangles],
        "equal_error": [trial.name for trial in comparison.equal_error],
        "units": {row.key: row.unit for row in made.rows if row.unit},
        "difference": None if difference is None else asdict(difference),
        "verdict": made.verdict,
    }
