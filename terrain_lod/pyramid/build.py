"""Building a pyramid: regions first, by whoever is there, then the levels above them."""

from __future__ import annotations

import logging
import os
from functools import partial
from pathlib import Path
from typing import Any, Final

import numpy as np

from ..arguments import file_path, finite, told, whole
from ..errors import FileError, InputError
from ..sources.folder import Folder
from ..sources.opening import source_of
from ..sources.raster_file import RasterFile
from ..sources.source import Source
from ..tasks import Progress, Workers, require_workers, run_tasks
from .division import CHUNK, LADDER, NODE, Division
from .handed import Handed
from .lock import locked
from .region import Nodes, Region, into_chunks, nodes_into_chunks
from .store import (
    CHUNK_ERRORS,
    CHUNK_RANGES,
    ERRORS,
    HANDED_ERRORS,
    HANDED_HEIGHTS,
    HANDED_RANGES,
    HEIGHTS,
    RANGES,
    Description,
    Store,
)

log = logging.getLogger(__name__)

# samples along each axis that a base is chosen by
_PROBES: Final = 32
# bytes a sample of a region while it is worked on: read, masked, relative to the base, cut into
# chunks, packed; measured with benchmarks/pyramid.py, and rounded up
_WORK_BYTES: Final = 32
# Python, NumPy, GDAL and zarr with nothing to do
_IDLE_BYTES: Final = 250_000_000

Place = tuple[int, int]


def build(
    ground: Any,
    path: str | os.PathLike[str],
    *,
    workers: Workers = None,
    progress: Progress | None = None,
    chunk: int = CHUNK,
    base: float | None = None,
    spacing: float | tuple[float, float] | str | None = None,
    height_range: tuple[float, float] | None = None,
    nodata: float | None = None,
    band: int | None = None,
    z_unit: str | None = None,
    z_scale: float | None = None,
) -> Path:
    """Make a pyramid on disk of ground of any size.

    The source is read once, region by region. A build that was stopped, however roughly, goes on
    where it was when it is started again, and the same store comes of it, byte for byte, whoever
    did the work and in whatever order.

    Parameters
    ----------
    ground : path, array or Heightmap
        A file that :func:`load` reads, a folder of such tiles side by side, an array of NumPy,
        xarray, dask or zarr, a memory map, or a heightmap. Overviews are not looked at.
    path : str or path
        The store, a folder that ends in .tlod by custom.
    workers : int, executor or None, optional
        None for this process, a number of processes, or whatever has ``submit``: an executor of
        ``concurrent.futures``, or a ``dask.distributed.Client`` whose workers find `ground` and
        `path` under the same names.
    progress : callable, optional
        Called with the regions done and those in all.
    chunk : int, optional
        Cells along a chunk, a power of two from 16 to 4096.
    base : float, optional
        What heights are stored relative to, of one's own choice: two stores that are to meet
        without a crack need the same.
    spacing, height_range, nodata, band, z_unit, z_scale : optional
        How heights are read, as :func:`load` takes them.

    Returns
    -------
    pathlib.Path
        The store.

    Raises
    ------
    InputError
        If `ground` is none, changes while it is read, or is not what the store was begun with.
    FileError
        If a file cannot be read, the store not written, or another process is building it.
    WorkerError
        If workers die again and again.
    MissingExtraError
        If zarr, or what reads the source, is not installed.
    """
    require_workers(workers)
    source = source_of(
        ground, spacing=spacing, height_range=height_range, nodata=nodata, band=band,
        z_unit=z_unit, z_scale=z_scale,
    )  # fmt: skip
    path = file_path("path", path)
    chunk = whole("chunk", chunk, 16, 4096)
    division = Division(*source.shape, chunk)
    log.info("%s: %s", path, memory_line(division))
    if not path.name:
        raise InputError(f"expected the name of a store for path, got {told(str(path))}")
    if not path.parent.is_dir():
        raise FileError(f"expected a folder to make {path.name} in, got none at {path.parent}")
    with locked(path.with_name(f"{path.name}.lock")):
        store = _store_of(source, path, division, base)
        if store.description.complete:
            return path
        # what killed writers left
        for left in path.rglob("*.partial"):
            left.unlink(missing_ok=True)
        todo = [place for place in np.ndindex(division.regions) if not _is_done(store, place)]
        done = division.regions[0] * division.regions[1] - len(todo)
        work = partial(_build_region, source, store.path, store.description)
        for count, _ in enumerate(run_tasks(work, todo, workers=workers), done + 1):
            if progress is not None:
                progress(count, done + len(todo))
        # a 256th of all there is to do, and less
        for level in division.coarse:
            for place in np.ndindex(division.chunks(level)):
                _build_chunk(store, level, place)
        _gather(store)
        _require_unchanged(source, store.description)
        store.finish()
    return path


