"""Which points of a tile's border are vertices: chosen by the heights along it alone.

Two tiles of a level share a border, and both choose from the same heights. So they agree, whatever
stands within them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from .ellipsoid import Floats, bulge
from .levels import CELLS, Level, reach
from .schemes import Scheme, Tile, bounds_of
from .source import Source

# what of the error a border may use
_SHARE: Final = 0.6
# points of a border for each sample along it: samples on it are never far from one
_POINTS: Final = 4


@dataclass(frozen=True, eq=False)
class Side:
    """One of the four sides of a tile.

    Attributes
    ----------
    axis : {0, 1}
        Which coordinate varies along it: x or y.
    line : int
        The other coordinate, 0 or the level's size.
    places : (B,) int64
        Of the vertices along it, ascending.
    quanta : (B,) int64
        Their heights.
    """

    axis: int
    line: int
    places: npt.NDArray[np.int64]
    quanta: npt.NDArray[np.int64]


def tile_sides(source: Source, scheme: Scheme, tile: Tile, level: Level) -> tuple[Side, ...]:
    """Return the southern, northern, western and eastern side of a tile.

    All of a side is worked out from arrays that are the same for both of its tiles, and a corner
    from numbers that are the same for all four.
    """
    west, south, east, north = bounds_of(scheme, tile)
    far = reach(source, scheme, tile[0])
    points = CELLS
    while points < _POINTS * far * CELLS and 2 * points < level.size:
        points *= 2
    share = np.arange(points + 1) / points
    corners = {
        (lon, lat): _heights(source, np.array([lon]), np.array([lat]), far)[0]
        for lon in (west, east)
        for lat in (south, north)
    }
    sides = []
    for axis, line, begin, end in (
        (0, 0, (west, south), (east, south)),
        (0, level.size, (west, north), (east, north)),
        (1, 0, (west, south), (west, north)),
        (1, level.size, (east, south), (east, north)),
    ):
        lon = begin[0] + (end[0] - begin[0]) * share
        lat = begin[1] + (end[1] - begin[1]) * share
        heights = _heights(source, lon, lat, far)
        heights[0], heights[-1] = corners[begin], corners[end]
        middle = (begin[0] + end[0]) / 2, (begin[1] + end[1]) / 2
        kept = kept_points(heights - bulge(lon, lat, middle), _SHARE * level.allowed)
        places = np.rint(kept * (level.size / points)).astype(np.int64)
        quanta = np.rint(heights[kept] / level.quantum).astype(np.int64)
        sides.append(Side(axis, line, places, quanta))
    return tuple(sides)


def _heights(source: Source, longitude: Floats, latitude: Floats, far: float) -> Floats:
    return np.nan_to_num(source.heights(longitude, latitude, far), nan=0.0)


def kept_points(heights: Floats, tolerance: float) -> npt.NDArray[np.int64]:
    """Return indices of the points that a line is drawn through, the first and the last included.

    Every point left out is at most `tolerance` above or below the line. From each vertex the next
    one is as far as it can be: the fewest vertices that points of the line can give.

    Parameters
    ----------
    heights : (N,) float64
        At even distances.
    tolerance : float

    References
    ----------
    Imai, Iri: *Polygonal approximations of a curve*, 1988; the wedge that narrows is from Sklansky,
    Gonzalez: *Fast polygonal approximation of digitized curves*, 1980.
    """
    values = heights.tolist()
    last = len(values) - 1
    kept, begin = [0], 0
    while begin < last:
        low, high, found = -np.inf, np.inf, begin + 1
        for index in range(begin + 1, last + 1):
            along, rise = index - begin, values[index] - values[begin]
            if low <= rise / along <= high:
                found = index
            low = max(low, (rise - tolerance) / along)
            high = min(high, (rise + tolerance) / along)
            if low > high:
                break
        kept.append(found)
        begin = found
    return np.array(kept, np.int64)
