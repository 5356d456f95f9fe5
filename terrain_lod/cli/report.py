"""``terrain-lod report``: levels of detail at one camera, all of them, or the hard cases."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

from cyclopts import Parameter

from ..errors import InputError
from ..ground.heightmap import Heightmap
from .lod_options import LodOptions
from .options import (
    CameraOptions,
    GroundOptions,
    MeshingOptions,
    OutputFolder,
    Switch,
    TerrainOptions,
)
from .output import log, progress_bar, say, warn

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Ground = Annotated[str | None, Parameter(metavar="GROUND", show_default=False)]

_VIEWS: Final = 3


def report(
    ground: Ground = None,
    /,
    *,
    output: OutputFolder,
    compare: Switch = False,
    stability: Switch = False,
    views: int | None = None,
    reading: GroundOptions = GroundOptions(),  # noqa: B008
    view: CameraOptions = CameraOptions(),  # noqa: B008
    lod: LodOptions = LodOptions(),  # noqa: B008
    meshing: MeshingOptions = MeshingOptions(),  # noqa: B008
    terrain: TerrainOptions = TerrainOptions(),  # noqa: B008
) -> None:
    """Compare levels of detail at one camera: distance, another (coplanarity) and screen-error LOD.

    As asked for, with as many triangles, and with as large an error; times and pictures.

    Parameters
    ----------
    ground
        A raster file or the name of a bundled sample; --stability brings its own.
    output
        Folder to write, made if it is not there.
    compare
        Every level of detail and every installed peer instead, over a low flight: speed against
        error. A class of your own is among them if --lod names it.
    stability
        Every kernel against its reference in 64 bits instead, on ground that is hard on floats.
    views
        Cameras of the flight. Of --compare alone. Default: 3.
    """
    pair_alone = {**_given(view), **_given(meshing), **lod.given}
    # a class of the user's own is compared as well
    named = {} if lod.lod is None or ":" in lod.lod else {"lod": lod.lod}
    if compare and stability:
        raise InputError("expected --compare or --stability, got both")
    if stability:
        tiles = {name: value for name, value in _given(terrain).items() if name != "device"}
        _refuse(
            "--stability",
            {"views": views, "lod": lod.lod, **pair_alone, **_given(reading), **tiles},
        )
        if ground is not None:
            raise InputError(f"expected no GROUND with --stability, got {ground!r}: leave it out")
        _write_stability(output, terrain)
        return
    if ground is None:
        raise InputError("expected GROUND, a raster file or the name of a sample, got none")
    if compare:
        # what deviations are measured from, and sizes of patches, are the pair's alone
        given = _given(terrain)
        _refuse(
            "--compare",
            named | pair_alone | {name: given.get(name) for name in ("plane", "levels")},
        )
    elif views is not None:
        raise InputError(f"expected --compare with --views, got --views {views} alone")
    heights = reading.load(ground)
    log("%r", heights)
    if compare:
        _write_comparison(heights, output, terrain, _VIEWS if views is None else views)
    else:
        _write_pair(heights, output, view, lod, meshing, terrain)


def _given(options: DataclassInstance) -> dict[str, Any]:
    """Return those of the options that are not as they are without being asked for."""
    usual = {field.name: field.default for field in fields(options)}
    return {name: value for name, value in vars(options).items() if value != usual[name]}


def _refuse(switch: str, options: dict[str, Any]) -> None:
    """Say which of the options that are given means nothing beside `switch`."""
    for name, value in options.items():
        if value is not None:
            flag = "--" + name.replace("_", "-")
            raise InputError(f"expected no {flag} with {switch}, got {value}: leave it out")


def _write_pair(
    heights: Heightmap,
    output: Path,
    view: CameraOptions,
    lod: LodOptions,
    meshing: MeshingOptions,
    terrain: TerrainOptions,
) -> None:
    from ..reports.report import report as write

    chosen, distance = (
        lod.make(terrain.tile, "distance", default="coplanarity"),
        lod.distance(),
    )
    with progress_bar("comparing") as progress:
        made = write(
            heights,
            output,
            camera=view.over(heights),
            tile=terrain.tile,
            levels=terrain.levels,
            plane=terrain.plane,
            lod=chosen,
            distance=distance,
            **vars(meshing),
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
    from ..reports.compare.compare import compare
    from ..reports.compare.peers import PEERS

    with progress_bar("comparing") as progress:
        made = compare(
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
        commands = "; ".join(peer.command for peer in PEERS if peer.name in made.missing)
        warn(f"not installed and so not compared: {', '.join(made.missing)}: {commands}")


def _write_stability(output: Path, terrain: TerrainOptions) -> None:
    from ..reports.stability import write_stability

    with progress_bar("hard cases") as progress:
        made = write_stability(output, device=terrain.open(), progress=progress)
    say(made.verdict)
    say(str(made.files["html"]))
