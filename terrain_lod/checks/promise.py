"""Checks of the kernels that keep an error promised: ladder, selection, measure, weights."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from ..device.device import Device
from ..device.layout import FIXED_ONE
from ..reference.terrain import domain, selection, weights
from ..terrain.buffers import DeviceLadder
from ..terrain.ladder import cheapest_first, ladder_on_device
from ..terrain.selection import FIRST_SHARE, Selection, edge_share
from ..terrain.weights import COLUMNS, weights_on_device
from ..tessellation.tessellator import tessellate_device
from .check import Bound, Check, Difference, ulp
from .grounds import Ground, View, hard_grounds, hard_views, oblique, plain_grounds, plain_views

_TILES: Final = Bound(
    "ladder of tiles",
    "m",
    "16 ulp of the tile's height range",
    "heights are differences to the tile's lowest, errors differences of these; a lattice height "
    "is bilinear, and the triangle's three products",
)
_EDGES: Final = Bound(
    "ladder of edges", "m", "16 ulp of the height range", "as of tiles, along a line"
)


def _ladder(case: Ground, device: Device) -> Iterator[Difference]:
    uploaded = case.tiles(device)
    found = ladder_on_device(uploaded.ground, uploaded.analysis)
    tiles, inner, across, down = case.ladder
    allowed = 16 * ulp(case.ranges)[:, None, None]
    yield _TILES.met_by(found.tiles.host(), tiles, allowed)
    yield _TILES.met_by(found.inner.host(), inner, allowed)
    yield _EDGES.met_by(found.across.host(), across, 16 * ulp(case.range))
    yield _EDGES.met_by(found.down.host(), down, 16 * ulp(case.range))


LADDER: Final = Check(_ladder, plain_grounds, hard_grounds)

_ALLOWED: Final = Bound(
    "allowed error",
    "m",
    "1e-5 of it, and 2e-6 of the tile's height range",
    "pixels at the depth of a box: a quotient of sums of products, whose corners are rounded",
)
_CHOSEN: Final = Bound(
    "chosen factors", "segments", "exact", "odd whole numbers: a choice of measured errors"
)


def _begin(
    view: View, device: Device, *, metres: float = np.inf, pixels: float = np.inf
) -> Selection:
    """Return the selection for an error; nothing is culled."""
    case = view.ground
    tiles, inner, across, down = (device.array(errors.astype(np.float32)) for errors in case.ladder)
    order = device.array(cheapest_first(case.grid.levels))
    ladder = DeviceLadder(tiles, inner, across, down, order)
    return Selection.start(
        replace(case.tiles(device), ladder=ladder),
        view.camera,
        metres=metres,
        pixels=pixels,
        cull=False,
    )


def _selection(view: View, device: Device) -> Iterator[Difference]:
    case = view.ground
    boxes = [selection.bounding_box(case.grid, fit, i) for i, fit in enumerate(case.fits)]
    metres = np.array(
        [
            selection.metres_for_pixels(view.camera, low + case.origin, high + case.origin, 1.0)
            for low, high in boxes
        ]
    )
    empty = np.isnan([fit.minimum for fit in case.fits])
    expected = np.where(empty, np.nan, metres)
    found = _begin(view, device, pixels=1.0).allowed.host()
    yield _ALLOWED.met_by(found, expected, 1e-5 * metres + 2e-6 * case.ranges)

    begun = _begin(view, device, metres=3.0)
    begun.choose()
    edge, inside = selection.factors(
        case.sum,
        case.grid,
        case.fits,
        np.where(empty, np.nan, 3.0 * FIRST_SHARE),
        case.ladder,
        edge_share=edge_share(case.grid.tile),
        order=cheapest_first(case.grid.levels),
    )
    yield _CHOSEN.met_by(begun.factors.edge.host(), edge)
    yield _CHOSEN.met_by(begun.factors.inside.host(), inside)


def _odd(views: dict[str, View]) -> dict[str, View]:
    """Leave out even tiles: no level of a ladder has their cells, so the references stop later."""
    return {name: view for name, view in views.items() if view.ground.grid.tile % 2}


SELECTION: Final = Check(_selection, plain_views, lambda: _odd(hard_views()))

_WEIGHTS: Final = Bound(
    "tiles of another weight",
    "tiles",
    "5 % of them",
    "a weight follows from the columns of the picture that a tile stands in: one whose side is the "
    "border of a column may fall on either side of it; others agree to 1e-3",
)


def _weights(view: View, device: Device) -> Iterator[Difference]:
    case, strengths = view.ground, {"horizon": 4.0, "silhouette": 3.0}
    found = weights_on_device(case.tiles(device), view.camera, **strengths).host()
    expected = weights.weights(case.grid, case.fits, view.camera, case.origin, COLUMNS, **strengths)
    unlike = np.count_nonzero(~(np.abs(found - expected) <= 1e-3))
    yield _WEIGHTS.met_by(unlike, 0, 0.05 * case.grid.count)


WEIGHTS: Final = Check(_weights, plain_views, hard_views)

_TILE_ERROR: Final = Bound(
    "tile error",
    "m",
    "16 ulp of the height range below, 1e-4 of it above",
    "too much is safe, too little is not: a sample beside a triangle may count as in it, where the "
    "plane of a sliver goes on",
)


def _tile_error(case: Ground, device: Device) -> Iterator[Difference]:
    grid, random = case.grid, np.random.default_rng(7)
    # strips between edges and insides of any factors: triangles of all shapes
    edge, inside = (
        random.uniform(1, grid.tile, (grid.count, width)).astype(np.float32) for width in (4, 2)
    )
    pattern = tessellate_device(
        "quad", device.array(edge), device.array(inside), "fractional_odd", clockwise=False
    )
    begun = _begin(oblique(case), device, metres=1.0)
    begun.changed.fill(1)
    begun.measure(pattern)
    points, triangles = pattern.points.host(), pattern.primitives.host()
    patch = np.repeat(np.arange(grid.count), np.diff(pattern.point_offsets.host()))
    columns, rows = domain.global_coordinates(grid, points, patch)
    positions, _ = domain.displace(case.sum, grid, points, patch)
    placed = np.stack([columns / FIXED_ONE, rows / FIXED_ONE, positions[:, 2]], axis=1)
    offsets, expected = pattern.primitive_offsets.host(), np.zeros(grid.count)
    for index, (row, column) in enumerate(np.ndindex(grid.shape)):
        top, bottom = grid.corner_rows[row : row + 2]
        left, right = grid.corner_columns[column : column + 2]
        window = slice(top, bottom + 1), slice(left, right + 1)
        own = placed[triangles[offsets[index] : offsets[index + 1]]] - (left, top, 0)
        expected[index] = selection.tile_error(
            case.sum.heights[window].astype(np.float64), case.sum.valid[window], own
        )
    found = begun.measured.host().astype(np.float64)
    # triangles of this pattern reach into holes
    stored = float(np.ptp(case.sum.heights.astype(np.float64)))
    allowed = np.where(found > expected, 1e-4 * stored, 16 * ulp(stored))
    yield _TILE_ERROR.met_by(found, expected, allowed)


TILE_ERROR: Final = Check(_tile_error, plain_grounds, hard_grounds)
