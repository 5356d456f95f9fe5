"""Ground written as a folder of tiles for the web."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection
from copy import copy
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from ..arguments import one_of, positive, whole
from ..ground.heightmap import Heightmap
from ..tasks import Progress, Workers, run_tasks
from .globe import write_globe_tile, write_layer
from .job import Job
from .journal import Journal, Record
from .levels import Level, reach
from .quantized_mesh import MOST, smallest_quantum
from .schemes import Geographic, Mercator, Scheme, Tile, require_within
from .source import Source

_DEEPEST: Final = 22


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
}
SCHEMES: Final[dict[str, Scheme]] = {"geographic": Geographic(), "mercator": Mercator()}
BORDERS: Final = ("none", "skirts", "frozen")


@dataclass(frozen=True)
class TilesReport:
    """What was written.

    Attributes
    ----------
    folder : Path
    format : str
    records : tuple of Record
        All tiles, level by level.
    allowed : tuple of float
        Error asked for at each level, metres; the first is that of level 0.
    made : int
        Tiles made now; the others were there.
    """

    folder: Path
    format: str
    records: tuple[Record, ...]
    allowed: tuple[float, ...]
    made: int

    @property
    def bytes(self) -> int:
        return sum(record.bytes for record in self.records)

    @property
    def error(self) -> float:
        """The largest error of the deepest level, metres."""
        deepest = self.records[-1].z
        return max(record.error for record in self.records if record.z == deepest)

    def rows(self) -> list[tuple[str, ...]]:
        """Return level, tiles, triangles, bytes, error asked for and largest error, as text."""
        table = []
        for z in sorted({record.z for record in self.records}):
            level = [record for record in self.records if record.z == z]
            table.append(
                (
                    str(z),
                    f"{len(level):,}",
                    f"{sum(record.triangles for record in level):,}",
                    f"{sum(record.bytes for record in level):,}",
                    f"{self.allowed[z]:.4g} m",
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
    ground: Heightmap,
    folder: str | Path,
    *,
    format: str = "quantized-mesh",
    error: float | None = None,
    zoom: int | None = None,
    scheme: str = "geographic",
    borders: str | None = None,
    gzip: bool = False,
    crs: str | None = None,
    workers: Workers = None,
    progress: Progress | None = None,
) -> TilesReport:
    """Write ground as a pyramid of tiles, each with its measured error.
    """
    one_of("format", format, FORMATS)
    source = Source.of(_placed(ground, crs))
    chosen = _scheme(scheme)
    require_within(chosen, source.bounds)
    deepest = _deepest(source, chosen) if zoom is None else whole("zoom", zoom, 0, _DEEPEST)
    allowed = source.step / 4 if error is None else positive("error", error)
    quantum = smallest_quantum(*source.height_range)
    levels = {
        z: Level(allowed * 2.0 ** (deepest - z), quantum, MOST) for z in range(deepest + 1)
    }
    about = {"heights": "as in the raster, taken to be above the ellipsoid WGS 84"}
    job = Job(source, chosen, levels, Path(folder), gzip, borders == "skirts", about=about)
    return _write(job, format, workers, progress)


def _write(job: Job, format: str, workers: Workers, progress: Progress | None) -> TilesReport:
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
    allowed = tuple(job.levels[z].allowed for z in sorted(job.levels))
    return TilesReport(job.folder, format, records, allowed, len(left))


def _placed(ground: Heightmap, crs: str | None) -> Heightmap:
    if crs is None:
        return ground
    placed = copy(ground)
    object.__setattr__(placed, "crs", crs)
    return placed


def _deepest(source: Source, scheme: Scheme) -> int:
    """Return the first level whose lattice is as fine as the samples."""
    return next(
        (z for z in range(_DEEPEST) if reach(source, scheme, z) <= 1.0), _DEEPEST
    )


def _scheme(name: str) -> Scheme:
    return SCHEMES[one_of("scheme", name, SCHEMES)]


def _fingerprint(ground: Heightmap) -> str:
    """Return what tells a ground from others."""
    digest = hashlib.sha256(repr((ground.spacing, ground.origin, ground.base, ground.crs,
                                  ground.units)).encode())  # fmt: skip
    digest.update(np.ascontiguousarray(ground.heights).data)
    if ground.mask is not None:
        digest.update(np.packbits(ground.mask).data)
    return digest.hexdigest()
