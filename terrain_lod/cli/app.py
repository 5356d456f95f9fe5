"""The command line: demo, render, mesh, report, view, build, info, tiles, serve, smooth, surface,
pattern, samples, doctor.

Exit codes: 0 done, 2 refused with one line on stderr, 130 interrupted.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from importlib.metadata import version
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal

from cyclopts import App, CycloptsError, Parameter
from cyclopts.config import Env

from ..arguments import one_of, positive
from ..camera.viewpoint import default_camera, orbit_camera
from ..errors import InputError, TerrainError
from ..ground.heightmap import Heightmap
from ..interrupts import INTERRUPTED, end, raise_interrupts
from ..paths import require_folder
from .export import ExportOptions
from .flyover import PathOptions
from .lod_options import LodOptions, own_formulas
from .options import (
    CameraOptions,
    Ground,
    GroundOptions,
    Output,
    OutputFolder,
    OverlayOptions,
    Sun,
    Switch,
    TerrainOptions,
    VertexOptions,
)
from .output import PROGRAM, complain, log, progress_bar, say, say_table, set_verbosity, warn
from .pattern import pattern
from .pyramid import build, info, is_store, open_store
from .report import report
from .smooth import smooth
from .surface import surface
from .tiles import serve, tiles
from .view import view

if TYPE_CHECKING:
    from ..device.device import Device
    from ..mesh.mesh import Mesh

REFUSED: Final = 2

app = App(
    name=PROGRAM,
    help="Terrain level of detail with a known error, from the command line.",
    help_epilogue=(
        "Options may also come from the environment: TERRAIN_LOD_RENDER_STYLE=lod. "
        "TERRAIN_LOD_DEVICE chooses the device for every command."
    ),
    version=lambda: version("terrain_lod"),
    config=Env("TERRAIN_LOD_", show=False),
    default_parameter=Parameter(negative=""),
    suppress_keyboard_interrupt=False,
)
app.meta.suppress_keyboard_interrupt = False

Crs = Annotated[str | None, Parameter(metavar="EPSG:CODE|utm")]
Memory = Annotated[str | None, Parameter(metavar="SIZE")]


@app.command(sort_key=1)
def demo(
    ground: Ground = "ridge",
    /,
    *,
    output: OutputFolder = Path("terrain_lod_demo"),
    terrain: TerrainOptions = TerrainOptions(),  # noqa: B008
) -> None:
    """Do the main job on bundled ground: a mesh, pictures and a report.

    Parameters
    ----------
    output
        Folder to write, made if it is not there.
    """
    from .demonstration import make_demo

    heights = GroundOptions().load(ground)
    with progress_bar("making the demo") as progress:
        made = make_demo(
            heights,
            output,
            tile=terrain.tile,
            levels=terrain.levels,
            plane=terrain.plane,
            device=terrain.open(),
            progress=progress,
        )
    say_table(("file", "what", "size"), made.rows)
    for sentence in made.verdict:
        say(sentence)
    if made.no_pictures is not None:
        warn(made.no_pictures)


@app.command(sort_key=2)
def render(
    ground: Ground,
    /,
    *,
    output: Output,
    style: Literal["shaded", "wireframe", "lod", "size", "factor"] = "shaded",
    sun: Sun = None,
    exaggeration: float = 1.0,
    sky_light: Annotated[bool, Parameter(negative="--no-sky-light", show_default=False)] = True,
    notes: Annotated[bool, Parameter(negative="--no-notes", show_default=False)] = True,
    memory: Memory = None,
    reading: GroundOptions = GroundOptions(),  # noqa: B008
    overlay: OverlayOptions = OverlayOptions(),  # noqa: B008
    view: CameraOptions = CameraOptions(),  # noqa: B008
    lod: LodOptions = LodOptions(),  # noqa: B008
    meshing: VertexOptions = VertexOptions(),  # noqa: B008
    terrain: TerrainOptions = TerrainOptions(),  # noqa: B008
    many: PathOptions = PathOptions(),  # noqa: B008
) -> None:
    """Draw a picture of ground, or many along a path. Needs no display.

    Parameters
    ----------
    output
        PNG to write; a folder with --path, --orbit or --flyover.
    style
        shaded: sunlit and tinted by height. wireframe: the triangles. lod: how many cells of the
        raster a triangle's side spans, and the outlines of patches. size: how many cells a patch
        is wide. factor: into how many parts it is cut.
    sun
        Where the light comes from: degrees clockwise from north, degrees above the horizon.
    exaggeration
        How many times as high heights are drawn; errors in metres are true ones.
    sky_light
        Let ground that sees less of the sky have less of its light, or do not.
    notes
        Say along the foot of the picture what it shows, or do not: colours, scale, north, camera,
        triangles and error.
    memory
        Of a pyramid that build wrote: how much of it to hold, such as 512MB.
    """
    from ..drawing.exaggeration import ExaggeratedTerrain
    from ..drawing.graphics import require_graphics
    from ..drawing.picture import SUN, require_png, save_png
    from ..drawing.portrait import Portrait

    if not many.many:
        require_png(output)
    tall = positive("exaggeration", exaggeration)
    chosen = lod.make(terrain.tile, *filter(None, [many.beside]))
    beside = many.second(lod, terrain.tile)
    require_graphics()
    if is_store(ground):
        if tall != 1:
            raise InputError(f"expected a raster with --exaggeration, got the pyramid {ground}")
        opened = open_store(ground, memory, terrain.open())
        camera = view.over(opened.overview)
        made = opened.mesh(camera, lod=chosen)
        look = Portrait(opened.overview, style, sun or SUN, height_range=opened.height_range)
        save_png(look.of(made, camera, notes=notes), output)
        say(f"{output}: {_counts(made, opened.overview)}")
        return None
    heights, added = reading.load(ground), overlay.load()
    first = orbit_camera if many.orbit else default_camera
    camera = view.over(heights, exaggeration=tall, view=first)
    log("%r", heights)
    made = terrain.make(heights, chosen, added)
    if many.many:
        shown: dict[str, Any] = {"style": style, "sun": sun or SUN}
        shown |= {"exaggeration": tall, "sky_light": sky_light}
        return many.render(made, camera, output, [chosen, *beside], meshing, **shown)
    drawn = ExaggeratedTerrain(made, tall)
    mesh = drawn.mesh(camera, lod=chosen, **vars(meshing))
    log("%r from %r", mesh, chosen)
    look = Portrait(
        heights,
        style,
        sun or SUN,
        exaggeration=tall,
        drape=many.drape(heights),
        wireframe=many.wireframe,
        sky_light=drawn.sky_light() if sky_light else None,
    )
    save_png(look.of(mesh, camera, notes=notes), output)
    say(f"{output}: {_counts(mesh, heights)}")
    return None


@app.command(sort_key=3)
def mesh(
    ground: Ground,
    /,
    *,
    output: Output,
    cull: Switch = False,
    normal_map: Switch = False,
    crs: Crs = None,
    memory: Memory = None,
    reading: GroundOptions = GroundOptions(),  # noqa: B008
    overlay: OverlayOptions = OverlayOptions(),  # noqa: B008
    view: CameraOptions = CameraOptions(),  # noqa: B008
    lod: LodOptions = LodOptions(),  # noqa: B008
    meshing: VertexOptions = VertexOptions(),  # noqa: B008
    terrain: TerrainOptions = TerrainOptions(),  # noqa: B008
    export: ExportOptions = ExportOptions(),  # noqa: B008
) -> None:
    """Write the mesh that a camera deserves, and say how far it is from the ground.

    Parameters
    ----------
    output
        File to write: .glb, .obj, .ply, .stl or .vtp.
    cull
        Leave out patches that the camera does not see. Files are looked at from anywhere, so that
        they are whole by default.
    normal_map
        Bake the normals of the whole ground into a normal map, which a .glb holds.
    crs
        Bring the ground to this projection first, and say how far that is from its own samples;
        utm is the zone of UTM that it lies in.
    memory
        Of a pyramid that build wrote: how much of it to hold, such as 512MB.
    """
    from ..files.meshes.export import FORMATS
    from ..measure.cracks import crack_report
    from ..measure.error import vertical_error
    from ..mesh.bake import bake_normals

    require_folder(output)
    one_of("mesh format", output.suffix.lower(), FORMATS)
    export.require(output)
    if normal_map and (
        output.suffix.lower() != ".glb" or is_store(ground) or not export.is_plain()
    ):
        raise InputError(
            f"expected a raster and a name that ends in .glb with --normal-map, without "
            f"--exaggeration, --drape and --solid, got {ground} and {output.name}"
        )
    chosen = lod.make(terrain.tile)
    if is_store(ground):
        if crs is not None or not export.is_plain():
            raise InputError(
                f"expected a raster with --crs, --exaggeration, --drape and --solid, got the "
                f"pyramid {ground}"
            )
        opened = open_store(ground, memory, terrain.open())
        made = opened.mesh(view.over(opened.overview), lod=chosen, cull=cull)
        made.save(output)
        say(f"{output}: {_counts(made, opened.overview)}")
        say(str(crack_report(made)))
        return
    heights, added = reading.load(ground, crs), overlay.load()
    camera = view.over(heights)
    log("%r", heights)
    made = terrain.make(heights, chosen, added).mesh(camera, lod=chosen, cull=cull, **vars(meshing))
    log("%r from %r", made, chosen)
    if normal_map:
        made = bake_normals(made, _whole(heights, added, terrain.open()), device=terrain.open())
    shown = heights if added is None else heights.with_detail(added)
    export.save(made, shown, output)
    say(f"{output}: {_counts(made, heights)}")
    say(f"vertical error: {vertical_error(made, shown, device=terrain.open())}")
    say(str(crack_report(made)))


@app.command(sort_key=5)
def samples() -> None:
    """List the bundled grounds."""
    from ..files.rasters.samples import sample, sample_names

    rows = []
    for name in sample_names():
        ground = sample(name)
        low, high = ground.height_range
        size = " × ".join(f"{extent:,}" for extent in ground.shape)
        spacing = " × ".join(f"{step:.4g}" for step in dict.fromkeys(ground.spacing))
        across, up = ground.unit_symbols
        rows.append((name, size, f"{spacing} {across}", f"{low:,.0f} to {high:,.0f} {up}"))
    say_table(("name", "samples", "spacing", "heights"), rows)


@app.command(sort_key=6)
def doctor() -> int:
    """Compare every kernel with its reference on every device, and say which device to use."""
    from .doctor import run_doctor

    return run_doctor()


app.command(report, sort_key=4)
app.command(view, sort_key=7)
app.command(smooth, sort_key=8)
app.command(pattern, sort_key=9)
app.command(build, sort_key=10)
app.command(info, sort_key=11)
app.command(tiles, sort_key=12)
app.command(serve, sort_key=13)
app.command(surface, sort_key=14)


def _whole(ground: Heightmap, detail: Heightmap | None, device: Device) -> Mesh:
    """Return the mesh of every sample."""
    from ..terrain.lod_formulas import UniformLod
    from ..terrain.terrain import Terrain

    terrain = Terrain(ground, detail=detail, tile=16, levels=1, device=device)
    return terrain.mesh(lod=UniformLod(16), partitioning="integer", cull=False)


def _counts(mesh: Any, ground: Heightmap) -> str:
    patches = mesh.patches
    kept = f", {_achieved(mesh.achieved, ground.unit_symbols[1])}" if mesh.achieved else ""
    return (
        f"{len(mesh.triangles):,} triangles, {len(mesh.vertices):,} vertices, "
        f"{patches.culled_count:,} of {patches.count:,} patches left out{kept}"
    )


def _achieved(achieved: Any, unit: str) -> str:
    """Say what a promise came to, and whether that is what was asked for."""
    seen = achieved.pixels is not None and isfinite(achieved.pixels)
    pixels = f"{achieved.pixels:.3g} pixels, " if seen else ""
    missed = "" if achieved.kept else ": the best that this raster and tile can show"
    return f"within {pixels}{achieved.metres:.3g} {unit}{missed}"


@app.meta.default
def _launch(
    *tokens: Annotated[str, Parameter(show=False, allow_leading_hyphen=True)],
    verbose: Annotated[int, Parameter(alias="-v", count=True, show_default=False)] = 0,
    quiet: Annotated[bool, Parameter(alias="-q", show_default=False)] = False,
) -> Any:
    """Run a command.

    Parameters
    ----------
    verbose
        Say what is being done; twice for more.
    quiet
        Say nothing but errors.
    """
    set_verbosity(verbose, quiet)
    return app(tokens, exit_on_error=False, print_error=False, result_action="return_value")


def run(tokens: Sequence[str]) -> int:
    """Run the command line `tokens` and return the exit code."""
    try:
        with own_formulas(tokens):
            result = app.meta(
                tokens, exit_on_error=False, print_error=False, result_action="return_value"
            )
        sys.stdout.flush()
    except (TerrainError, CycloptsError) as error:
        complain(" ".join(str(error).split()))
        return REFUSED
    except MemoryError:
        complain("expected a raster that fits into memory, got one that does not")
        return REFUSED
    except KeyboardInterrupt:
        complain("interrupted")
        return INTERRUPTED
    except BrokenPipeError:
        # whoever read our output has left: nothing more is written, not even at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return REFUSED
    return result if isinstance(result, int) else 0


def main() -> None:
    """Run the command line and leave."""
    raise_interrupts()
    code = run(sys.argv[1:])
    if code == INTERRUPTED:
        end()
    sys.exit(code)
