"""``terrain-lod tiles`` and ``serve``: ground as tiles for the web, and a look at them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Final, Literal

from cyclopts import Parameter

from .options import Ground, GroundOptions
from .output import log, progress_bar, say, say_table

OutputFolder = Annotated[Path, Parameter(alias="-o", metavar="DIR")]
Switch = Annotated[bool, Parameter(show_default=False)]
# samples of a ground that is not loaded: some 2 GB while it is
_LARGE: Final = 1 << 27


def tiles(
    ground: Ground,
    /,
    *,
    output: OutputFolder,
    format: Literal["quantized-mesh", "3dtiles", "terrarium", "mapbox"] = "quantized-mesh",
    error: float | None = None,
    zoom: int | None = None,
    scheme: Literal["geographic", "mercator"] | None = None,
    tiling: Literal["implicit", "explicit"] | None = None,
    borders: Literal["none", "skirts", "frozen"] | None = None,
    geoid: str = "ellipsoid",
    gzip: Switch = False,
    crs: str | None = None,
    workers: int | None = None,
    reading: GroundOptions = GroundOptions(),  # noqa: B008
) -> None:
    """Write ground as tiles for the web, each with its measured error; go on where it was cut off.

    Parameters
    ----------
    output
        Folder to write, made if it is not there.
    format
        quantized-mesh: Cesium's globe. 3dtiles: 3D Tiles 1.1. terrarium, mapbox: terrain-RGB.
    error
        Metres that the deepest level may be off at any sample, each level above twice as much. A
        quarter of the distance between samples if not given.
    zoom
        The deepest level; as fine as the samples if not given.
    scheme
        Of quantized-mesh: degrees, the default, or the square map of the web.
    tiling
        Of 3dtiles: by subtrees, the default, or every tile by name.
    borders
        Between levels: walls as high as both errors together, the default of 3dtiles; the same
        border lines at all levels, of 3dtiles alone; or nothing, as Cesium's globe makes skirts.
    geoid
        What heights are above: ellipsoid, and so they stay; egm96, egm2008 or a grid's file.
    gzip
        Pack the files.
    crs
        Of the ground, such as EPSG:32632, instead of what it says.
    workers
        Processes that share the work; this one alone if not given.
    """
    from ..tilesets.write import write_tiles

    heights = Path(ground) if _is_large(ground, reading) else reading.load(ground)
    log("%r", heights)
    with progress_bar("writing tiles") as progress:
        report = write_tiles(
            heights,
            output,
            format=format,
            error=error,
            zoom=zoom,
            scheme=scheme,
            tiling=tiling,
            borders=borders,
            geoid=geoid,
            gzip=gzip,
            crs=crs,
            workers=workers,
            progress=progress,
        )
    say_table(report.columns, report.rows())
    say(str(report))


def _is_large(ground: str, reading: GroundOptions) -> bool:
    """Return whether a file, or a folder of them, is to be read window by window."""
    from ..sources.opening import source_of

    path = Path(ground)
    if reading != GroundOptions() or not path.exists() or (path / "zarr.json").is_file():
        return False
    rows, columns = source_of(path).shape
    return path.is_dir() or rows * columns > _LARGE


def serve(
    folder: Annotated[Path, Parameter(metavar="DIR")],
    /,
    *,
    port: int = 8080,
    library: Annotated[Path | None, Parameter(metavar="DIR")] = None,
) -> None:
    """Serve a folder of tiles to this machine's browsers until interrupted.

    Parameters
    ----------
    folder
        As written by tiles.
    port
        0 takes any that is free.
    library
        npm's copy of what draws them: node_modules/cesium, or node_modules/maplibre-gl for
        terrain-RGB. Without it the tiles are there for other programs, and no page is.
    """
    from ..tilesets.serve import HOST, TILES, Site, server_of

    server = server_of(Site.of(folder, library), port)
    address = f"http://{HOST}:{server.server_address[1]}"
    say(f"{address}/ shows {folder}; other programs take {address}{TILES}")
    with server:
        server.serve_forever()
