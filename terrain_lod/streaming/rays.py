"""What rays meet first, chunk by chunk."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ..mesh.hits import Hits
from .cut import Chunks, Place
from .view import Array
from .window import Window


def first_hits(
    chunks: Chunks, window: Callable[[Place], Window], starts: Array, ways: Array
) -> Hits:
    """Return what rays meet first of level 0, of which the chunks that they pass are asked for.

    Parameters
    ----------
    chunks : Chunks
    window : callable
        Returns a chunk.
    starts, ways : (N, 3) float64
    """
    count = len(starts)
    found = Hits(
        np.full((count, 3), np.nan), np.full(count, np.nan), np.full(count, -1, np.int32),
        np.full(count, -1, np.int32), np.full((count, 2), np.nan, np.float32),
        np.full((count, 3), np.nan),
    )  # fmt: skip
    ahead = [
        list(chunks_on_ray(chunks, start, way)) for start, way in zip(starts, ways, strict=True)
    ]
    # the next chunk of every ray that has met nothing yet, until none has one
    while any(ahead):
        by_chunk: dict[Place, list[int]] = {}
        for ray, places in enumerate(ahead):
            if places:
                by_chunk.setdefault(places.pop(0), []).append(ray)
        for place, rays in by_chunk.items():
            hits = window(place).terrain.cast(starts[rays], ways[rays])
            for number, ray in enumerate(rays):
                if hits.hit[number]:
                    found.position[ray] = hits.position[number]
                    found.distance[ray] = hits.distance[number]
                    found.normal[ray] = hits.normal[number]
                    ahead[ray] = []
    return found


def chunks_on_ray(chunks: Chunks, start: Array, way: Array) -> Iterator[Place]:
    """Yield the chunks of level 0 whose boxes a ray passes, the nearest first.

    Parameters
    ----------
    chunks : Chunks
    start, way : (3,) float64
        Where it starts, and its unit direction.
    """
    found: list[tuple[float, Place]] = []
    level = [chunks.root]
    while level:
        entered = _entries(chunks, level, start, way)
        inside = [
            (float(entry), place)
            for entry, place in zip(entered, level, strict=True)
            if not np.isnan(entry)
        ]
        if level[0][0] == 0:
            found = inside
            break
        level = [child for _, place in inside for child in chunks.children(place)]
    yield from (place for _, place in sorted(found))


def _entries(chunks: Chunks, places: list[Place], start: Array, way: Array) -> Array:
    """Return how far on a ray enters each box, NaN where it does not."""
    boxes = chunks.boxes(places)
    # rounding of the ray, and boxes that are flat
    slack = 1e-9 * (np.abs(boxes.low) + np.abs(boxes.high) + np.abs(start))
    with np.errstate(divide="ignore", invalid="ignore"):
        one, other = ((edge - start) / way for edge in (boxes.low - slack, boxes.high + slack))
        near, far = np.fmin(one, other), np.fmax(one, other)
        still = way == 0
        outside = (start < boxes.low - slack) | (start > boxes.high + slack)
    near[:, still] = np.where(outside[:, still], np.nan, -np.inf)
    far[:, still] = np.where(outside[:, still], np.nan, np.inf)
    entry, leave = np.maximum(near.max(axis=1), 0.0), far.min(axis=1)
    entered: Array = np.where(entry <= leave, entry, np.nan)
    return entered
