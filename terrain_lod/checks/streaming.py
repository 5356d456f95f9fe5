"""Checks of the kernel that measures triangles of coarse levels."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from ..device.device import Device
from ..reference.streaming.between import triangle_error
from .check import Bound, Check, Difference, ulp
from .grounds import Ground, hard_grounds, plain_grounds

_TRIANGLES: Final = 60

_POINTS: Final = Bound(
    "difference at points",
    "m",
    "16 ulp of the height range below, 1e-4 of it above",
    "too much is safe, too little is not: a point beside a triangle may count as in it",
)
_SURFACE: Final = Bound(
    "difference from the surface",
    "m",
    "16 ulp of the height range below, half the largest twist and 1e-3 of the range above",
    "a bound: between crossings a parabola rises by a quarter of a cell's twist; the reference "
    "looks at eight places along a cell, and misses no more than that again",
)


def _between(case: Ground, device: Device) -> Iterator[Difference]:
    heights, known = case.sum.heights.astype(np.float64), case.sum.valid
    rows, columns = heights.shape
    random = np.random.default_rng(5)
    # of all sizes, everywhere, one corner on a sample
    middle = random.integers(0, [columns, rows], (_TRIANGLES, 1, 2))
    reach = 10.0 ** random.uniform(0, 1, (_TRIANGLES, 1, 1))
    places = middle + np.array([0, 1, 1])[:, None] * reach * random.uniform(-1, 1, (1, 3, 2))
    places = places.clip(0, [columns - 1, rows - 1]).astype(np.float32)
    points = np.zeros((3 * _TRIANGLES, 4), np.float32)
    points[:, :2] = places.reshape(-1, 2)
    stored = float(np.ptp(heights))
    points[:, 2] = random.uniform(heights.min(), heights.max(), len(points))
    triangles = np.arange(3 * _TRIANGLES, dtype=np.int32).reshape(-1, 3)
    ground = case.tiles(device).ground
    group = device.group_size(64)
    twist = heights[1:, 1:] - heights[1:, :-1] - heights[:-1, 1:] + heights[:-1, :-1]
    for is_full, bound in ((1, _POINTS), (0, _SURFACE)):
        errors = device.empty(_TRIANGLES, np.float32)
        device.kernel("streaming/between.cl", "between", GROUP=group, **ground.defines)(
            (_TRIANGLES,),
            (group,),
            **ground.arguments,
            is_full=is_full,
            count=_TRIANGLES,
            points=device.array(points),
            triangles=device.array(triangles),
            errors=errors,
        )
        found = errors.host().astype(np.float64)
        expected = np.array(
            [
                triangle_error(heights, known, corners[:, :3], is_full=bool(is_full))
                for corners in points.reshape(-1, 3, 4).astype(np.float64)
            ]
        )
        above = 1e-4 * stored if is_full else 1e-3 * stored + np.abs(twist).max() / 2
        yield bound.met_by(found, expected, np.where(found > expected, above, 16 * ulp(stored)))


def _high() -> dict[str, Ground]:
    """Leave out heights whose differences float32 cannot hold."""
    return {name: case for name, case in hard_grounds().items() if case.highest < 1e37}


BETWEEN: Final = Check(_between, plain_grounds, _high)
