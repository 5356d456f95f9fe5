"""STL, read: facets in text or in binary, corners at one place made one vertex.

3D Systems: *StereoLithography Interface Specification*, 1988.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from .raw import Floats, Integers, RawMesh, of_triangles
from .words import numbers, text_of

_HEADER: Final = 80
_FACET: Final = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("color", "<u2")])
_VERTEX: Final = re.compile(rb"\bvertex\s+(\S+\s+\S+\s+\S+)", re.IGNORECASE)
_FACETS: Final = re.compile(rb"\b(end)?facet\b", re.IGNORECASE)
_END: Final = re.compile(rb"\bendsolid\b", re.IGNORECASE)


def read_stl(path: Path) -> RawMesh:
    """Return the facets of a file; their normals are left aside, as they are the triangles' own.

    Raises
    ------
    ValueError
        If it is damaged or truncated.
    """
    content = text_of(path)
    start = _HEADER + 4
    claimed = start + _FACET.itemsize * int.from_bytes(content[_HEADER:start], "little")
    # some binary files begin with "solid", too: their size tells
    if content[:5].lower() == b"solid" and len(content) != claimed and b"\0" not in content:
        soup: Floats = _text(content)
        comments = content[:_HEADER]
    elif len(content) < max(start, claimed):
        raise ValueError(f"expected {claimed} bytes, got {len(content)}: is it truncated?")
    else:
        facets = np.frombuffer(content, _FACET, (claimed - start) // _FACET.itemsize, start)
        soup = facets["corners"].reshape(-1, 3)
        comments = content[:_HEADER]
    points, corners = merged(soup)
    return RawMesh(points, *of_triangles(corners.reshape(-1, 3))).note(comments)


def _text(content: bytes) -> npt.NDArray[np.float64]:
    """Return the corners of facets in text, (3 T, 3)."""
    soup = numbers(_VERTEX.findall(content), 3, "a vertex")
    marks = [bool(end) for end in _FACETS.findall(content)]
    begun, ended = marks.count(False), marks.count(True)
    if begun != ended or not _END.search(content):
        raise ValueError("it ends within a solid: is it truncated?")
    if len(soup) != 3 * begun:
        raise ValueError(f"expected three corners a facet, got {len(soup)} for {begun}")
    return soup


def merged(points: Floats) -> tuple[Floats, Integers]:
    """Return points without repetition, in the order they first come, and the place of each.

    Parameters
    ----------
    points : (N, 3) array of float

    Returns
    -------
    points : (V, 3) array of float
    places : (N,) int64
    """
    points = np.ascontiguousarray(points) + points.dtype.type(0)  # no -0
    # one number a point sorts faster than three; where two points share one, the three decide
    words: npt.NDArray[Any] = points.view(f"u{points.itemsize}").astype(np.uint64)
    keys = np.zeros(len(points), np.uint64)
    for column in words.T:
        keys = (keys ^ column) * np.uint64(0x9E3779B97F4A7C15)
        keys ^= keys >> np.uint64(29)
    _, first, places = np.unique(keys, return_index=True, return_inverse=True)
    if not np.array_equal(points[first][places], points, equal_nan=True):
        _, first, places = np.unique(points, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return points[first[order]], rank[places.ravel()]
