"""Heights above sea level made heights above the ellipsoid, by a geoid that the user names."""

from __future__ import annotations

import os
from typing import Final

import numpy as np

from ..arguments import told
from ..errors import InputError, MissingExtraError
from ..ground.heightmap import Heightmap
from ..ground.units import METRE, unit_called
from .place import Place
from .source import Source

# names for grids of PROJ's collection
GRIDS: Final = {
    "egm96": "us_nga_egm96_15.tif",
    "egm2008": "us_nga_egm08_25.tif",
}
ELLIPSOID: Final = "ellipsoid"
# rows worked on together
_ROWS: Final = 256


def above_ellipsoid(ground: Heightmap, geoid: str) -> Heightmap:
    """Return a ground with its heights, which are above a geoid, in metres above the ellipsoid.

    Parameters
    ----------
    ground : Heightmap
    geoid : str
        A key of :data:`GRIDS`, or a grid's file.

    Raises
    ------
    InputError
        If PROJ has no such grid, or the grid does not reach as far as the ground.
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
    grid = GRIDS.get(geoid, geoid)
    if geoid not in GRIDS and not os.path.isfile(geoid):
        names = ", ".join([ELLIPSOID, *GRIDS])
        raise InputError(f"expected one of {names}, or a grid's file, for geoid, got {told(geoid)}")
    try:
        shift = Transformer.from_pipeline(f'+proj=vgridshift +grids="{grid}" +multiplier=1')
    except ProjError:
        raise InputError(
            f"expected the grid {grid} on this machine, got none that PROJ can read: "
            f"`pyproj sync --file {grid}` brings it"
        ) from None
    source = Source(ground, Place.of(ground.crs), 1.0, ground.heights, None, (0, 0, 0, 0))
    undulation = np.empty(ground.shape)
    for top in range(0, ground.shape[0], _ROWS):
        row, column = np.mgrid[top : min(top + _ROWS, ground.shape[0]), : ground.shape[1]]
        lon, lat = source.degrees(row.astype(np.float64), column.astype(np.float64))
        undulation[top : top + _ROWS] = shift.transform(lon, lat, np.zeros_like(lon))[2]
    if not np.isfinite(undulation).all():
        raise InputError(f"expected a geoid that covers all of the ground, got {grid}")
    unit = unit_called(ground.units[1]) or METRE
    return Heightmap(
        ground.elevation * unit.metres + undulation,
        spacing=ground.spacing,
        origin=ground.origin,
        crs=ground.crs,
        units=(ground.units[0], METRE.name),
        name=ground.name,
    )
