"""Ground written as a folder of tiles for the web."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, ClassVar, Final

import numpy as np

from ..arguments import file_path, one_of, text
from ..errors import FileError
from ..ground.heightmap import Heightmap
from ..sources.opening import source_of
from ..tasks import Progress, Workers, require_workers, run_tasks
from .geoid import ELLIPSOID, Geoid, above_ellipsoid
from .globe import write_globe_tile, write_layer
from .job import Job
from .journal import Journal, Record
from .mapped import MappedGround
from .mapping import mapped_ground
from .plan import planned, require_options
from .schemes import Tile
from .terrain_rgb import write_picture, write_tilejson
from .tileset import write_tileset, write_tileset_tile


@dataclass(frozen=True)
class Format:
    """A kind of tiles.

    Attributes
    ----------
    title : str
    write_tile : callable
        Writes one and says what it came to; what it needs can be sent to another process.
    finish : callable
        Writes what stands beside the tiles.
    """

    title: str
    write_tile: Callable[[Job, Tile], Record]
    finish: Callable[[Job, Collection[Record]], None]


FORMATS: Final = {
    "quantized-mesh": Format("quantized-mesh 1.0", write_globe_tile, write_layer),
    "3dtiles": Format("3D Tiles 1.1", write_tileset_tile, write_tileset),
    "terrarium": Format("terrain-RGB, Terrarium", write_picture, write_tilejson),
    "mapbox": Format("terrain-RGB, Mapbox", write_picture, write_tilejson),
}


@dataclass(frozen=True)
class TilesReport:
    """What was written.

    Attributes
    ----------
    folder : Path
    format : str
    records : tuple of Record
        All tiles, level by level.
    asked : tuple of float
        Error asked for at each level, metres; of pictures none is.
    made : int
        Tiles made now; the others were there.
    """

    folder: Path
    format: str
    records: tuple[Record, ...]
    asked: tuple[float, ...]
    made: int

    @property
    def bytes(self) -> int:
        return sum(record.bytes for record in self.records)

    @property
    def error(self) -> float:
        """The largest error of the deepest level, metres."""
        deepest = self.records[-1].z
        return max(record.error for record in self.records if record.z == deepest)

    columns: ClassVar = ("level", "tiles", "triangles", "bytes", "asked", "measured")

    def rows(self) -> list[tuple[str, ...]]:
        """Return what became of each level, as text, in the order of ``columns``."""
        table: list[tuple[str, ...]] = []
        for z in sorted({record.z for record in self.records}):
            level = [record for record in self.records if record.z == z]
            table.append(
                (
                    str(z),
                    f"{len(level):,}",
                    f"{sum(record.triangles for record in level):,}",
                    f"{sum(record.bytes for record in level):,}",
                    f"{self.asked[z]:.4g} m" if self.asked else "",
                    f"{max(record.error for record in level):.4g} m",
                )
            )
        return table

    def __str__(self) -> str:
        return (
            f"{self.folder}: {len(self.records):,} tiles of {FORMATS[self.format].title}, "
            f"{self.bytes:,} bytes, at the deepest level within {self.error:.4g} m of every sample"
        )


def write_tiles(
    ground: Any,
    folder: str | Path,
    *,
    format: str = "quantized-mesh",
    error: float | None = None,
    zoom: int | None = None,
    scheme: str | None = None,
    tiling: str | None = None,
    borders: str | None = None,
    geoid: str = ELLIPSOID,
    gzip: bool = False,
    crs: str | None = None,
    workers: Workers = None,
    progress: Progress | None = None,
) -> TilesReport:
    """Write ground as a pyramid of tiles for the web, each with its measured error.

    The error of a tile is the largest distance, along the ellipsoid's normal, of its finished
    triangles from the samples of the ground within it: all of them at every level, with the
    Earth's curvature in the vertices, and after every rounding that the format makes. It is counted
    twice, to the flat triangle and to the height that is linear between the corners, and the larger
    counts. The deepest level is asked for `error`, each level above for twice as much as the one
    below it. What a tile's error came to stands in the tile, in ``tiles.jsonl`` and, for 3D Tiles,
    as its ``geometricError``.

    Tiles of one level meet without gaps: what stands on a border is chosen by the heights along it
    alone. Work that was cut off goes on where it ended when it is asked for again.

    Parameters
    ----------
    ground : Heightmap, path or array
        With a CRS. Without data at all at a pole, or across the 180th meridian. What is no
        heightmap is read as :func:`terrain_lod.build` does, window by window, into a file beside
        `folder`, of 4 bytes a sample, which is removed at the end: it may be larger than memory.
        Such ground can have no holes.
    folder : str or Path
        Made if it is not there; empty, or with the same work begun.
    format : {"quantized-mesh", "3dtiles", "terrarium", "mapbox"}, optional
        ``z/x/y.terrain`` for Cesium's globe, which is the ellipsoid where there is no ground;
        ``z/x/y.glb`` of 3D Tiles 1.1, with holes there; terrain-RGB of 256 x 256 pixels.
    error : float, optional
        Metres, of the deepest level. A quarter of the step between samples if not given. Pictures
        take none: theirs is what their pixels come to, and measured as well.
    zoom : int, optional
        The deepest level; where not given, the first whose lattice of 256 x 256 cells a tile is as
        fine as the samples.
    scheme : {"geographic", "mercator"}, optional
        Of quantized-mesh: tiles in degrees, the default, or of the square map of the web.
    tiling : {"implicit", "explicit"}, optional
        Of 3D Tiles: subtrees, the default, or every tile named in ``tileset.json``.
    borders : {"none", "skirts", "frozen"}, optional
        What is done about gaps between tiles of different levels. ``"skirts"``, the default for
        3D Tiles: walls as high as the errors asked of a level and of the coarser one beside it,
        together. ``"frozen"``: the deepest level's borders at all levels, for 3D Tiles alone.
        ``"none"``, the default for quantized-mesh, whose clients make skirts themselves.
    geoid : str, optional
        What heights of the ground are above: ``"ellipsoid"``, so that they stay as they are;
        ``"egm96"`` or ``"egm2008"``, whose grids PROJ must have; or the file of a grid.
    gzip : bool, optional
        Pack the files; a server has to say so, as ``terrain-lod serve`` does.
    crs : str, optional
        Of the ground, instead of what it says.
    workers : int, executor or None, optional
        See ``terrain_lod/tasks.py``.
    progress : callable, optional
        Called with the number of finished tiles and that of all.

    Returns
    -------
    TilesReport

    Raises
    ------
    InputError
        If an argument is none of these, the ground has no CRS or lies where tiles cannot, or the
        folder holds something else.
    FileError
        If a file cannot be written: what is finished stays, and the same call goes on from there.
    MissingExtraError
        If the CRS or the geoid needs pyproj.
    """
    one_of("format", format, FORMATS)
    require_options(format, error, zoom, scheme, tiling, borders)
    require_workers(workers)
    folder = file_path("folder", folder)
    above = None if text("geoid", geoid) == ELLIPSOID else Geoid.called(geoid)
    with _prepared(ground, folder, crs, above) as prepared:
        job = planned(
            prepared,
            folder,
            format=format,
            error=error,
            zoom=zoom,
            scheme=scheme,
            tiling=tiling,
            borders=borders,
            geoid=geoid,
            gzip=gzip,
        )
        return _written(job, format, workers, progress)


@contextmanager
def _prepared(
    ground: Any, folder: Path, crs: str | None, geoid: Geoid | None
) -> Iterator[Heightmap | MappedGround]:
    """Yield ground with heights above the ellipsoid, in memory or in a file of its own."""
    if isinstance(ground, Heightmap):
        ground = ground if crs is None else ground.with_crs(crs)
        yield ground if geoid is None else above_ellipsoid(ground, geoid)
        return
    source = source_of(ground)
    beside = next(parent for parent in folder.absolute().parents if parent.is_dir())
    try:
        with TemporaryDirectory(prefix=".terrain_lod-", dir=beside) as temporary:
            yield mapped_ground(source, Path(temporary) / "heights", crs, geoid)
    except PermissionError as error:
        raise FileError(f"cannot write to {beside}: {error.strerror}") from None


def _written(job: Job, format: str, workers: Workers, progress: Progress | None) -> TilesReport:
    tiles = [
        (z, x, y)
        for z in sorted(job.levels)
        for columns, rows in [job.tiles(z)]
        for y in rows
        for x in columns
    ]
    work = {
        "format": format,
        "scheme": repr(job.scheme),
        "levels": {str(z): vars(level) for z, level in job.levels.items()},
        "gzip": job.gzipped,
        "skirts": job.skirts,
        "frozen": job.frozen,
        "implicit": job.implicit,
        "about": job.about,
        "ground": _fingerprint(job.source.ground),
    }
    journal = Journal(job.folder, work)
    left = [tile for tile in tiles if tile not in journal.done]
    kind = FORMATS[format]
    with journal.writing():
        for _, record in run_tasks(
            partial(kind.write_tile, job), left, workers=workers, progress=progress
        ):
            journal.add(record)
    records = tuple(journal.done[tile] for tile in tiles)
    kind.finish(job, records)
    asked = () if job.picture else tuple(job.levels[z].asked for z in sorted(job.levels))
    return TilesReport(job.folder, format, records, asked, len(left))


def _fingerprint(ground: Heightmap | MappedGround) -> str:
    """Return what tells a ground from others."""
    digest = hashlib.sha256(repr((ground.spacing, ground.origin, ground.base, ground.crs,
                                  ground.units)).encode())  # fmt: skip
    if isinstance(ground, MappedGround):
        digest.update(ground.fingerprint.encode())
        return digest.hexdigest()
    digest.update(np.ascontiguousarray(ground.heights).data)
    if ground.mask is not None:
        digest.update(np.packbits(ground.mask).data)
    return digest.hexdigest()
