"""Points and rays asked of a surface, and what a ray meets."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arguments import array
from ..errors import InputError

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Hits:
    """What each of N rays meets first; NaN and -1 where it meets nothing.

    Attributes
    ----------
    position : (N, 3) float64
        In the world.
    distance : (N,) float64
        From the ray's origin, in world units, whatever the length of its direction.
    tile : (N,) int32
        Number of the tile, row by row.
    triangle : (N,) int32
        Of the mesh; -1 for a ray against the ground itself.
    factor : (N, 2) float32
        Inside tessellation factors of the tile, along u and v; NaN where there is no triangle.
    normal : (N, 3) float64
        Unit normal of what was hit: of the triangle, or of the ground between its samples. Hits
        are on both sides: it points the way the surface does, not towards the ray.
    """

    position: Array
    distance: Array
    tile: npt.NDArray[np.int32]
    triangle: npt.NDArray[np.int32]
    factor: npt.NDArray[np.float32]
    normal: Array

    @property
    def hit(self) -> npt.NDArray[np.bool_]:
        """True where a ray meets the surface; (N,)."""
        return ~np.isnan(self.distance)

    def __len__(self) -> int:
        return len(self.distance)

    def __repr__(self) -> str:
        return f"Hits({np.count_nonzero(self.hit)} of {len(self)} rays)"


def checked_points(points: npt.ArrayLike) -> Array:
    """Return x and y of points, (N, 2), or say what is wrong with them."""
    return _finite("points", points, 2)


def checked_rays(origins: npt.ArrayLike, directions: npt.ArrayLike) -> tuple[Array, Array]:
    """Return origins and unit directions, (N, 3) both; one origin or direction serves all."""
    starts, ways = _finite("origins", origins, 3), _finite("directions", directions, 3)
    if len(starts) != len(ways) and 1 not in (len(starts), len(ways)):
        raise InputError(f"expected an origin a direction, got {len(starts)} and {len(ways)}")
    starts, ways = np.broadcast_arrays(starts, ways)
    # the longest component first: squares of very long ones overflow
    longest = np.abs(ways).max(axis=1, initial=0.0, keepdims=True)
    if not longest.all():
        raise InputError(
            f"expected directions, got (0, 0, 0) for ray {int(np.argmin(longest.ravel()))}"
        )
    ways = ways / longest
    return np.ascontiguousarray(starts), ways / np.linalg.norm(ways, axis=1, keepdims=True)


def _finite(name: str, values: npt.ArrayLike, width: int) -> Array:
    with suppress(ValueError):  # rows of different lengths
        if np.shape(values) == (width,):  # one that stands alone
            values = np.asarray(values)[None]
    return array(name, values, ("N", width))
