"""The mesh of one tile: made with a promise, given its borders, measured, and mended.

::

    lattice ─▶ Terrain.mesh ─▶ onto the tile's grid ─▶ weld to the borders ─▶ measure ─┬─▶ TileMesh
                                                                               ▲       │
                                                                               └ insert┘ samples

Everything is a function of the ground and the tile. What stands on a border is a function of the
heights along that border alone, so neighbours of one level agree there to the bit.
"""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from ..device.device import Device
from ..ground.heightmap import Heightmap
from ..terrain.lod_promises import MaxErrorLod
from ..terrain.terrain import Terrain
from .borders import tile_sides
from .ellipsoid import Floats, bulge
from .levels import CELLS, Level, reach
from .mend import TileMesh, mended
from .residuals import Triangles
from .schemes import Scheme, Tile, bounds_of, lines
from .source import Source
from .weld import Outline, Places

# cells along the engine's tiles of a tile's lattice
_PATCH: Final = 4
# what of the error the lattice's mesh may use: between its points there are samples
_SHARE: Final = 0.97


def tile_mesh(
    source: Source, scheme: Scheme, tile: Tile, level: Level, device: Device | None = None
) -> TileMesh:
    """Return the mesh of a tile, within what the level allows wherever that can be had."""
    bounds = bounds_of(scheme, tile)
    longitudes, latitudes = lines(scheme, tile, CELLS)
    far = reach(source, scheme, tile[0])
    heights = source.heights(*np.meshgrid(longitudes, latitudes), far)
    heights = np.nan_to_num(heights, nan=level.bare)
    sides = tile_sides(source, scheme, tile, level)
    places, triangles = _meshed(heights, longitudes, latitudes, level, device)
    outline = Outline(places, triangles, level.size)
    for side in sides:
        outline.fit(side.axis, side.line, side.places.tolist())
    places, triangles = outline.result()
    used, triangles = _compact(triangles)
    places = places[used]
    quanta = np.rint(_between(heights, places / level.size * CELLS) / level.quantum)
    quanta = quanta.astype(np.int64)
    for side in sides:
        on_side = places[:, 1 - side.axis] == side.line
        along = np.searchsorted(side.places, places[on_side, side.axis])
        quanta[on_side] = side.quanta[along]
    if level.holed:
        bare = quanta * level.quantum < source.height_range[0] - level.allowed
        triangles = triangles[~bare[triangles].any(axis=1)]
        used, triangles = _compact(triangles)
        places, quanta = places[used], quanta[used]
    return mended(TileMesh(tile, bounds, level, places, quanta, triangles), source)


def _meshed(
    heights: Floats, longitudes: Floats, latitudes: Floats, level: Level, device: Device | None
) -> tuple[Places, Triangles]:
    """Mesh the lattice with the engine; the ellipsoid's curvature counts as height."""
    middle = float(longitudes[CELLS // 2]), float(latitudes[CELLS // 2])
    curved = heights - bulge(longitudes[None, :], latitudes[:, None], middle)
    ground = Heightmap(curved[::-1], origin=(0.0, float(CELLS)))
    terrain = Terrain(ground, tile=_PATCH, device=device)
    mesh = terrain.mesh(lod=MaxErrorLod(_SHARE * level.allowed), partitioning="integer")
    steps = (mesh.vertices[:, :2] + mesh.origin[:2]) * (level.size / CELLS)
    places = np.rint(steps).astype(np.int64)
    # patches have vertices of their own
    unique, same = np.unique(places[:, 0] * (level.size + 1) + places[:, 1], return_inverse=True)
    columns, rows = np.divmod(unique, level.size + 1)
    return np.stack([columns, rows], axis=1), same.astype(np.int32)[mesh.triangles]


def _compact(triangles: Triangles) -> tuple[npt.NDArray[np.int64], Triangles]:
    """Return the vertices that are used, and the triangles by the numbers of these."""
    there = np.zeros(int(triangles.max(initial=-1)) + 1, bool)
    there[triangles] = True
    numbers = (np.cumsum(there) - 1).astype(np.int32)
    return np.flatnonzero(there), numbers[triangles]


def _between(heights: Floats, steps: Floats) -> Floats:
    """Return lattice heights, bilinear at (column, row) with fractions; (V,)."""
    first = np.minimum(steps.astype(np.int64), CELLS - 1)
    across, up = (steps - first).T
    column, row = first.T
    south = heights[row, column] * (1 - across) + heights[row, column + 1] * across
    north = heights[row + 1, column] * (1 - across) + heights[row + 1, column + 1] * across
    return np.asarray(south * (1 - up) + north * up)
