"""What is written of regions: chunks of fine levels, of coarse ones, and what is known of all."""

from __future__ import annotations

import numpy as np

from ..errors import InputError
from .division import LADDER, NODE, Samples
from .handed import Handed
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
    Store,
)

Place = tuple[int, int]


def write_region(store: Store, place: Place, heights: Samples) -> None:
    """Write the chunks of a region, and hand up what coarser levels are made of.

    Parameters
    ----------
    store : Store
    place : (int, int)
        Row and column of the region.
    heights : float32
        Its samples, shared borders included, relative to the base; NaN where there is no data.
    """
    division = store.division
    region = Region(division, heights)
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


def write_coarse_chunk(store: Store, level: int, place: Place) -> None:
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


def write_chunk_nodes(store: Store) -> None:
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
