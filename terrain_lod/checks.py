"""One check a kernel: what the device computes against the float64 reference, on small ground.

A check uploads what its kernel reads, so that another kernel's fault is not taken for its own, and
returns the worst difference. A new kernel's check is one function and one row of :data:`CHECKS`.
"""

from __future__ import annotations

from functools import cache
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from .analysis import PLANES, analyse_on_device
from .buffers import DeviceAnalysis, DeviceGround
from .camera import Camera
from .checkup import Check, Checks
from .device import Device
from .domain import displace_on_device
from .error import vertical_error
from .grid import TileGrid
from .heightmap import Heightmap
from .hull import EDGE_RULES, hull_on_device, patches_on_device
from .layout import DEFAULT_TILE, FIXED_ONE
from .lod import CoplanarityLod, DistanceLod, Lod, Scene, UniformLod
from .mesh import Mesh
from .pattern import DevicePattern
from .reference import analysis, domain, error, hull, scan
from .scan import exclusive_scan

Array = npt.NDArray[Any]

# two roundings of coordinates of thousands of metres, and of factors up to 63
_METRES: Final = 1e-3
_SEGMENTS: Final = 1e-4

_LODS: Final[tuple[Lod, ...]] = (UniformLod(5.5), DistanceLod(falloff=2.5), CoplanarityLod())


@cache
def _ground() -> Heightmap:
    """Ground of 200 x 170 m heights with holes, far from its world's origin."""
    random = np.random.default_rng(1)
    heights = random.normal(size=(200, 170)).cumsum(axis=0).cumsum(axis=1)
    heights[random.random(heights.shape) < 0.01] = np.nan
    heights[:17, :17] = np.nan
    return Heightmap(heights, spacing=(30.0, 20.0), origin=(500_000.0, 4_000_000.0))


def _grid() -> TileGrid:
    return TileGrid.of(_ground(), DEFAULT_TILE)


def _scene() -> Scene:
    return Scene(diagonal=7000.0, rough_deviation=20.0)


@cache
def _fits() -> list[analysis.TileFit]:
    return analysis.analyse(_ground())


def _expected_analysis(fits: list[analysis.TileFit]) -> tuple[Array, Array]:
    """Return the analysis kernel's two outputs, (P, 4) each."""
    planes = [(*fit.normal, fit.height) for fit in fits]
    details = [(fit.deviation, fit.minimum, fit.maximum, fit.nodata) for fit in fits]
    return np.array(planes), np.array(details)


def _difference(found: Array, expected: Array) -> float:
    """Return the largest difference; infinite where only one of the two is NaN."""
    found = found.reshape(expected.shape).astype(np.float64)
    if (np.isnan(found) != np.isnan(expected)).any():
        return np.inf
    return float(np.nanmax(np.abs(found - expected), initial=0.0))


def _analysis(device: Device) -> Check:
    ground, worst = DeviceGround.upload(_ground(), device), 0.0
    # a normal's error tells in the height at the end of a tile
    reach = np.array([*[DEFAULT_TILE * max(_ground().spacing)] * 3, 1.0])
    for plane in PLANES:
        found = analyse_on_device(ground, _grid(), plane=plane)
        planes, details = _expected_analysis(analysis.analyse(_ground(), plane=plane))
        worst = max(
            worst,
            _difference(found.planes.host() * reach, (planes * reach).reshape(found.planes.shape)),
            _difference(found.details.host(), details),
        )
    return Check(worst, 1e-5 * float(np.ptp(_ground().height_range)), "m")


def _control_points(device: Device) -> Check:
    found = patches_on_device(DeviceGround.upload(_ground(), device), _grid(), fallback=-500.0)
    expected = hull.control_points(_ground(), _grid(), -500.0)
    return Check(_difference(found.control_points.host()[..., :3], expected), _METRES, "m")


def _hull(device: Device) -> Check:
    ground, grid, fits = _ground(), _grid(), _fits()
    x, y, z = ground.centre
    camera = Camera((x - 300, y - 400, z + 500), (x + 500, y + 700, z), far=5e4)
    origin = (*ground.origin, ground.base)
    planes, details = (
        device.array(values.astype(np.float32).reshape(*grid.shape, 4))
        for values in _expected_analysis(fits)
    )
    low = ground.height_range[0] - ground.base
    patches = patches_on_device(DeviceGround.upload(ground, device), grid, fallback=low)
    worst = 0.0
    for lod in _LODS:
        for edges in EDGE_RULES:
            found = hull_on_device(
                *(grid, patches, DeviceAnalysis(planes, details)),
                *(lod, _scene(), camera.view(origin)),
                edges=edges,
            )
            edge, inside = hull.factors(
                *(ground, grid, fits, lod, _scene()),
                *(np.subtract(camera.eye, origin), camera.planes(origin)),
                edges=edges,
            )
            worst = max(worst, _difference(found.edge.host(), edge))
            worst = max(worst, _difference(found.inside.host(), inside))
    return Check(worst, _SEGMENTS, "segments")


def _scan(device: Device) -> Check:
    counts = np.random.default_rng(2).integers(0, 1000, 20_001).astype(np.uint32)
    offsets, total = exclusive_scan(device.array(counts))
    expected = scan.exclusive_scan(counts)
    wrong = np.count_nonzero(offsets.host() != expected) + (total != expected[-1])
    return Check(float(wrong), 0.0, "offsets")


def _domain(device: Device) -> Check:
    ground, grid = _ground(), _grid()
    random, count = np.random.default_rng(3), 40
    points = random.integers(0, FIXED_ONE + 1, (grid.count * count, 2)).astype(np.uint32)
    offsets = np.arange(0, len(points) + 1, count, dtype=np.uint32)
    none = device.zeros((0, 3), np.int32)
    pattern = DevicePattern(device.array(points), none, device.array(offsets), none)
    found = displace_on_device(DeviceGround.upload(ground, device), grid, pattern)
    patch = np.repeat(np.arange(grid.count), count)
    positions, normals = domain.displace(ground, grid, points, patch)
    # a point beside a hole has no height
    columns, rows = domain.global_coordinates(grid, points, patch)
    valid = np.pad(ground.valid, (0, 1), mode="edge")
    cells = valid[:-1, :-1] & valid[:-1, 1:] & valid[1:, :-1] & valid[1:, 1:]
    known = cells[rows // FIXED_ONE, columns // FIXED_ONE]
    return Check(
        max(
            _difference(found.positions.host()[known], positions[known]),
            _difference(found.normals.host()[known], normals[known]),
        ),
        _METRES,
        "m",
    )


def _vertical_error(device: Device) -> Check:
    ground = _ground()
    rows, columns = ground.shape
    random = np.random.default_rng(4)
    corners = random.uniform((0, -rows, -400), (columns, 0, 100), (300, 3)) * (30, 20, 1)
    triangles = random.integers(0, len(corners), (200, 3)).astype(np.int32)
    mesh = Mesh(
        corners.astype(np.float32),
        np.tile(np.array([0, 0, 1], np.float32), (len(corners), 1)),
        triangles,
        origin=np.array([*ground.origin, ground.base]),
    )
    found = vertical_error(mesh, ground, field=True, device=device).field
    assert found is not None
    return Check(_difference(found, error.error_field(mesh, ground)), _METRES, "m")


CHECKS: Final[Checks] = {
    "analysis": _analysis,
    "control_points": _control_points,
    "hull": _hull,
    "scan": _scan,
    "domain": _domain,
    "vertical_error": _vertical_error,
}
