"""The hull stage: 12 control points a patch become tessellation factors."""

from __future__ import annotations

from typing import Final

import numpy as np

from ..arguments import one_of
from ..camera.camera import Camera
from ..device import layout
from ..device.device import DeviceArray
from ..device.formulas import formula_defines, formula_numbers
from ..tessellation.factors import DeviceFactors
from .lod import Lod
from .tiles import DeviceTiles

# how an edge's factor comes from the two tiles' levels of detail
EDGE_RULES: Final = {"min": "fmin", "max": "fmax"}

_GROUP: Final = 64


def hull_on_device(
    tiles: DeviceTiles,
    lod: Lod,
    camera: Camera | None,
    *,
    edge_rule: str = "min",
    cull: bool = True,
    weights: DeviceArray | None = None,
) -> DeviceFactors:
    """Run the patch-constant function of every patch.

    Parameters
    ----------
    tiles : DeviceTiles
    lod : Lod
    camera : Camera or None
    edge_rule : {"min", "max"}, optional
        Factor of an edge from the levels of detail on its two sides: ``"min"`` is the book's,
        ``"max"`` never gives an edge less than either side asks for.
    cull : bool, optional
        Leave out patches whose bounds are outside the frustum.
    weights : DeviceArray, (P,) float32, optional
        That each tile's level of detail is multiplied by.

    Returns
    -------
    DeviceFactors
    """
    device, count, analysis = tiles.device, tiles.grid.count, tiles.analysis
    rule = EDGE_RULES[one_of("edge rule", edge_rule, EDGE_RULES)]
    parameters = lod.parameters(tiles.scene)
    formula = formula_defines("LOD", lod.header, parameters, prefix="LOD_")
    kernel = device.kernel("terrain/hull.cl", "hull", EDGE_RULE=rule, **formula)
    factors = DeviceFactors(
        device.empty((count, layout.EDGES), np.float32),
        device.empty((count, layout.INSIDES), np.float32),
    )
    kernel(
        (count,),
        (_GROUP,),
        grid=tiles.grid.record(),
        view=tiles.view(camera),
        cull=int(cull),
        parameters=formula_numbers(device, parameters),
        control_points=tiles.patches.control_points,
        patch_indices=tiles.patches.indices,
        planes=analysis.planes,
        details=analysis.details,
        weights=device.empty(count, np.float32).fill(1.0) if weights is None else weights,
        edge_factors=factors.edge,
        inside_factors=factors.inside,
    )
    return factors
