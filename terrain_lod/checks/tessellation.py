"""Checks of the kernels that make patterns of factors; all of them are exact."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Final

import numpy as np

from ..device.device import Device
from ..device.layout import FIXED_ONE, PARTITIONINGS
from ..reference.tessellation import semi_uniform as semi_uniform_reference
from ..reference.tessellation import tessellator as reference
from ..tessellation.factors import DOMAINS
from ..tessellation.pattern import DevicePattern
from ..tessellation.queues import queues_of
from ..tessellation.semi_uniform import SNAPS, semi_uniform
from ..tessellation.tessellator import tessellate
from .check import Array, Bound, Check, Difference

_POINTS: Final = Bound(
    "points of a pattern", "points", "exact", "places are whole numbers of 2^-16, in one order"
)
_PRIMITIVES: Final = Bound("primitives of a pattern", "primitives", "exact", "whole numbers")

# every rounding has its other side here
_AWKWARD: Final = np.array(
    [-np.inf, -1, 0, 1e-7, 0.5, 100, 1e30, np.inf, np.nan]
    + [
        near + step
        for near in (1, 2, 3, 4, 15, 16, 63, 64)
        for step in (-(2**-16), -1e-7, 0, 1e-7, 2**-16)
    ]
)


def points_alone(points: Array, patches: int, device: Device) -> DevicePattern:
    """Return a pattern of (N, 2) `points`, as many in each patch, without triangles."""
    none, each = device.zeros((0, 3), np.int32), len(points) // patches
    offsets = np.arange(0, len(points) + 1, each, dtype=np.uint32)
    return DevicePattern(device.array(points.astype(np.uint32)), none, device.array(offsets), none)


@dataclass(frozen=True)
class Kind:
    """A domain, a partitioning, and where factors come from."""

    domain: str
    partitioning: str
    awkward: bool

    def factors(self, patches: int) -> tuple[Array, Array | None]:
        shape, random = DOMAINS[self.domain], np.random.default_rng(5)
        edges, insides = (
            random.choice(_AWKWARD, (patches, width))
            if self.awkward
            else random.uniform(0.5, 20, (patches, width))
            for width in (shape.edges, shape.insides)
        )
        return edges, insides if shape.insides else None


def _kinds(*, awkward: bool) -> dict[str, Kind]:
    word = "awkward " if awkward else ""
    return {
        f"{word}{domain}, {partitioning}": Kind(domain, partitioning, awkward)
        for domain, partitioning in product(DOMAINS, PARTITIONINGS)
    }


def _tessellator(case: Kind, device: Device) -> Iterator[Difference]:
    factors = case.factors(12)
    found = tessellate(case.domain, *factors, partitioning=case.partitioning, device=device)
    expected = reference.tessellate(case.domain, *factors, partitioning=case.partitioning)
    yield _POINTS.met_by_rows(found.points, expected.points)
    primitives = (reference.sorted_primitives(each.primitives) for each in (found, expected))
    yield _PRIMITIVES.met_by_rows(*primitives)


TESSELLATOR: Final = Check(
    _tessellator, lambda: _kinds(awkward=False), lambda: _kinds(awkward=True)
)

_MEMBERS: Final = Bound("members of a queue", "patches", "exact", "whole numbers, in one order")


def _queues(count: int, device: Device) -> Iterator[Difference]:
    keys = np.random.default_rng(count).integers(-1, 5, count).astype(np.int32)
    found = queues_of(device.array(keys), 5)
    expected = [np.flatnonzero(keys == key) for key in range(5)]
    yield _MEMBERS.met_by_rows(found.members.host()[: found.begins[-1]], np.concatenate(expected))
    yield _MEMBERS.met_by(found.begins[1:], np.cumsum([len(each) for each in expected]))


QUEUES: Final = Check(
    _queues,
    lambda: {"3001 patches": 3001},
    lambda: {f"{count} patches": count for count in (1, 3, 4095, 10_001)},
)

_TRIANGLES: Final = Bound(
    "semi-uniform triangles", "triangles", "exact", "places are whole numbers of 2^-16"
)


def _snapped_quads(levels: list[tuple[int, int, int, int]], device: Device) -> Iterator[Difference]:
    for snap in SNAPS:
        pattern = semi_uniform(levels, maximum=int(np.max(levels)), snap=snap, device=device)
        offsets = pattern.triangle_offsets
        triangles = pattern.points[pattern.triangles].astype(np.int64)
        for patch, own in enumerate(levels):
            expected = semi_uniform_reference.snapped_quad(own, snap=snap)
            yield _TRIANGLES.met_by_rows(
                _in_order(triangles[offsets[patch] : offsets[patch + 1]]),
                _in_order([[[int(x * FIXED_ONE) for x in at] for at in t] for t in expected]),
            )


def _semi_uniform(levels: list[tuple[int, int, int]], device: Device) -> Iterator[Difference]:
    for keep in (True, False):
        pattern = semi_uniform(
            levels, maximum=int(np.max(levels)), keep_degenerate=keep, device=device
        )
        offsets = pattern.triangle_offsets
        triangles = pattern.points[pattern.triangles].astype(np.int64)
        for patch, own in enumerate(levels):
            expected = semi_uniform_reference.semi_uniform(own, keep_degenerate=keep)
            yield _TRIANGLES.met_by_rows(
                _in_order(triangles[offsets[patch] : offsets[patch + 1]]),
                _in_order(
                    [[[int(x * FIXED_ONE) for x in corner[:2]] for corner in t] for t in expected]
                ),
            )


def _in_order(triangles: Array | list[list[list[int]]]) -> Array:
    """Return triangles that begin at their least corner and ascend, winding kept; (T, 6)."""
    corners = np.asarray(triangles).reshape(-1, 3, 2).tolist()
    turned = sorted(min(each[k:] + each[:k] for k in range(3)) for each in corners)
    return np.array(turned).reshape(-1, 6)


SEMI_UNIFORM: Final = Check(
    _semi_uniform,
    lambda: {"a few levels": [(3, 1, 0), (2, 2, 2), (0, 0, 0), (0, 4, 3), (1, 0, 0)]},
    lambda: {
        "all levels up to 3": list(product(range(4), repeat=3)),
        "fine levels": [(5, 0, 3), (4, 5, 1), (2, 2, 5), (6, 1, 0)],
    },
)

SEMI_UNIFORM_QUADS: Final = Check(
    _snapped_quads,
    lambda: {"a few levels": [(3, 1, 0, 2), (2, 2, 2, 2), (0, 0, 0, 0), (0, 4, 3, 1)]},
    lambda: {"all levels up to 2": list(product(range(3), repeat=4)), "fine": [(5, 0, 3, 1)]},
)
