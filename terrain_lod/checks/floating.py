"""The check of the kernels that let vertices float within an error."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from ..device.device import Device
from ..device.layout import FIXED_ONE
from ..reference.terrain import domain, floating
from ..terrain.floating import fit_heights
from ..tessellation.tessellator import tessellate_device
from .check import Array, Bound, Check, Difference, ulp
from .grounds import Ground, hard_grounds, plain_grounds

_PASSES: Final = 12

_STEP: Final = Bound(
    "heights after a pass",
    "m",
    "1e-2 of the error allowed, and 64 ulp of the height range",
    "sums are counted in 1/8192 of the error, a triangle at a time, beside an inertia of a quarter "
    "of a sample; a sample that exceeds by less than its rounding may count or not",
)
_SHARED: Final = Bound("heights of points at one place", "m", "exact", "they are one vertex")
_FITTED: Final = Bound(
    "sum of squares after 12 passes",
    "squares of the error allowed",
    "a fiftieth of it, and 1e-2 a patch",
    "momentum ends by a sign, so that vertices may go other ways to the same minimum",
)


def _fit(case: Ground, device: Device) -> Iterator[Difference]:
    grid, tiles = case.grid, case.tiles(device)
    random, segments = np.random.default_rng(3), max(grid.tile // 2, 1)
    # edges that match, so that tiles share their vertices
    edge = np.full((grid.count, 4), segments, np.float32)
    inside = random.integers(1, grid.tile + 1, (grid.count, 2)).astype(np.float32)
    pattern = tessellate_device(
        "quad", device.array(edge), device.array(inside), "integer", clockwise=False
    )
    allowed = (max(case.range, 1e-3) * random.uniform(0.03, 0.1, grid.count)).astype(np.float32)
    points, triangles = pattern.points.host(), pattern.primitives.host()
    patch = np.repeat(np.arange(grid.count), np.diff(pattern.point_offsets.host()))
    columns, rows = domain.global_coordinates(grid, points, patch)
    ground = domain.displace(case.sum, grid, points, patch)[0][:, 2]
    vertices = floating.welded(columns, rows)
    finest = np.full(vertices.max() + 1, np.inf)
    np.minimum.at(finest, vertices, allowed[patch].astype(np.float64))
    samples = floating.samples_of(
        case.sum.heights.astype(np.float64),
        case.sum.valid,
        np.stack([columns, rows], axis=1) / FIXED_ONE,
        triangles,
        allowed[patch[triangles[:, 0]]].astype(np.float64),
        vertices,
    )
    _, first = np.unique(vertices, return_index=True)
    rounding = 64 * ulp(np.ptp(case.sum.heights.astype(np.float64)))

    def found(passes: int) -> Array:
        _, patches = fit_heights(tiles.patch_set, pattern, device.array(allowed), passes=passes)
        lifts: Array = patches.arguments["lifts"].host().astype(np.float64)
        return lifts

    one = found(1)
    yield _SHARED.met_by(one, one[first][vertices])
    expected = floating.fitted(samples, ground[first], finest, 1)
    yield _STEP.met_by(one[first] + ground[first], expected, 1e-2 * finest + rounding)
    several = found(_PASSES)[first] + ground[first]
    energy, least = (
        float(((floating.excesses(samples, heights) / samples.room) ** 2).sum())
        for heights in (several, floating.fitted(samples, ground[first], finest, _PASSES))
    )
    yield _FITTED.met_by(energy, least, 0.02 * least + 1e-2 * grid.count)


def _hard() -> dict[str, Ground]:
    """Leave out ground whose differences are no 32-bit floats, or too small to divide by."""
    left_out = ("near the end of float32", "denormals")
    return {name: case for name, case in hard_grounds().items() if name not in left_out}


FLOATING: Final = Check(_fit, plain_grounds, _hard)
