"""Samples of a finished store replaced, and all that is known of them."""

from __future__ import annotations

import hashlib
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import InputError
from .division import Samples
from .levels import Place, write_chunk_nodes, write_coarse_chunk, write_region
from .lock import locked
from .store import Store


def update(
    store: Store, rows: slice, columns: slice, heights: npt.NDArray[np.floating[Any]]
) -> Store:
    """Overwrite samples, so that the store is as if it had been built of the new ground.

    Regions that hold one of the samples are written anew, and the coarse levels above them.
    Meanwhile the store says that it is not finished; where this is cut off, it has to be built
    anew. Afterwards it is no longer that of its source, which the same build would refuse.

    Parameters
    ----------
    store : Store
    rows, columns : slice
        With start and stop, within the raster.
    heights : (R, C) floating
        Elevations, NaN where there is no data.

    Returns
    -------
    Store
        As it is described now.

    Raises
    ------
    InputError
        If float32 cannot hold the heights, or no data would be left.
    FileError
        If the store cannot be written or read, or another process is at work on it.
    """
    with np.errstate(over="ignore"):
        relative = (heights - store.description.base).astype(np.float32)
    if np.isinf(relative).any():
        raise InputError("expected heights that float32 can hold, got some beyond its range")
    regions = _touched(store, rows, columns)
    with locked(store.path.with_name(f"{store.path.name}.lock")):
        changed = {place: _replaced(store, place, rows, columns, relative) for place in regions}
        if len(changed) == np.prod(store.division.regions) and all(
            np.isnan(region).all() for region in changed.values()
        ):
            raise InputError("expected some data to be left, got nodata for the last of it")
        before = store.description
        other = hashlib.sha256(f"{before.fingerprint} updated".encode()).hexdigest()
        store = Store(store.path, replace(before, fingerprint=other, complete=False))
        store.describe()
        for place, region in changed.items():
            write_region(store, place, region)
        for level in store.division.coarse:
            within = (store.division.chunk << level) // store.division.region
            for place in sorted({(row // within, column // within) for row, column in regions}):
                write_coarse_chunk(store, level, place)
        write_chunk_nodes(store)
        store = Store(store.path, replace(store.description, complete=True))
        store.describe()
    return store


def _touched(store: Store, rows: slice, columns: slice) -> list[Place]:
    """Return the regions that hold one of the samples, be it on their border."""
    return [
        place
        for place in np.ndindex(store.division.regions)
        if all(
            has.start < part.stop and part.start < has.stop
            for has, part in zip(store.division.region_slices(*place), (rows, columns), strict=True)
        )
    ]


def _replaced(store: Store, place: Place, rows: slice, columns: slice, new: Samples) -> Samples:
    """Return the samples of a region, those that are new among them."""
    division, chunk = store.division, store.division.chunk
    down, across = division.region_slices(*place)
    heights = np.empty((down.stop - down.start, across.stop - across.start), np.float32)
    last = division.chunks(0)
    for row in range(down.start // chunk, min(-(-(down.stop - 1) // chunk), last[0])):
        for column in range(across.start // chunk, min(-(-(across.stop - 1) // chunk), last[1])):
            part = store.heights(0, row, column)
            top, left = row * chunk - down.start, column * chunk - across.start
            heights[top : top + part.shape[0], left : left + part.shape[1]] = part
    top, left = max(rows.start, down.start), max(columns.start, across.start)
    bottom, right = min(rows.stop, down.stop), min(columns.stop, across.stop)
    heights[top - down.start : bottom - down.start, left - across.start : right - across.start] = (
        new[top - rows.start : bottom - rows.start, left - columns.start : right - columns.start]
    )
    return heights
