"""Checks of the kernels that keep an error promised: ladder, selection, measure."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from ..camera.camera import Camera
from ..device.device import Device
from ..device.layout import FIXED_ONE
from ..reference.terrain import (
    domain,
    ladder,
    selection,
    weights,
)
from ..terrain.buffers import DeviceLadder
from ..terrain.ladder import cheapest_first, ladder_on_device
from ..terrain.selection import FIRST_SHARE, Selection, edge_share
from ..terrain.weights import COLUMNS, weights_on_device
from ..tessellation.pattern import DevicePattern
from .checkup import Array, Check, largest_difference
from .terrain import METRES, Case


@cache
def cases() -> tuple[Case, Case, Case]:
    """Ground of some dozen tiles: the ladder's reference takes its time."""
    return (
        Case(holed=False, shape=(66, 50)),
        Case(holed=True, shape=(66, 50)),
        Case(holed=True, detailed=True, shape=(66, 50)),
    )


@cache
def expected_ladder(case: Case) -> tuple[Array, Array, Array, Array]:
    """Return the errors of tiles, of their inner samples, of edges across and of edges down."""
    return ladder.ladder(case.ground, case.grid, case.fits)


def check_ladder(device: Device) -> Check:
    differences = []
    for case in cases():
        tiles = case.tiles(device)
        found = ladder_on_device(tiles.ground, tiles.analysis)
        arrays = found.tiles, found.inner, found.across, found.down
        for array, expected in zip(arrays, expected_ladder(case), strict=True):
            differences.append(largest_difference(array.host(), expected))
    return Check(max(differences), METRES, "m")


def begin(
    case: Case, device: Device, *, metres: float = np.inf, pixels: float = np.inf
) -> Selection:
    """Return the selection for an error; nothing is culled."""
    tiles, inner, across, down = (
        device.array(errors.astype(np.float32)) for errors in expected_ladder(case)
    )
    order = device.array(cheapest_first(case.grid.levels))
    ladder = DeviceLadder(tiles, inner, across, down, order)
    return Selection.start(
        replace(case.tiles(device), ladder=ladder),
        camera_over(case),
        metres=metres,
        pixels=pixels,
        cull=False,
    )


def camera_over(case: Case) -> Camera:
    x, y, z = case.ground.centre
    return Camera((x - 2000, y - 1500, z + 800), (x, y, z))


def check_selection(device: Device) -> Check:
    differences = []
    for case in cases():
        camera = camera_over(case)
        boxes = [selection.bounding_box(case.grid, fit, i) for i, fit in enumerate(case.fits)]
        metres = [
            selection.metres_for_pixels(camera, low + case.origin, high + case.origin, 20.0)
            for low, high in boxes
        ]
        empty = np.isnan([fit.minimum for fit in case.fits])
        found = begin(case, device, pixels=20.0)
        expected = np.where(empty, np.nan, metres)
        differences.append(largest_difference(found.allowed.host(), expected))

        found = begin(case, device, metres=3.0)
        found.choose()
        edge, inside = selection.factors(
            case.ground,
            case.grid,
            case.fits,
            np.where(empty, np.nan, 3.0 * FIRST_SHARE),
            expected_ladder(case),
            edge_share=edge_share(case.grid.tile),
            order=cheapest_first(case.grid.levels),
        )
        differences.append(largest_difference(found.factors.edge.host(), edge))
        differences.append(largest_difference(found.factors.inside.host(), inside))
    return Check(max(differences), METRES, "m")


def check_weights(device: Device) -> Check:
    different, count = 0, 0
    for case in cases():
        camera = camera_over(case)
        strengths = {"horizon": 4.0, "silhouette": 3.0}
        found = weights_on_device(case.tiles(device), camera, **strengths).host()
        expected = weights.weights(case.grid, case.fits, camera, case.origin, COLUMNS, **strengths)
        different += int(np.count_nonzero(np.abs(found - expected) > METRES))
        count += case.grid.count
    # a tile whose side is the border of a column may fall on either side of it
    return Check(different, 0.05 * count, "tiles")


def check_tile_error(device: Device) -> Check:
    differences = []
    random, count = np.random.default_rng(7), 12
    for case in cases():
        grid, tiles = case.grid, case.grid.count
        # triangles between random points of each tile
        points = random.integers(0, FIXED_ONE + 1, (tiles * count, 2)).astype(np.uint32)
        corners = random.integers(0, count, (tiles * count, 3))
        patch = np.repeat(np.arange(tiles), count)
        triangles = (corners + count * patch[:, None]).astype(np.int32)
        offsets = device.array(np.arange(0, len(points) + 1, count, dtype=np.uint32))
        found = begin(case, device, metres=3.0)
        found.changed.fill(1)
        pattern = DevicePattern(device.array(points), device.array(triangles), offsets, offsets)
        found.measure(pattern)
        columns, rows = domain.global_coordinates(grid, points, patch)
        positions, _ = domain.displace(case.ground, grid, points, patch)
        placed = np.stack([columns / FIXED_ONE, rows / FIXED_ONE, positions[:, 2]], axis=1)
        expected = []
        for index, (row, column) in enumerate(np.ndindex(grid.shape)):
            top, bottom = grid.corner_rows[row : row + 2]
            left, right = grid.corner_columns[column : column + 2]
            window = slice(top, bottom + 1), slice(left, right + 1)
            own = placed[triangles[patch == index]] - (left, top, 0)
            expected.append(
                selection.tile_error(
                    case.ground.heights[window].astype(np.float64), case.ground.valid[window], own
                )
            )
        differences.append(largest_difference(found.measured.host(), np.array(expected)))
    return Check(max(differences), METRES, "m")
