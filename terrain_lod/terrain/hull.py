"""The hull stage: 12 control points a patch become tessellation factors."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..arguments import one_of
from ..device import layout
from ..device.arrays import DeviceArray
from ..device.formulas import formula_defines, formula_numbers
from ..ground.grid import TileGrid
from ..tessellation.factors import DeviceFactors
from .buffers import DeviceAnalysis, DeviceGround, DevicePatches
from .lod import Lod, Scene

# how an edge's factor comes from the two tiles' levels of detail
EDGE_RULES: Final = {"min": "fmin", "max": "fmax"}

_GROUP: Final = 64


def patch_indices(tile_rows: int, tile_columns: int) -> npt.NDArray[np.int32]:
    """Return the index buffer of the 12-control-point patches.

    Control points are the corners of all tiles, (TR + 1) x (TC + 1), row by row. A patch holds

    - 0 1 2 3: its own corners, north-west, north-east, south-west, south-east
    - 4 5: the far corners of the neighbour at u = 1, east
    - 6 7: at v = 1, south
    - 8 9: at u = 0, west
    - 10 11: at v = 0, north

    ::

              10 --- 11
               |     |
         8 --- 0 --- 1 --- 4
         |     |     |     |
         9 --- 2 --- 3 --- 5
               |     |
               6 --- 7

    clamped to the border of the terrain, so that a missing neighbour's midpoint is the midpoint
    of the edge.

    Returns
    -------
    (P, 12) int32

    Notes
    -----
    Zink, Pettineo, Hoxley: *Practical Rendering and Computation with Direct3D 11*, listing 9.2
    and figure 9.5; its x is u here, its z is v.
    """
    # steps from the patch's north-western corner, row then column
    steps = np.array(
        [
            *[(0, 0), (0, 1), (1, 0), (1, 1)],
            *[(0, 2), (1, 2), (2, 0), (2, 1)],
            *[(0, -1), (1, -1), (-1, 0), (-1, 1)],
        ]
    )
    row, column = np.indices((tile_rows, tile_columns)).reshape(2, -1, 1)
    rows = np.clip(row + steps[:, 0], 0, tile_rows)
    columns = np.clip(column + steps[:, 1], 0, tile_columns)
    indices: npt.NDArray[np.int32] = (rows * (tile_columns + 1) + columns).astype(np.int32)
    return indices


def patches_on_device(ground: DeviceGround, grid: TileGrid, fallback: float) -> DevicePatches:
    """Displace the corners of all tiles; `fallback` is their height where there is no data."""
    rows, columns = grid.shape
    patches = DevicePatches(
        ground.device.empty((rows + 1, columns + 1, 4), np.float32),
        ground.device.array(patch_indices(rows, columns)),
    )
    displace_corners(ground, grid, patches, fallback)
    return patches


def displace_corners(
    ground: DeviceGround, grid: TileGrid, patches: DevicePatches, fallback: float
) -> None:
    """Put the control points of `patches` on the ground as it is now."""
    device = ground.device
    rows, columns = grid.shape
    kernel = device.kernel("terrain/control_points.cl", "control_points", **ground.defines)
    kernel(
        ((rows + 1) * (columns + 1),),
        (_GROUP,),
        grid=grid.record(),
        **ground.arguments,
        fallback=fallback,
        points=patches.control_points,
    )


def hull_on_device(
    grid: TileGrid,
    patches: DevicePatches,
    analysis: DeviceAnalysis,
    lod: Lod,
    scene: Scene,
    view: npt.NDArray[Any],
    *,
    edges: str = "min",
    cull: bool = True,
    weights: DeviceArray | None = None,
) -> DeviceFactors:
    """Run the patch-constant function of every patch.

    Parameters
    ----------
    grid : TileGrid
    patches : DevicePatches
    analysis : DeviceAnalysis
    lod : Lod
    scene : Scene
    view : layout.VIEW record
    edges : {"min", "max"}, optional
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
    device = analysis.details.device
    rule = EDGE_RULES[one_of("edge rule", edges, EDGE_RULES)]
    parameters = lod.parameters(scene)
    formula = formula_defines("LOD", lod.header, parameters, prefix="LOD_")
    kernel = device.kernel("terrain/hull.cl", "hull", EDGE_RULE=rule, **formula)
    factors = DeviceFactors(
        device.empty((grid.count, layout.EDGES), np.float32),
        device.empty((grid.count, layout.INSIDES), np.float32),
    )
    kernel(
        (grid.count,),
        (_GROUP,),
        grid=grid.record(),
        view=view,
        cull=int(cull),
        parameters=formula_numbers(device, parameters),
        control_points=patches.control_points,
        patch_indices=patches.indices,
        planes=analysis.planes,
        details=analysis.details,
        weights=device.empty(grid.count, np.float32).fill(1.0) if weights is None else weights,
        edge_factors=factors.edge,
        inside_factors=factors.inside,
    )
    return factors
