"""Ground taller than it is, for pictures in which relief would hardly be seen."""

from __future__ import annotations

import numpy as np

from ..arguments import positive
from .heightmap import Heightmap


def exaggerated(ground: Heightmap, exaggeration: float) -> Heightmap:
    """Return ground whose elevations are so many times as high, sea level staying where it is.

    Parameters
    ----------
    ground : Heightmap
    exaggeration : float
        Above 0; 1 returns the ground itself.

    Raises
    ------
    InputError
        If it is not above 0, or the heights do not fit float32.
    """
    factor = positive("exaggeration", exaggeration)
    if factor == 1:
        return ground
    return Heightmap(
        np.multiply(ground.heights, factor, dtype=np.float64),
        spacing=ground.spacing,
        origin=ground.origin,
        base=ground.base * factor,
        mask=ground.mask,
        crs=ground.crs,
        units=ground.units,
        name=ground.name,
    )
