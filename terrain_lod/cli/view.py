"""``terrain-lod view``: the window, the page, and both without a display."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from cyclopts import Parameter

from ..arguments import whole
from ..errors import InputError
from .lod_options import ViewedOptions
from .options import AnyPartitioning, CameraOptions, GroundOptions, Sun
from .output import log, say
from .pyramid import is_store, open_store

if TYPE_CHECKING:
    from ..viewer.scene import Scene
    from ..viewer.settings import Settings

Mode = Literal["shaded", "wireframe", "lod", "deviation", "error", "normals"]


def view(
    subject: Annotated[str, Parameter(metavar="GROUND|MESH")] = "ridge",
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
    mode: Mode | None = None,
    partitioning: AnyPartitioning | None = None,
    y_up: bool = False,
    sun: Sun = None,
    tile: int | None = None,
    levels: int | None = None,
    device: str | None = None,
    memory: Annotated[str | None, Parameter(metavar="SIZE")] = None,
    reading: GroundOptions = GroundOptions(),  # noqa: B008
    camera: CameraOptions = CameraOptions(),  # noqa: B008
    lod: ViewedOptions = ViewedOptions(),  # noqa: B008
) -> None:
    """Look at ground or a curved mesh: fly over it, and see what its level of detail does.

    Drag turns, the wheel goes nearer, w a s d fly, a click tells what is known of a place. Keys:
    1-6 what is shown; m l p e t f the next mode, LOD, partitioning, edge rule, tessellation,
    freeze; of meshes x n b sharp edges, normals, back faces; g fly or orbit, r reset, u reload,
    c picture, v record, h hide, q quit.

    Parameters
    ----------
    subject
        A raster file, the name of a bundled sample, a pyramid that build wrote, a mesh file, or
        Bézier patches in a .bpt file.
    web
        Serve a page instead of opening a window. The printed address has a token, without which
        nobody gets in.
    port
        Of the page; 0 takes any that is free.
    host
        Address that the page is served on. With another than the default, such as 0.0.0.0, other
        machines reach it: whoever has the printed address can use the viewer, unencrypted.
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
        What is shown: light, triangles, factors or normals; of ground also its deviation from the
        tiles' planes and the vertical error. Default: shaded.
    partitioning
        How the tessellator divides an edge; semi_uniform of meshes alone.
    y_up
        The mesh's own y axis points up. glTF files say so themselves.
    sun
        Where the light comes from: degrees clockwise from north, degrees above the horizon.
    tile
        Cells along a tile, 1 to 63. Of ground alone. Default: 4, or 8 on large ground.
    levels
        Sizes of patches that errors are kept with, each twice the last; 1 is a flat grid of tiles.
        Of ground alone. Default: up to the whole raster.
    device
        cpu, gpu, a number or part of a name, see doctor. Default: a GPU if there is one.
    memory
        Of a pyramid: how much of it to hold, such as 512MB. Default: a quarter of what is free.
    """
    from ..viewer.memory import keep_large_blocks_apart
    from ..viewer.model import Model

    if output is not None and not off_screen:
        raise InputError("expected --off-screen with --output: in a window, c takes a picture")
    whole("frames", frames, 1, 100_000)
    keep_large_blocks_apart()
    chosen: dict[str, Any] = {"mode": mode, "partitioning": partitioning, "lod": lod.lod}
    chosen |= lod.given
    if sun is not None:
        chosen |= {"azimuth": sun[0] % 360, "elevation": sun[1]}
    path = Path(subject) if Path(subject).exists() else None
    model = Model(lambda: _scene(subject, reading, tile, levels, device, y_up, memory), path=path)
    settings = model.scene.settings
    for name, value in chosen.items():
        if value is not None:
            settings = _changed(settings, name, value)
            if (held := settings.value(name)) != value:
                raise InputError(
                    f"expected {name} in its range, got {value:g}: nearest is {held:g}"
                )
    model.scene.settings = settings
    eye = camera.instead_of(model.scene.camera())
    if web:
        from ..viewer.web import require_page, serve

        require_page(host, port)
        serve(model, eye, host=host, port=port, open_browser=browser)
    elif off_screen:
        from ..viewer.view import look

        for line in look(model, eye, picture=output, record=record, frames=frames):
            say(line)
    else:
        from ..viewer.view import view as show

        show(model, eye, record=record)


def _changed(settings: Settings, name: str, value: Any) -> Settings:
    """Return settings with one changed that they show."""
    shown = {slider.name for slider in settings.sliders}
    if settings.lod in settings.formulas:
        shown |= settings.formulas[settings.lod].numbers().keys()
    if isinstance(value, float | int) and name not in shown:
        raise InputError(
            f"expected a number of {settings.lod} ({', '.join(sorted(shown))}), "
            f"got --{name.replace('_', '-')}"
        )
    return settings.changed(name, value)


def _scene(
    name: str,
    reading: GroundOptions,
    tile: int | None,
    levels: int | None,
    device: str | None,
    y_up: bool,
    memory: str | None,
) -> Scene:
    """Return what is to be looked at, by the ending of its name."""
    from ..device.device import Device
    from ..files.meshes.bpt import load_bpt
    from ..files.meshes.loading import load_mesh
    from ..files.rasters.formats import FORMATS
    from ..viewer.mesh_scene import BezierScene, CurvedScene
    from ..viewer.streaming_scene import StreamingScene
    from ..viewer.terrain_scene import TerrainScene

    endings = tuple(ending for form in FORMATS for ending in form.endings)
    held = is_store(name)
    raster = not held and (not Path(name).suffix or name.lower().endswith(endings))
    if y_up and (raster or held):
        raise InputError(f"expected a mesh with --y-up, got the ground {name}")
    if memory is not None and not held:
        raise InputError(f"expected a pyramid with --memory, got {name}")
    if raster:
        scene = TerrainScene(reading.load(name), levels=levels, device=Device.open(device))
        if tile is not None:
            scene.settings = scene.settings.with_tile(tile)
        log("%r", scene.ground)
        return scene
    for option, value in {**vars(reading), "tile": tile, "levels": levels}.items():
        if value is not None:
            raise InputError(f"expected a raster with --{option.replace('_', '-')}, got {name}")
    if held:
        return StreamingScene(open_store(name, memory, Device.open(device)))
    if name.lower().endswith(".bpt"):
        return BezierScene(load_bpt(name), y_up=y_up, device=Device.open(device))
    return CurvedScene(load_mesh(name), y_up=y_up, device=Device.open(device))
