"""Checks of the kernels that make triangles of a heightmap, and of those that ask the ground."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from ..device.device import Device
from ..device.layout import FIXED_ONE
from ..errors import InputError
from ..ground.heightmap import Heightmap
from ..mesh.hits import checked_rays
from ..reference.terrain import analysis, domain, holes, hull, queries, sky
from ..reference.terrain.lod import Formula
from ..terrain.analysis import PLANES, analyse_on_device
from ..terrain.control_points import patches_on_device
from ..terrain.domain import displace_on_device
from ..terrain.holes import without_holes_on_device
from ..terrain.hull import EDGE_RULES, hull_on_device
from ..terrain.lod import Lod
from ..terrain.lod_formulas import (
    BookCoplanarityLod,
    CoplanarityLod,
    DistanceLod,
    ScreenAreaLod,
    UniformLod,
)
from ..terrain.lod_promises import MaxErrorLod
from ..terrain.queries import heights_on_device, rays_on_device
from ..terrain.sky import sky_seen
from ..terrain.terrain import Terrain
from ..tessellation.tessellator import tessellate_device
from .check import Array, Bound, Check, Difference, ulp
from .grounds import (
    Ground,
    View,
    hard_grounds,
    hard_views,
    plain_grounds,
    plain_views,
    planes_and_details,
    steep_grounds,
    wide_tiles,
)
from .tessellation import points_alone

_LODS: Final[tuple[Lod, ...]] = (
    UniformLod(5.5),
    DistanceLod(falloff=2.5),
    DistanceLod(near=100, far=3000, maximum=63),
    CoplanarityLod(),
    CoplanarityLod(pixels=100.0, minimum=2.0, maximum=40.0),
    BookCoplanarityLod(),
    BookCoplanarityLod(full_deviation=30.0, flat_weight=0.0, minimum=2.0),
    ScreenAreaLod(),
    ScreenAreaLod(pixels=25.0, minimum=1.5, maximum=40.0),
)

_DEVIATION: Final = Bound(
    "deviation",
    "m",
    "1e-5 of it, or 4 ulp of the tile's height range",
    "residuals are differences to a height of the tile, rounded once, and to a plane; a sum of up "
    "to 4,096 squares, eight lanes wide, loses 1e-5 at the most",
)
_HEIGHT: Final = Bound(
    "plane height",
    "m",
    "2e-6 of the tile's farthest height from 0, or 4 ulp of its height range",
    "a mean of differences to a height of the tile, added to that height: 16 roundings of it",
)
_PLANE: Final = Bound(
    "plane normal", "of length 1", "1e-5", "slopes of sums as above; a normal is as good as they"
)
_EXTREMES: Final = Bound(
    "extremes of a tile", "m", "exact", "they are samples, and whole numbers of them"
)


def _analysis(case: Ground, device: Device) -> Iterator[Difference]:
    for plane in PLANES:
        found = analyse_on_device(case.upload(device), plane=plane)
        planes, details = (each.host().reshape(-1, 4) for each in (found.planes, found.details))
        fits = analysis.analyse(case.sum, tile=case.grid.tile, plane=plane)
        expected_planes, expected = planes_and_details(fits)
        deviation, height, few = expected[:, 0], expected_planes[:, 3], 4 * ulp(case.ranges)
        farthest = np.abs(expected[:, 1:3]).max(axis=1)
        yield _DEVIATION.met_by(details[:, 0], deviation, np.fmax(few, 1e-5 * deviation))
        yield _HEIGHT.met_by(planes[:, 3], height, np.fmax(few, 2e-6 * farthest))
        yield _PLANE.met_by(planes[:, :3], expected_planes[:, :3], 1e-5)
        yield _EXTREMES.met_by(details[:, 1:], expected[:, 1:])


def _grounds_and_wide_tiles() -> dict[str, Ground]:
    return steep_grounds() | wide_tiles()


ANALYSIS: Final = Check(_analysis, plain_grounds, _grounds_and_wide_tiles)

_CORNERS: Final = Bound(
    "control point", "m", "1 ulp of the largest coordinate", "x and y are one product each"
)


def _control_points(case: Ground, device: Device) -> Iterator[Difference]:
    tiles = case.tiles(device)
    found = patches_on_device(tiles.ground, tiles.analysis)
    expected = hull.control_points(case.sum, case.grid, case.lowest)
    yield _CORNERS.met_by(found.control_points.host()[..., :3], expected, ulp(case.largest))


CONTROL_POINTS: Final = Check(_control_points, plain_grounds, hard_grounds)

_SKY: Final = Bound(
    "sky",
    "of all of it",
    "2e-6",
    "a slope has three roundings and its square counts twice, 1 / (1 + t t) never grows them: 8 "
    "of 6e-8, and as many for a mean of 12",
)


def _sky(case: Ground, device: Device) -> Iterator[Difference]:
    yield _SKY.met_by(sky_seen(case.sum, device), sky.sky_seen(case.sum), 2e-6)


SKY: Final = Check(_sky, plain_grounds, hard_grounds)

_FACTORS: Final = Bound(
    "factors",
    "segments",
    "1e-4",
    "a dozen roundings of numbers up to 63, each 4e-6, and the distance to an eye behind them",
)


def _hull(case: View, device: Device) -> Iterator[Difference]:
    for lod in _LODS:
        yield from _factors(case, device, lod)


def _factors(
    case: View, device: Device, lod: Lod, formula: Formula | None = None
) -> Iterator[Difference]:
    ground, camera, tiles = case.ground, case.camera, case.ground.tiles(device)
    for edge_rule in EDGE_RULES:
        found = hull_on_device(tiles, lod, camera, edge_rule=edge_rule)
        edge, inside = hull.factors(
            ground.sum,
            ground.grid,
            ground.fits,
            lod,
            tiles.scene,
            np.subtract(camera.eye, ground.origin),
            camera.planes(ground.origin),
            edge_rule=edge_rule,
            camera=camera,
            formula=formula,
        )
        yield _FACTORS.met_by(found.edge.host(), edge, 1e-4)
        yield _FACTORS.met_by(found.inside.host(), inside, 1e-4)


HULL: Final = Check(_hull, plain_views, hard_views)


def check_lod(
    lod: Lod, reference: Formula | None = None, *, device: Device | None = None
) -> Difference:
    """Compare what a level of detail's header computes with its reference, on rough ground.

    Parameters
    ----------
    lod : Lod
    reference : callable, optional
        ``(patch, parameters) -> segments`` in float64: see
        :class:`terrain_lod.reference.terrain.lod.Patch`. Default: that of a header of ``kernels/``.
    device : Device, optional

    Returns
    -------
    Difference
        Of a factor, in segments, where it is most of what rounding allows.

    Raises
    ------
    InputError
        If `lod` has no header.
    """
    if not isinstance(lod, Lod):
        raise InputError(f"expected a level of detail with a header, got {lod!r}")

    def compare(case: View, device: Device) -> Iterator[Difference]:
        return _factors(case, device, lod, reference)

    return Check(compare, plain_views).worst(Device.of(device))


_POSITION: Final = Bound(
    "position",
    "m",
    "4 ulp of the largest coordinate",
    "x and y are rounded once, a bilinear height three times",
)
_NORMAL: Final = Bound(
    "normal",
    "of length 1",
    "1e-5",
    "differences of samples are exact where they are steep; smoothing, slope and length after them "
    "are two dozen roundings of numbers up to 1",
)
_SHIFT: Final = Bound(
    "shift by 1,000 km",
    "arrays",
    "no bit of the mesh",
    "kernels see coordinates relative to the ground's own origin",
)


def _domain(case: Ground, device: Device) -> Iterator[Difference]:
    grid, each = case.grid, 40
    random = np.random.default_rng(3)
    points = random.integers(0, FIXED_ONE + 1, (grid.count * each, 2)).astype(np.uint32)
    patch = np.repeat(np.arange(grid.count), each)
    pattern = points_alone(points, grid.count, device)
    found = displace_on_device(case.tiles(device).patch_set, pattern)
    positions, normals = domain.displace(case.sum, grid, points, patch)
    # a point in a cell without data has no height
    columns, rows = domain.global_coordinates(grid, points, patch)
    cells = np.pad(holes.cells_with_data(case.sum), (0, 1), mode="edge")
    known = cells[rows // FIXED_ONE, columns // FIXED_ONE]
    yield _POSITION.met_by(found.positions.host()[known], positions[known], 4 * ulp(case.largest))
    yield _NORMAL.met_by(found.normals.host()[known], normals[known], 1e-5)
    yield _shift(case, device)


def _shift(case: Ground, device: Device) -> Difference:
    ground, (x, y, base) = case.sum, case.origin
    heights = np.where(ground.valid, ground.heights, np.nan)
    moved = Heightmap(heights, spacing=ground.spacing, origin=(x + 1e6, y - 1e6), base=base)
    lod = MaxErrorLod(max(case.range / 100, 1e-30))
    here, there = (Terrain(each, device=device).mesh(lod=lod) for each in (ground, moved))
    names = ("vertices", "normals", "triangles")
    same = [np.array_equal(getattr(here, name), getattr(there, name)) for name in names]
    return _SHIFT.met_by(same.count(False), 0)


DOMAIN: Final = Check(_domain, plain_grounds, steep_grounds)

_KEPT: Final = Bound(
    "triangles beside holes", "triangles", "exact", "places are whole numbers of 2^-16 cells"
)
_USED: Final = Bound("points of these", "points", "exact", "the same")


def _holes(case: Ground, device: Device) -> Iterator[Difference]:
    # two triangles a cell between 6 x 6 points a tile
    edge, inside = (
        device.empty((case.grid.count, width), np.float32).fill(5.0) for width in (4, 2)
    )
    pattern = tessellate_device("quad", edge, inside, "fractional_odd", clockwise=False)
    points, triangles = pattern.points.host(), pattern.primitives.host()
    patch = np.repeat(np.arange(case.grid.count), np.diff(pattern.primitive_offsets.host()))
    found = without_holes_on_device(case.tiles(device).patch_set, pattern)
    expected = triangles[holes.kept(case.sum, case.grid, points, triangles, patch)]
    used_points, corners = holes.with_used_points(points, expected)
    yield _KEPT.met_by_rows(found.primitives.host(), corners)
    yield _USED.met_by_rows(found.points.host(), used_points)


def _holed(grounds: dict[str, Ground]) -> dict[str, Ground]:
    return {name: each for name, each in grounds.items() if each.sum.mask is not None}


HOLES: Final = Check(_holes, lambda: _holed(plain_grounds()), lambda: _holed(hard_grounds()))

_GROUND_HEIGHT: Final = Bound(
    "height of the ground",
    "m",
    "1e-9 of the height range, 1e-15 of the farthest from 0, and what places leave open",
    "64-bit floats: a place at 7,000 km is known to 1e-9 m, that is a share of a cell, and as much "
    "of the height range",
)
_GROUND_RAY: Final = Bound(
    "ray to the ground",
    "m",
    "1e-9 of the ground's diagonal",
    "the same, and roots of a quadratic where the ground is nearly along the ray",
)


def _queries(case: Ground, device: Device) -> Iterator[Difference]:
    tiles, (points, (origins, directions)) = case.tiles(device), asked_of(case)
    found = heights_on_device(tiles, points)
    of_cell = 2.0**-52 * np.abs(case.origin[:2]).max() / min(case.sum.spacing)
    allowed = (1e-9 + 2 * of_cell) * case.range + 1e-15 * case.highest
    yield _GROUND_HEIGHT.met_by(found, queries.heights(case.sum, points), allowed)
    hits = rays_on_device(tiles, origins, directions)
    expected = queries.distances(case.sum, origins, directions)
    diagonal = float(np.linalg.norm([*case.sum.extent, case.range]))
    yield _GROUND_RAY.met_by(hits.distance, expected, 1e-9 * diagonal)


def asked_of(case: Ground) -> tuple[Array, tuple[Array, Array]]:
    """Return points on and beside the ground, and rays from above and below it."""
    random, count = np.random.default_rng(8), 150
    size = np.array([*case.sum.extent, max(case.range, 1.0)])
    low = case.sum.height_range[0]
    shares = random.uniform((-0.1, -0.1, -1.0), (1.1, 1.1, 4.0), (count, 3))
    # every third on a sample
    cells = np.array(case.sum.shape[::-1]) - 1
    shares[::3, :2] = np.rint(shares[::3, :2] * cells) / cells
    places = shares * size * (1, -1, 1) + (*case.sum.origin, low)
    # as steep as the ground is
    return places[:, :2], checked_rays(places, random.normal(size=(count, 3)) * size)


QUERIES: Final = Check(_queries, plain_grounds, hard_grounds)
