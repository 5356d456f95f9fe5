"""What the tiles of one level share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from .ellipsoid import radii
from .schemes import Scheme, bounds_of, tiles_over
from .source import Source

# cells along a tile's lattice
CELLS: Final = 256
# what arithmetic on numbers of the Earth's size adds to an error: metres, and a part of it
_ARITHMETIC: Final = 1e-6


@dataclass(frozen=True)
class Level:
    """What all tiles of a level share.

    Attributes
    ----------
    asked : float
        Error asked for, metres.
    rounding : float
        What of it the format's vertices take by being rounded, metres.
    quantum : float
        Heights are whole multiples of this, metres; a power of two.
    size : int
        Places are whole numbers from 0 to this, along both axes of a tile.
    bare : float
        Height where there is no ground, metres: so low that it is none, or the ellipsoid's, 0.
    holed : bool
        Whether triangles that reach there are left out.
    deeper : int
        How many levels deeper the one is that borders are from; 0 where they are its own.
    """

    asked: float
    rounding: float
    quantum: float
    size: int
    bare: float = 0.0
    holed: bool = False
    deeper: int = 0

    @property
    def allowed(self) -> float:
        """What is left for triangles, metres."""
        return (self.asked - self.rounding - _ARITHMETIC) / (1 + _ARITHMETIC)

    def stated(self, measured: float) -> float:
        """Return the error to state for one that was measured, metres."""
        return measured * (1 + _ARITHMETIC) + _ARITHMETIC + self.rounding


def reach(source: Source, scheme: Scheme, z: int) -> float:
    """Return the step of a level's lattice in the middle of the ground, in samples of it."""
    west, south, east, north = source.bounds
    middle = (west + east) / 2, (south + north) / 2
    (column, *_), (row, *_) = tiles_over(scheme, z, middle * 2)
    west, south, east, north = bounds_of(scheme, (z, column, row))
    metres_east, metres_north = radii(np.array(middle[1]))
    across = max((east - west) * metres_east, (north - south) * metres_north)
    return float(across) / CELLS / source.step
