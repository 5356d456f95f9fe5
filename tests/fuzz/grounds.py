"""Odd ground, every level of detail: a good mesh that keeps its promise, measured from outside."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import numpy as np

from fuzz.kind import require
from fuzz.rasters import require_ground
from terrain_lod.camera.camera import Camera
from terrain_lod.camera.viewpoint import default_camera
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.measure.cracks import crack_report
from terrain_lod.measure.error import vertical_error
from terrain_lod.measure.screen_error import screen_error
from terrain_lod.mesh.mesh import Mesh
from terrain_lod.terrain.lod import AnyLod
from terrain_lod.terrain.lod_formulas import (
    CoplanarityLod,
    DistanceLod,
    ScreenAreaLod,
    UniformLod,
)
from terrain_lod.terrain.lod_promises import BudgetLod, MaxErrorLod, ScreenErrorLod
from terrain_lod.terrain.terrain import Terrain

_SHAPES: Final = ((2, 2), (2, 40), (50, 2), (3, 17), (16, 16), (17, 33), (47, 40))
_PARTITIONINGS: Final = ("fractional_odd", "fractional_even", "integer", "pow2")

Array = np.ndarray

_FORMS: Final[tuple[Callable[[Array, Array, np.random.Generator], Array], ...]] = (
    lambda row, column, rng: rng.normal(size=row.shape).cumsum(axis=0).cumsum(axis=1),
    lambda row, column, rng: rng.normal(size=row.shape),
    lambda row, column, rng: 3.0 * column - row,
    lambda row, column, rng: np.zeros(row.shape),
    lambda row, column, rng: np.ones(row.shape),
    lambda row, column, rng: (row + column) % 2 * 1.0,
    lambda row, column, rng: np.where(column > row, 1.0, 0.0),
    lambda row, column, rng: (rng.random(row.shape) < 0.02) * 1.0,
)


def trial(chance: random.Random, folder: Path) -> None:
    ground = _ground(chance)
    require_ground(ground)
    terrain = Terrain(
        ground,
        tile=chance.choice((15, 15, 15, 16, 5)),
        levels=chance.choice((None, None, 1, 2)),
        plane=chance.choice(("least_squares", "corners")),
    )
    camera = _camera(ground, chance)
    lod = _lod(ground, chance)
    partitioning = chance.choice(_PARTITIONINGS)
    seen = camera if lod.needs_camera or chance.random() < 0.3 else None
    mesh = terrain.mesh(seen, lod=lod, partitioning=partitioning, cull=chance.random() < 0.5)
    _require_sound(mesh, ground)
    _require_kept(mesh, ground, lod, camera)


def _ground(chance: random.Random) -> Heightmap:
    rows, columns = chance.choice(_SHAPES)
    rng = np.random.default_rng(chance.getrandbits(32))
    row, column = np.mgrid[:rows, :columns].astype(np.float64)
    heights = chance.choice(_FORMS)(row, column, rng)
    heights = heights / max(abs(heights).max(), 1.0)
    size = 10.0 ** chance.choice((0, 2, 2, chance.uniform(-45, 38.5), 38.4, -44))
    heights = heights * size + chance.choice((0, 0, size, 1e4, 1e7, -3e38))
    _make_holes(heights, chance, rng)
    if chance.random() < 0.05:
        heights[chance.randrange(rows), chance.randrange(columns)] = chance.choice(
            (np.inf, -np.inf, 1e300)
        )
    spacing: Any = 10.0 ** chance.choice((0, 1.5, chance.uniform(-19, 19)))
    if chance.random() < 0.4:
        spacing = spacing, spacing * 10.0 ** chance.uniform(-9, 9)
    origin = chance.choice(((0, 0), (5e5, 4e6), (-1e7, 2e7)))
    dtype = chance.choice((np.float64, np.float64, np.float32))
    with np.errstate(over="ignore"):
        heights = heights.astype(dtype)
    return Heightmap(heights, spacing=spacing, origin=origin)


def _make_holes(heights: Array, chance: random.Random, rng: np.random.Generator) -> None:
    match chance.randrange(9):
        case 0:
            heights[rng.random(heights.shape) < 0.02] = np.nan
        case 1:
            heights[rng.random(heights.shape) < 0.7] = np.nan
        case 2:
            heights[chance.randrange(len(heights))] = np.nan
        case 3:
            heights[:16, :16] = np.nan
        case 4 if chance.random() < 0.2:
            heights[:] = np.nan


def _camera(ground: Heightmap, chance: random.Random) -> Camera:
    if chance.random() < 0.5:
        return default_camera(ground, size=(640, 360))
    x, y, z = ground.centre
    reach = math.hypot(*ground.extent) * 10.0 ** chance.uniform(-2, 2)
    angle, lift = chance.uniform(0, 7), chance.uniform(-1, 3)
    eye = x + reach * math.cos(angle), y + reach * math.sin(angle), z + reach * lift
    height = chance.choice((None, None, reach))
    return Camera(eye, (x, y, z), size=(640, 360), near=1e-3 * reach, height=height)


def _lod(ground: Heightmap, chance: random.Random) -> AnyLod:
    low, high = ground.height_range
    part = 10.0 ** chance.uniform(-5, 0)
    return chance.choice(
        (
            lambda: UniformLod(chance.choice((1, 2, 3.5, 15))),
            DistanceLod,
            CoplanarityLod,
            ScreenAreaLod,
            lambda: MaxErrorLod(max((high - low) * part, 1e-44)),
            lambda: MaxErrorLod(max((high - low) * part, 1e-44)),
            lambda: ScreenErrorLod(10.0 ** chance.uniform(-1, 2)),
            lambda: ScreenErrorLod(10.0 ** chance.uniform(-1, 2)),
            lambda: BudgetLod(chance.choice((2, 50, 1000))),
        )
    )()


def _require_sound(mesh: Mesh, ground: Heightmap) -> None:
    require(bool(np.isfinite(mesh.vertices).all()), "vertices that are not finite")
    require(bool(np.isfinite(mesh.normals).all()), "normals that are not finite")
    lengths = np.linalg.norm(mesh.normals.astype(np.float64), axis=1)
    require(bool((abs(lengths - 1) < 1e-4).all()), "normals that are no unit vectors")
    if len(mesh.vertices):
        low, high = (height - ground.base for height in ground.height_range)
        slack = 4 * _ulp(ground)
        z = mesh.vertices[:, 2].astype(np.float64)
        require(z.min() >= low - slack, "vertices below the ground")
        require(z.max() <= high + slack, "vertices above the ground")
        require(len(np.unique(mesh.triangles)) == len(mesh.vertices), "vertices of no triangle")
    report = crack_report(mesh)
    require(not report, f"not watertight: {report}")


def _require_kept(mesh: Mesh, ground: Heightmap, lod: AnyLod, camera: Camera) -> None:
    """Measure what was promised, or else what the mesh says that it has become."""
    if isinstance(lod, BudgetLod):
        require(len(mesh.triangles) <= lod.triangles, f"{len(mesh.triangles)} for {lod}")
    if mesh.achieved is None or not len(mesh.triangles):
        return
    kept, metres, pixels = mesh.achieved.kept, mesh.achieved.metres, mesh.achieved.pixels
    if isinstance(lod, MaxErrorLod):
        found = vertical_error(mesh, ground).maximum
        allowed = (lod.metres if kept else metres or 0.0) + 4 * _ulp(ground)
        require(not found > allowed, f"{lod} became {found:g}, {mesh.achieved}")
    if isinstance(lod, ScreenErrorLod):
        found = screen_error(mesh, ground, camera).maximum
        allowed = (lod.pixels if kept else pixels or 0.0) * 1.001 + 1e-3
        require(not found > allowed, f"{lod} became {found:g}, {mesh.achieved}")


def _ulp(ground: Heightmap) -> float:
    return float(np.spacing(np.float32(abs(ground.heights[ground.valid]).max())))
