"""Normals of the ground at vertices: from the ground, not from triangles, so that tiles agree."""

from __future__ import annotations

import numpy as np

from .ellipsoid import Floats, radii, upwards
from .levels import CELLS
from .mend import TileMesh
from .schemes import Scheme
from .source import Source


def vertex_normals(source: Source, scheme: Scheme, mesh: TileMesh) -> Floats:
    """Return earth-centred unit normals, (V, 3): by central differences, a lattice's step wide."""
    z = mesh.tile[0]
    lon, lat = mesh.surface.longitude, mesh.surface.latitude
    step = (scheme.longitude(z, 1) - scheme.longitude(z, 0)) / CELLS
    here = source.heights(lon, lat, 1.0)

    def slope(east: float, north: float, metres: Floats) -> Floats:
        ahead = source.heights(lon + east * step, lat + north * step, 1.0)
        behind = source.heights(lon - east * step, lat - north * step, 1.0)
        ahead, behind = (np.where(np.isnan(side), here, side) for side in (ahead, behind))
        return np.nan_to_num((ahead - behind) / (2 * step * metres), nan=0.0)

    metres_east, metres_north = radii(lat)
    east, north = slope(1, 0, metres_east), slope(0, 1, metres_north)
    lo = np.radians(lon)
    eastwards = np.stack([-np.sin(lo), np.cos(lo), np.zeros_like(lo)], axis=1)
    up = upwards(lon, lat)
    northwards = np.cross(up, eastwards)
    normals = up - east[:, None] * eastwards - north[:, None] * northwards
    return np.asarray(normals / np.linalg.norm(normals, axis=1)[:, None])
