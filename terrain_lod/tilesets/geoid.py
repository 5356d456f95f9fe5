"""Heights above sea level made heights above the ellipsoid, by a geoid that the user names."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np

from ..arguments import told
from ..errors import InputError, MissingExtraError
from ..ground.heightmap import Heightmap
from ..ground.place import Place
from ..ground.units import METRE, unit_called
from .ellipsoid import Floats
from .source import Source

# names for grids of PROJ's collection
GRIDS: Final = {
    "egm96": "us_nga_egm96_15.tif",
    "egm2008": "us_nga_egm08_25.tif",
}
ELLIPSOID: Final = "ellipsoid"
# rows worked on together
_ROWS: Final = 256


@dataclass(frozen=True)
class Geoid:
    """A geoid that PROJ has the grid of.

    Attributes
    ----------
    grid : str
    shift : callable
        Of PROJ: longitudes, latitudes and zeros become its heights above the ellipsoid.
    """

    grid: str
    shift: Callable[[Floats, Floats, Floats], Any]

    @classmethod
    def called(cls, name: str) -> Geoid:
        """Return a geoid by a key of :data:`GRIDS`, or by a grid's file.

        Raises
        ------
        InputError
            If PROJ has no such grid.
        MissingExtraError
            If pyproj is not installed.
        """
        try:
            from pyproj import Transformer
            from pyproj.exceptions import ProjError
        except ImportError:
            raise MissingExtraError(
                "expected pyproj for a geoid, got none: pip install 'terrain_lod[tiles]'"
            ) from None
        grid = GRIDS.get(name, name)
        if name not in GRIDS and not os.path.isfile(name):
            names = ", ".join([ELLIPSOID, *GRIDS])
            raise InputError(
                f"expected one of {names}, or a grid's file, for geoid, got {told(name)}"
            )
        try:
            shift = Transformer.from_pipeline(f'+proj=vgridshift +grids="{grid}" +multiplier=1')
        except ProjError:
            raise InputError(
                f"expected the grid {grid} on this machine, got none that PROJ can read: "
                f"`pyproj sync --file {grid}` brings it"
            ) from None
        return cls(grid, shift.transform)

    def above_ellipsoid(self, longitude: Floats, latitude: Floats) -> Floats:
        """Return the geoid's heights above the ellipsoid, in metres.

        Raises
        ------
        InputError
            If the grid does not reach so far.
        """
        heights = np.asarray(self.shift(longitude, latitude, np.zeros_like(longitude))[2])
        if not np.isfinite(heights).all():
            raise InputError(f"expected a geoid that covers all of the ground, got {self.grid}")
        return heights


def above_ellipsoid(ground: Heightmap, geoid: Geoid) -> Heightmap:
    """Return a ground with its heights, which are above a geoid, in metres above the ellipsoid."""
    source = Source(ground, Place.of(ground.crs), 1.0, ground.heights, None, (0, 0, 0, 0))
    undulation = np.empty(ground.shape)
    for top in range(0, ground.shape[0], _ROWS):
        row, column = np.mgrid[top : min(top + _ROWS, ground.shape[0]), : ground.shape[1]]
        lon, lat = source.degrees(row.astype(np.float64), column.astype(np.float64))
        undulation[top : top + _ROWS] = geoid.above_ellipsoid(lon, lat)
    unit = unit_called(ground.units[1]) or METRE
    return Heightmap(
        ground.elevation * unit.metres + undulation,
        spacing=ground.spacing,
        origin=ground.origin,
        crs=ground.crs,
        units=(ground.units[0], METRE.name),
        name=ground.name,
    )
