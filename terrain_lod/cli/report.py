"""``terrain-lod report``: two levels of detail side by side, all of them, or the hard cases."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from ..errors import InputError
from ..ground.heightmap import Heightmap
from .options import (
    CameraOptions,
    DetailOptions,
    FormulaEdgeRule,
    GroundOptions,
    TerrainOptions,
)
from .output import (
    log,
    progress_bar,
    say,
    warn,
)

Ground = Annotated[str | None, Parameter(metavar="GROUND", show_default=False)]
OutputFolder = Annotated[Path, Parameter(alias="-o", metavar="DIR")]
Switch = Annotated[bool, Parameter(show_default=False)]


def report(
    ground: Ground = None,
    /,
    *,
    output: OutputFolder,
    compare: Switch = False,
    stability: Switch = False,
    views: int = 3,
    edges: FormulaEdgeRule = "min",
    reading: GroundOptions = GroundOptions(),  # noqa: B008
    view: CameraOptions = CameraOptions(),  # noqa: B008
    detail: DetailOptions = DetailOptions(),  # noqa: B008
    terrain: TerrainOptions = TerrainOptions(),  # noqa: B008
) -> None:
    """Compare distance LOD with coplanarity LOD: triangles, error, time, pictures.

    Parameters
    ----------
    ground
        A raster file or the name of a bundled sample; --stability brings its own.
    output
        Folder to write, made if it is not there.
    compare
        Every level of detail and every installed peer instead, over a low flight: speed against
        error.
    stability
        Every kernel against its reference in 64 bits instead, on ground that is hard on floats.
    views
        Cameras of the flight. Of --compare alone.
    edges
        Factor of an edge between two tiles: the lower of what they want, or the higher.
    """
    if compare and stability:
        raise InputError("expected --compare or --stability, got both")
    if stability:
        _write_stability(output, terrain)
        return
    if ground is None:
        raise InputError("expected GROUND, a raster file or the name of a sample, got none")
    heights = reading.load(ground)
    log("%r", heights)
    if compare:
        _write_comparison(heights, output, terrain, views)
        return
    _write_pair(heights, output, edges, view, detail, terrain)


def _write_pair(
    heights: Heightmap,
    output: Path,
    edges: FormulaEdgeRule,
    view: CameraOptions,
    detail: DetailOptions,
    terrain: TerrainOptions,
) -> None:
    from ..reports.report import report as write

    distance, coplanarity = detail.both()
    with progress_bar("comparing") as progress:
        made = write(
            heights,
            output,
            camera=view.over(heights),
            tile=terrain.tile,
            plane=terrain.plane,
            edges=edges,
            distance=distance,
            coplanarity=coplanarity,
            device=terrain.open(),
            progress=progress,
        )
    for sentence in made.verdict:
        say(sentence)
    say(str(made.files["html"]))
    if made.no_pictures is not None:
        warn(made.no_pictures)


def _write_comparison(
    heights: Heightmap, output: Path, terrain: TerrainOptions, views: int
) -> None:
    from ..reports.compare.compare import compare_all

    with progress_bar("comparing") as progress:
        made = compare_all(
            heights,
            output,
            tile=terrain.tile,
            views=views,
            device=terrain.open(),
            progress=progress,
        )
    for sentence in (*made.findings, *made.speeds):
        say(sentence)
    say(str(made.files["html"]))
    if made.missing:
        warn(
            f"not installed and so not compared: {', '.join(made.missing)}; "
            "pip install 'terrain_lod[compare]' brings them"
        )


def _write_stability(output: Path, terrain: TerrainOptions) -> None:
    from ..reports.stability import write_stability

    with progress_bar("hard cases") as progress:
        made = write_stability(output, device=terrain.open(), progress=progress)
    say(made.verdict)
    say(str(made.files["html"]))
