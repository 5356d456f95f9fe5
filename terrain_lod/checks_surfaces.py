"""The doctor's checks of the kernels that make patterns and surfaces without ground."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from .bezier import bezier
from .checkup import Check, largest_difference, unequal_rows
from .device import Device
from .layout import FIXED_ONE
from .queues import queues_of
from .reference import bezier as bezier_reference
from .reference import semi_uniform as semi_uniform_reference
from .semi_uniform import semi_uniform
from .tessellator import tessellate


def check_queues(device: Device) -> Check:
    keys = np.random.default_rng(6).integers(-1, 5, 3001).astype(np.int32)
    found = queues_of(device.array(keys), 5)
    expected = np.concatenate([np.flatnonzero(keys == key) for key in range(5)])
    wrong = unequal_rows(found.members.host()[: found.begins[-1]], expected)
    ends = np.cumsum([np.count_nonzero(keys == key) for key in range(5)])
    return Check(wrong + unequal_rows(found.begins[1:], ends), 0.0, "patches")


def check_semi_uniform(device: Device) -> Check:
    levels, wrong = [(3, 1, 0), (2, 2, 2), (0, 0, 0), (0, 4, 3), (1, 0, 0)], 0.0
    for keep in (True, False):
        pattern = semi_uniform(levels, keep_degenerate=keep, device=device)
        found = pattern.points[pattern.triangles].reshape(-1, 6)
        patches = [semi_uniform_reference.semi_uniform(own, keep_degenerate=keep) for own in levels]
        expected = [
            [int(x * FIXED_ONE) for corner in triangle for x in corner[:2]]
            for patch in patches
            for triangle in patch
        ]
        wrong += unequal_rows(_sorted(found), _sorted(np.array(expected)))
    return Check(wrong, 0.0, "triangles")


def _sorted(rows: npt.NDArray[Any]) -> npt.NDArray[np.int64]:
    return rows[np.lexsort(rows.T)].astype(np.int64)


def check_bezier(device: Device) -> Check:
    nets = np.random.default_rng(7).normal(size=(6, 4, 4, 3)).astype(np.float32)
    nets[..., 0] += np.arange(0, 40, 10)[:, None]
    nets[..., 1] += np.arange(0, 40, 10)
    nets[0, :, 0] = nets[0, 0, 0]  # an edge in one point
    found = bezier(nets, factor=6.3, device=device)
    factors = (np.full((len(nets), width), 6.3) for width in (4, 2))
    pattern = tessellate("quad", *factors, device=device)
    patch = np.repeat(np.arange(len(nets)), np.diff(pattern.point_offsets))
    u, v = pattern.points.T / FIXED_ONE
    positions, normals = bezier_reference.bezier(nets[patch].astype(np.float64), u, v)
    differences = (
        largest_difference(found.vertices, positions),
        largest_difference(found.normals, normals),
    )
    return Check(max(differences), 2e-4, "units")
