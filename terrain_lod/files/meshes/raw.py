"""What a mesh file holds, before it is a Mesh: polygons, and what was left out of them."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ...errors import InputError

Floats = npt.NDArray[np.floating[Any]]
Integers = npt.NDArray[np.int64]

# what the comments that record an origin begin with
ORIGIN_MARK: Final = "terrain_lod origin"
_ORIGIN: Final = re.compile(
    rb"%b ([^\s\0]+) ([^\s\0]+) ([^\s\0]+)(?: crs ([^\n\r\0]+))?" % ORIGIN_MARK.encode()
)

# what of a RawMesh are arrays
ARRAYS: Final = ("points", "corners", "sizes", "normals", "textures", "origin")


@dataclass
class RawMesh:
    """Polygons as a reader found them, nothing checked yet.

    Attributes
    ----------
    points : (V, 3) array of float
        float32 where the file has no more, else float64.
    corners : (K,) int64
        Indices into `points`, one polygon after the other.
    sizes : (F,) int64
        How many corners each polygon has; their sum is K.
    normals : (V, 3) array of float, or None
    textures : (V, 2) array of float, or None
        u to the right, v up.
    origin : (3,) float64, or None
        World point that `points` are relative to; None where the file does not say.
    crs : str or None
    notes : list of str
        What the reader did that a user may want to know.
    dropped : Counter of str
        How many of what the reader left out.
    """

    points: Floats
    corners: Integers
    sizes: Integers
    normals: Floats | None = None
    textures: Floats | None = None
    origin: npt.NDArray[np.float64] | None = None
    crs: str | None = None
    notes: list[str] = field(default_factory=list)
    dropped: Counter[str] = field(default_factory=Counter)

    def note(self, comments: bytes) -> RawMesh:
        """Take the origin and the CRS from comments of a file, where they have one; return self."""
        found = _ORIGIN.search(comments)
        if found is not None:
            try:
                self.origin = np.array([float(number) for number in found.groups()[:3]])
            except ValueError:
                raise ValueError("the origin in its comment is no three numbers") from None
            self.crs = found[4].decode(errors="replace").strip() if found[4] else None
        return self


def require_corners(corners: Integers, sizes: Integers, count: int) -> None:
    """Refuse polygons whose corners are not among `count` vertices.

    Raises
    ------
    InputError
        Names the first such face.
    """
    if not corners.size or 0 <= corners.min() <= corners.max() < count:
        return
    corner = int(np.argmax((corners < 0) | (corners >= count)))
    face = int(np.searchsorted(np.cumsum(sizes), corner, side="right"))
    raise InputError(
        f"expected a mesh whose corners are among its {count} vertices, "
        f"got corner {corners[corner]} of face {face}, counted from 0"
    )


def strips_to_triangles(corners: Integers, sizes: Integers) -> Integers:
    """Return the triangles (T, 3) of triangle strips, all turned the way of their first.

    ::

        0---2---4        0 1 2 | 2 1 3 | 2 3 4
         \\ / \\ /
          1---3
    """
    ends = np.cumsum(sizes)
    # a triangle begins at every corner but the last two of its strip
    within = np.arange(len(corners)) - np.repeat(ends - sizes, sizes)
    begins = np.flatnonzero(within < np.repeat(sizes - 2, sizes))
    triangles = corners[begins[:, None] + np.arange(3)]
    odd = within[begins] % 2 == 1
    triangles[odd] = triangles[odd][:, [1, 0, 2]]
    # strips are stitched by triangles with two equal corners
    a, b, c = triangles.T
    result: Integers = triangles[(a != b) & (b != c) & (c != a)]
    return result


def of_triangles(triangles: Integers) -> tuple[Integers, Integers]:
    """Return triangles (T, 3) as corners and sizes."""
    return triangles.ravel(), np.full(len(triangles), 3, np.int64)
