"""What the tiles of one level share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from .ellipsoid import radii
from .schemes import Scheme
from .source import Source

# cells along a tile's lattice
CELLS: Final = 256


@dataclass(frozen=True)
class Level:
    """What all tiles of a level share.

    Attributes
    ----------
    allowed : float
        Error asked for, metres.
    quantum : float
        Heights are whole multiples of this, metres; a power of two.
    size : int
        Places are whole numbers from 0 to this, along both axes of a tile.
    """

    allowed: float
    quantum: float
    size: int


def reach(source: Source, scheme: Scheme, z: int) -> float:
    """Return the step of a level's lattice, in samples of the ground."""
    middle = (source.bounds[1] + source.bounds[3]) / 2
    height = scheme.latitude(z, 1) - scheme.latitude(z, 0)
    width = scheme.longitude(z, 1) - scheme.longitude(z, 0)
    east, north = radii(np.array(middle))
    return float(max(height * north, width * east)) / CELLS / source.step
