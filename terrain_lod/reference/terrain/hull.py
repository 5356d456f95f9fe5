"""Tessellation factors of every patch, in float64: what ``terrain/hull.cl`` computes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...camera.camera import Camera
from ...ground.grid import TileGrid
from ...ground.heightmap import Heightmap
from ...terrain.lod import Lod, Scene
from .analysis import TileFit
from .lod import FORMULAS, Formula, Patch
from .selection import bounding_box

Array = npt.NDArray[np.float64]


def control_points(ground: Heightmap, grid: TileGrid, fallback: float) -> Array:
    """Return the displaced tile corners, relative to the terrain's origin; (TR+1, TC+1, 3)."""
    rows, columns = np.meshgrid(grid.corner_rows, grid.corner_columns, indexing="ij")
    heights = np.where(ground.valid, ground.heights, fallback)[rows, columns]
    return np.stack([columns * ground.spacing[0], -rows * ground.spacing[1], heights], axis=-1)


def _levels(points: Array, fits: list[TileFit], grid: TileGrid, lod: Lod, scene: Scene, eye: Array,
            formula: Formula, row_step: int, column_step: int,
            camera: Camera | None) -> Array:  # fmt: skip
    """Return each tile's neighbour's level of detail; at the border, the edge midpoint's."""
    tile_rows, tile_columns = grid.shape
    row, column = np.indices(grid.shape)
    # corners of the neighbour, clamped onto the control points that exist
    corners = [
        points[
            np.clip(row + row_step + down, 0, tile_rows),
            np.clip(column + column_step + across, 0, tile_columns),
        ]
        for down in (0, 1)
        for across in (0, 1)
    ]
    midpoint = np.mean(corners, axis=0)
    inside = (row + row_step >= 0) & (row + row_step < tile_rows)
    inside &= (column + column_step >= 0) & (column + column_step < tile_columns)
    neighbour = np.where(
        inside, (row + row_step) * tile_columns + column + column_step, row * tile_columns + column
    )

    def of(name: str) -> Array:
        return np.array([getattr(fit, name) for fit in fits], np.float64)[neighbour]

    boxes = np.array([bounding_box(grid, fit, index) for index, fit in enumerate(fits)])
    # the camera's world is as far from the terrain's as its eye says
    shift = 0 if camera is None else camera.eye - eye
    patch = Patch(
        distance=np.linalg.norm(midpoint - eye, axis=-1),
        deviation=of("deviation"),
        midpoint=midpoint,
        normal=of("normal"),
        minimum=of("minimum"),
        maximum=of("maximum"),
        boxes=boxes[neighbour] + shift,
        holes=of("nodata"),
        camera=camera,
    )
    levels = formula(patch, lod.parameters(scene))
    return np.where(np.isnan(patch.minimum), np.nan, levels)


def is_culled(grid: TileGrid, fits: list[TileFit], planes: Array) -> npt.NDArray[np.bool_]:
    """Return True where the tile's bounding box is outside one frustum plane; (TR, TC)."""
    x, y = grid.corner_columns * grid.spacing[0], -grid.corner_rows * grid.spacing[1]
    low_z = np.array([fit.minimum for fit in fits]).reshape(grid.shape)
    high_z = np.array([fit.maximum for fit in fits]).reshape(grid.shape)
    culled = np.zeros(grid.shape, bool)
    for normal_x, normal_y, normal_z, offset in planes:
        farthest = (
            np.maximum(normal_x * x[:-1], normal_x * x[1:])
            + np.maximum(normal_y * y[:-1], normal_y * y[1:])[:, None]
            + np.maximum(normal_z * low_z, normal_z * high_z)
            + offset
        )
        culled |= farthest < 0
    return culled


def factors(
    ground: Heightmap,
    grid: TileGrid,
    fits: list[TileFit],
    lod: Lod,
    scene: Scene,
    eye: Array,
    planes: Array | None,
    *,
    edge_rule: str = "min",
    camera: Camera | None = None,
    formula: Formula | None = None,
) -> tuple[Array, Array]:
    """Return edge factors (P, 4) and inside factors (P, 2); `planes` None culls nothing.

    `eye` and `planes` are relative to the terrain's origin; the `camera` they are of is needed for
    formulas that look at the picture. `formula` is what the level of detail's header computes, if
    that is not one of ``kernels/``.
    """
    low, _ = ground.height_range
    points = control_points(ground, grid, low - ground.base)
    steps = ((0, 0), (0, -1), (-1, 0), (0, 1), (1, 0))
    formula = formula or FORMULAS[lod.header]
    own, *others = (
        _levels(points, fits, grid, lod, scene, eye, formula, *step, camera) for step in steps
    )
    holes = np.array([fit.nodata for fit in fits]).reshape(grid.shape) > 0
    around = np.pad(holes, 1)
    other_holes = (around[1:-1, :-2], around[:-2, 1:-1], around[1:-1, 2:], around[2:, 1:-1])
    cells_down = np.diff(grid.corner_rows)[:, None] + 0 * own
    cells_across = np.diff(grid.corner_columns) + 0 * own
    rule = {"min": np.minimum, "max": np.maximum}[edge_rule]

    def limited(level: Array, is_holed: npt.NDArray[np.bool_], cells: Array) -> Array:
        return np.where(is_holed, cells, np.clip(level, 1, cells))

    edge = np.stack(
        [
            limited(
                np.where(np.isnan(other), own, rule(own, other)),
                holes | other_hole,
                cells_across if along_u else cells_down,
            )
            for other, other_hole, along_u in zip(others, other_holes, (0, 1, 0, 1), strict=True)
        ],
        axis=-1,
    )
    # a single cell beside several takes up to three segments inside
    across = np.where((cells_across == 1) & (cells_down > 1), 3, cells_across)
    down = np.where((cells_down == 1) & (cells_across > 1), 3, cells_down)
    inside = np.stack([limited(own, holes, across), limited(own, holes, down)], axis=-1)
    culled = np.isnan(own)
    if planes is not None:
        culled |= is_culled(grid, fits, planes)
    edge[culled] = 0
    inside[culled] = 0
    return edge.reshape(-1, 4), inside.reshape(-1, 2)
