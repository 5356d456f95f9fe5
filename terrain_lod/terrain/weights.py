"""Weights of tiles on any level of detail: what stands against the sky, and what turns away."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..camera.camera import Camera
from ..device.device import DeviceArray
from .tiles import DeviceTiles

COLUMNS: Final = 512  # of the picture, that the horizon is kept in

_GROUP: Final = 64


def reach_of(view: npt.NDArray[Any]) -> float:
    """Return how far the picture reaches to its sides: a tangent, or a distance where parallel."""
    if not view["parallel"]:
        return float(view["widest"])
    # the left plane: right . (point - eye) + half the width
    return float(view["planes"][0, 3] + view["axes"][0] @ view["eye"])


def weights_on_device(
    tiles: DeviceTiles, camera: Camera, *, horizon: float, silhouette: float
) -> DeviceArray:
    """Return a weight a tile, (P,) float32: 1 where neither applies.

    Parameters
    ----------
    tiles : DeviceTiles
    camera : Camera
    horizon, silhouette : float
        Weights of a tile that stands against the sky, and of one that is seen edge on.
    """
    device, count, view = tiles.device, tiles.grid.count, tiles.view(camera)
    keys = device.zeros(COLUMNS, np.uint32)
    weights = device.empty(count, np.float32)
    shared = {
        "grid": tiles.grid.record(),
        "view": view,
        "reach": reach_of(view),
        "planes": tiles.analysis.planes,
        "details": tiles.analysis.details,
        "keys": keys,
    }
    device.kernel("terrain/weights.cl", "horizon", COLUMNS=COLUMNS)((count,), (_GROUP,), **shared)
    device.kernel("terrain/weights.cl", "weigh", COLUMNS=COLUMNS)(
        (count,),
        (_GROUP,),
        **shared,
        horizon_weight=horizon,
        silhouette_weight=silhouette,
        weights=weights,
    )
    return weights
