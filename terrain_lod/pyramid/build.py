"""Building a pyramid: regions first, by whoever is there, then the levels above them."""

from __future__ import annotations

import logging
import os
from dataclasses import replace
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
from .division import CHUNK, Division
from .levels import write_chunk_nodes, write_coarse_chunk, write_region
from .lock import locked
from .store import HANDED_ERRORS, Description, Store

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
                write_coarse_chunk(store, level, place)
        write_chunk_nodes(store)
        _require_unchanged(source, store.description)
        Store(path, replace(store.description, complete=True)).describe()
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
    store = Store(path, description)
    heights = source.read(*description.division.region_slices(*place))
    if isinstance(source, RasterFile | Folder):
        _require_unchanged(source, description)
    if description.base:
        with np.errstate(over="ignore"):
            heights -= description.base
    with np.errstate(over="ignore"):
        heights = heights.astype(np.float32, copy=False)
    if np.isinf(heights).any():
        raise InputError("expected heights that float32 can hold, got some beyond its range")
    write_region(store, place, heights)