def worker_bytes(division: Division) -> int:
    """Return how many bytes a worker takes at most."""
    rows, columns = (min(division.region, cells) + 1 for cells in division.cells)
    return _IDLE_BYTES + _WORK_BYTES * rows * columns


def memory_line(division: Division) -> str:
    """Say what a build takes, before it begins."""
    regions = division.regions[0] * division.regions[1]
    return (
        f"{division.rows:,} x {division.columns:,} samples in {regions:,} regions and "
        f"{len(division.levels)} levels; each worker takes at most "
        f"{worker_bytes(division) / 1e9:.2g} GB"
    )


def _store_of(source: Source, path: Path, division: Division, base: float | None) -> Store:
    """Return the store that this build goes on with, or a new one."""
    fingerprint = source.fingerprint()
    # a build that was killed at once leaves a folder without a description
    begun_at_all = path.is_file() or any(
        not entry.name.endswith(".partial") for entry in path.glob("*")
    )
    if begun_at_all:
        store = Store.open(path, unfinished=True)
        begun, same_base = store.description, base in (None, store.description.base)
        if (begun.fingerprint, begun.division) != (fingerprint, division) or not same_base:
            raise InputError(
                f"expected the source that {path} was begun with, got another one, a changed one "
                "or other options: remove the store, or choose another path"
            )
        store.make()
        return store
    reading = source.reading
    description = Description(
        *source.shape,
        division.chunk,
        _base(source) if base is None else finite("base", base),
        reading.spacing,
        reading.origin,
        reading.crs,
        reading.units,
        reading.name,
        fingerprint,
    )
    store = Store(path, description)
    store.make()
    return store


def _base(source: Source) -> float:
    """Return the whole number that heights are stored relative to, 0 where float32 holds them."""
    if source.is_exact:
        return 0.0
    known = []
    rows = sorted({int(place) for place in np.linspace(0, source.shape[0] - 2, _PROBES)})
    columns = sorted({int(place) for place in np.linspace(0, source.shape[1] - 2, _PROBES)})
    for row, column in zip(rows, columns, strict=False):
        part = source.read(slice(row, row + 2), slice(column, column + 2))
        known += list(part[~np.isnan(part)])
    return float(np.round(min(known) / 2 + max(known) / 2)) if known else 0.0


def _is_done(store: Store, place: Place) -> bool:
    # what a region hands up is written after its chunks, and this last
    return store.file_of(HANDED_ERRORS, place).is_file()


def _require_unchanged(source: Source, description: Description) -> None:
    if source.fingerprint() != description.fingerprint:
        raise InputError(
            f"expected {source.reading.name} to stay as it is while it is read, got a changed one: "
            "remove the store, and build again"
        )


