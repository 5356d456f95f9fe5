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
from .schemes import Scheme, Tile
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
    from numbers that are the same for all four. Where a level has its borders from a deeper one,
    a side is those of the tiles of that level, one after the other.
    """
    z, x, y = tile
    parts = 1 << level.deeper
    first = x * parts, y * parts
    far = reach(source, scheme, z + level.deeper)
    sides = []
    for axis, line in ((0, 0), (0, 1), (1, 0), (1, 1)):
        places, quanta = [], []
        for part in range(parts):
            begin = [first[0] + parts * line, first[1] + parts * line]
            begin[axis] = first[axis] + part
            place, quantum = _line(source, scheme, z + level.deeper, begin, axis, far, level)
            # what one ends with, the next one begins with
            last = None if part == parts - 1 else -1
            places.append(place[:last] + part * (level.size // parts))
            quanta.append(quantum[:last])
        sides.append(Side(axis, line * level.size, np.concatenate(places), np.concatenate(quanta)))
    return tuple(sides)


def _line(
    source: Source, scheme: Scheme, z: int, begin: list[int], axis: int, far: float, level: Level
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return places and heights of the vertices between two corners of the tiles of a level."""
    end = list(begin)
    end[axis] += 1
    (west, south), (east, north) = (
        (scheme.longitude(z, column), scheme.latitude(z, row)) for column, row in (begin, end)
    )
    size = level.size >> level.deeper
    points = CELLS
    while points < _POINTS * far * CELLS and 2 * points < size:
        points *= 2
    share = np.arange(points + 1) / points
    lon, lat = west + (east - west) * share, south + (north - south) * share
    heights = _heights(source, lon, lat, far, level)
    for index, corner in ((0, (west, south)), (-1, (east, north))):
        alone = np.array([corner[0]]), np.array([corner[1]])
        heights[index] = _heights(source, alone[0], alone[1], far, level)[0]
    middle = (west + east) / 2, (south + north) / 2
    # what is asked of the level that the border is from
    allowed = level.asked / 2**level.deeper - level.rounding
    kept = kept_points(heights - bulge(lon, lat, middle), _SHARE * allowed)
    places = np.rint(kept * (size / points)).astype(np.int64)
    return places, np.rint(heights[kept] / level.quantum).astype(np.int64)


def _heights(
    source: Source, longitude: Floats, latitude: Floats, far: float, level: Level
) -> Floats:
    return np.nan_to_num(source.heights(longitude, latitude, far), nan=level.bare)


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
