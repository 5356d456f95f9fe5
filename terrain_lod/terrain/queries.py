"""Heights of the ground between its samples and rays against it, on the device."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from ..device.device import Kernel
from ..mesh.hits import Array, Hits
from .buffers import DeviceGround
from .tiles import DeviceTiles

_GROUP: Final = 64
# cells within which a point is on a sample
_NEAR: Final = 2.0**-26


def heights_on_device(tiles: DeviceTiles, points: Array) -> Array:
    """Return elevations at world points (N, 2); NaN outside and where a sample is missing."""
    device = tiles.device
    found = device.empty(len(points), np.float64)
    _kernel("ground_heights", tiles.ground)(
        (len(points),),
        (_GROUP,),
        **_raster(tiles.ground),
        count=len(points),
        points=device.array(points),
        found=found,
    )
    return found.host()


def rays_on_device(tiles: DeviceTiles, origins: Array, directions: Array) -> Hits:
    """Return what rays from world `origins` along unit `directions`, (N, 3), meet first."""
    device, count = tiles.device, len(origins)
    distances, normals = device.empty(count, np.float64), device.empty((count, 3), np.float64)
    numbers = device.empty(count, np.int32)
    _kernel("ground_rays", tiles.ground)(
        (count,),
        (_GROUP,),
        **_raster(tiles.ground),
        count=count,
        details=tiles.analysis.details,
        origins=device.array(origins),
        directions=device.array(directions),
        ts=distances,
        tiles=numbers,
        normals=normals,
    )
    distance = distances.host()
    return Hits(
        position=origins + distance[:, None] * directions,
        distance=distance,
        tile=numbers.host(),
        triangle=np.full(count, -1, np.int32),
        factor=np.full((count, 2), np.nan, np.float32),
        normal=normals.host(),
    )


def _kernel(name: str, ground: DeviceGround) -> Kernel:
    ground.device.require_doubles("queries")
    return ground.device.kernel("terrain/queries.cl", name, NEAR=_NEAR, **ground.defines)


def _raster(ground: DeviceGround) -> dict[str, Any]:
    """Return the arguments that both kernels share."""
    x0, y0, base = ground.origin
    dx, dy = ground.grid.spacing
    return {
        **ground.arguments,
        "x0": x0,
        "y0": y0,
        "base": base,
        "dx": dx,
        "dy": dy,
    }
