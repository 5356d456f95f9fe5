"""``terrain-lod view``: the window, the page, and both without a display."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from ..arguments import whole
from ..errors import InputError
from .options import CameraOptions, Ground, GroundOptions, Sun, TerrainOptions
from .output import log, say


def view(
    ground: Ground = "ridge",
    /,
    *,
    web: bool = False,
    port: int = 8080,
    host: str = "127.0.0.1",
    browser: bool = False,
    off_screen: bool = False,
    output: Annotated[Path | None, Parameter(alias="-o", metavar="FILE")] = None,
    record: Annotated[Path | None, Parameter(metavar="FILE")] = None,
    frames: int = 60,
    mode: Literal["shaded", "wireframe", "lod", "deviation", "error", "normals"] = "shaded",
    lod: Literal[
        "screen-error", "max-error", "budget", "coplanarity", "distance", "uniform"
    ] = "screen-error",
    sun: Sun = None,
    reading: GroundOptions = GroundOptions(),  # noqa: B008
    camera: CameraOptions = CameraOptions(),  # noqa: B008
    terrain: TerrainOptions = TerrainOptions(),  # noqa: B008
) -> None:
    """Look at ground: fly over it, and see what its level of detail does.

    Drag turns, the wheel goes nearer, w a s d fly, a click tells what is known of a place. Keys:
    1-6 what is shown, m l p e k t f the next mode, LOD, partitioning, edge rule, tile,
    tessellation, freeze; g fly or orbit, r reset, u reload, c picture, v record, h hide, q quit.

    Parameters
    ----------
    ground
        A raster file or the name of a bundled sample.
    web
        Serve a page instead of opening a window.
    port
        Of the page.
    host
        Address that the page is served on; others than this machine need another.
    browser
        Open the page in a browser.
    off_screen
        Open nothing: write --output and --record.
    output
        PNG of the first view. With --off-screen.
    record
        GIF, or MP4 with the extra [movie]: with --off-screen a flight around the target, in a
        window all that is shown.
    frames
        Pictures of that flight.
    mode
        What is shown: height, triangles, factors, deviation from the tiles' planes, vertical error
        or normals.
    lod
        How detail is chosen.
    sun
        Where the light comes from: degrees clockwise from north, degrees above the horizon.
    """
    from ..viewer.model import Model

    if output is not None and not off_screen:
        raise InputError("expected --off-screen with --output: in a window, c takes a picture")
    path = Path(ground) if Path(ground).exists() else None
    model = Model(lambda: reading.load(ground), path=path, device=terrain.open())
    log("%r", model.ground)
    settings = model.settings().changed("mode", mode).changed("lod", lod)
    settings = settings.changed("tile", terrain.tile)
    if sun is not None:
        settings = settings.changed("azimuth", sun[0] % 360).changed("elevation", sun[1])
    eye = camera.over(model.ground)
    if web:
        from ..viewer.web import serve

        print(f"http://{host}:{port}/  (Ctrl-C ends it)", file=sys.stderr)
        serve(model, eye, settings=settings, host=host, port=port, open_browser=browser)
    elif off_screen:
        from ..viewer import look

        whole("frames", frames, 1, 100_000)
        for line in look(
            model, eye, settings=settings, picture=output, record=record, frames=frames
        ):
            say(line)
    else:
        from ..viewer import view as show

        show(model, eye, settings=settings, record=record)
