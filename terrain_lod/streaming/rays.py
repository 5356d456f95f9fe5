"""The chunks that a ray may meet the ground in, in order."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from .cut import Chunks, Place
from .view import Array


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