def _build_region(source: Source, path: Path, description: Description, place: Place) -> None:
    """Read a region, write its chunks, and hand up what coarser levels are made of."""
    store, division = Store(path, description), description.division
    rows, columns = division.region_slices(*place)
    heights = source.read(rows, columns)
    if isinstance(source, RasterFile | Folder):
        _require_unchanged(source, description)
    if description.base:
        with np.errstate(over="ignore"):
            heights -= description.base
    with np.errstate(over="ignore"):
        region = Region(division, heights.astype(np.float32, copy=False))
    if np.isinf(region.heights).any():
        raise InputError("expected heights that float32 can hold, got some beyond its range")
    del heights
    known = region.nodes()
    for level in division.fine:
        chunks = into_chunks(region.lattice(level), division.chunk)
        nodes = nodes_into_chunks(known[level], division.nodes)
        within = division.region // division.chunk >> level
        here = tuple(
            slice(number * within, number * within + extent)
            for number, extent in zip(place, chunks.shape[:2], strict=True)
        )
        store.write(f"{HEIGHTS}/{level}", here, chunks)
        store.write(f"{ERRORS}/{level}", here, nodes.errors)
        store.write(f"{RANGES}/{level}", here, nodes.ranges)
        known[level] = nodes.largest()
    handed = Handed.of(division, [region.lattice(level) for level in division.coarse], known)
    store.write(HANDED_HEIGHTS, place, handed.heights)
    store.write(HANDED_RANGES, place, handed.ranges)
    # says that all of the region is there
    store.write(HANDED_ERRORS, place, handed.errors)


def _handed(store: Store, place: Place) -> Handed:
    names = HANDED_HEIGHTS, HANDED_ERRORS, HANDED_RANGES
    return Handed(store.division, *(store.read(name, place) for name in names))


def _build_chunk(store: Store, level: int, place: Place) -> None:
    """Put a chunk of a coarse level together from what its regions handed up."""
    division = store.division
    rows, columns = (
        range(number * across, min((number + 1) * across, regions))
        for across in [(division.chunk << level) // division.region]
        for number, regions in zip(place, division.regions, strict=True)
    )
    heights = np.full((division.chunk + 1,) * 2, np.nan, np.float32)
    errors, ranges = [], []
    for row in rows:
        parts = [_handed(store, (row, column)) for column in columns]
        for column, part in enumerate(parts):
            lattice = part.lattice(level)
            top, left = (number * (len(lattice) - 1) for number in (row - rows.start, column))
            target = heights[top : top + len(lattice), left : left + len(lattice)]
            np.copyto(target, lattice, where=~np.isnan(lattice))
        nodes = [part.nodes(level) for part in parts]
        errors.append(np.concatenate([part.errors for part in nodes], axis=1))
        ranges.append(np.concatenate([part.ranges for part in nodes], axis=1))
    known = Nodes(np.concatenate(errors), np.concatenate(ranges))
    # a node may be larger than a region
    known = nodes_into_chunks(known.gathered((NODE << level) // division.region), division.nodes)
    store.write(f"{HEIGHTS}/{level}", place, heights)
    store.write(f"{RANGES}/{level}", place, known.ranges[0, 0])
    store.write(f"{ERRORS}/{level}", place, known.errors[0, 0])


def _gather(store: Store) -> None:
    """Write what is known of all chunks where it can be read at once."""
    division = store.division
    found = {
        level: Nodes(
            np.zeros((*division.chunks(level), LADDER), np.uint8),
            np.full((*division.chunks(level), 2), np.nan, np.float32),
        )
        for level in division.levels
    }
    for place in np.ndindex(division.regions):
        handed = _handed(store, place)
        for level in division.fine:
            nodes = handed.nodes(level)
            top, left = (number * len(nodes.errors) for number in place)
            here = np.s_[top : top + len(nodes.errors), left : left + len(nodes.errors)]
            rows, columns = found[level].errors[here].shape[:2]
            found[level].errors[here] = nodes.errors[:rows, :columns]
            found[level].ranges[here] = nodes.ranges[:rows, :columns]
    for level in division.coarse:
        for place in np.ndindex(division.chunks(level)):
            nodes = store.nodes(level, *place).gathered(division.nodes)
            found[level].errors[place] = nodes.errors[0, 0]
            found[level].ranges[place] = nodes.ranges[0, 0]
    if np.isnan(found[division.top].ranges).all():
        raise InputError("expected heights, got no data at all (every sample is NaN or masked)")
    for level, nodes in found.items():
        store.write(f"{CHUNK_ERRORS}/{level}", (...,), nodes.errors)
        store.write(f"{CHUNK_RANGES}/{level}", (...,), nodes.ranges)
