"""Weights of tiles on any level of detail: what stands against the sky, and what turns away."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..device.device import DeviceArray
from ..ground.grid import TileGrid
from .buffers import DeviceAnalysis

COLUMNS: Final = 512  # of the picture, that the horizon is kept in

_GROUP: Final = 64


def reach_of(view: npt.NDArray[Any]) -> float:
    """Return how far the picture reaches to its sides: a tangent, or a distance where parallel."""
    if not view["parallel"]:
        return float(view["widest"])
    # the left plane: right . (point - eye) + half the width
    return float(view["planes"][0, 3] + view["axes"][0] @ view["eye"])


def weights_on_device(
    grid: TileGrid,
    analysis: DeviceAnalysis,
    view: npt.NDArray[Any],
    *,
    horizon: float,
    silhouette: float,
) -> DeviceArray:
    """Return a weight a tile, (P,) float32: 1 where neither applies.

    Parameters
    ----------
    grid : TileGrid
    analysis : DeviceAnalysis
    view : layout.VIEW record
    horizon, silhouette : float
        Weights of a tile that stands against the sky, and of one that is seen edge on.
    """
    device = analysis.details.device
    keys = device.zeros(COLUMNS, np.uint32)
    weights = device.empty(grid.count, np.float32)
    shared = {
        "grid": grid.record(),
        "view": view,
        "reach": reach_of(view),
        "planes": analysis.planes,
        "details": analysis.details,
        "keys": keys,
    }
    device.kernel("terrain/weights.cl", "horizon", COLUMNS=COLUMNS)(
        (grid.count,), (_GROUP,), **shared
    )
    device.kernel("terrain/weights.cl", "weigh", COLUMNS=COLUMNS)(
        (grid.count,),
        (_GROUP,),
        **shared,
        horizon_weight=horizon,
        silhouette_weight=silhouette,
        weights=weights,
    )
    return weights
