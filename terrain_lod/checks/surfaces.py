"""The doctor's checks of the kernels that make patterns and surfaces without ground."""

from __future__ import annotations

from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..curved.bezier import bezier
from ..curved.curves import CURVES, curve
from ..curved.surfaces import SURFACES, surface
from ..device.device import Device
from ..device.layout import FIXED_ONE
from ..reference.curved import bezier as bezier_reference
from ..reference.curved import surfaces as surfaces_reference
from ..reference.tessellation import semi_uniform as semi_uniform_reference
from ..tessellation.queues import queues_of
from ..tessellation.semi_uniform import semi_uniform
from ..tessellation.tessellator import tessellate
from .checkup import Check, largest_difference, unequal_rows

# of lengths near ten, and of normals beside collapsed edges
_LENGTH: Final = 2e-4


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
    return Check(max(differences), _LENGTH, "units")


def check_surface(device: Device) -> Check:
    differences = []
    factors = (np.full((1, width), 9.5) for width in (4, 2))
    u, v = tessellate("quad", *factors, device=device).points.T / FIXED_ONE
    for name, row in SURFACES.items():
        numbers = {key: number.default for key, number in row.numbers.items()}
        found = surface(name, patches=(1, 1), factor=9.5, device=device)
        positions, normals = surfaces_reference.surface(name, u, v, numbers)
        # differences of positions say nothing at poles and where a power leaves an edge
        smooth = ~np.isnan(normals).any(axis=1) & (name != "superquadric")
        differences.append(largest_difference(found.vertices, positions))
        differences.append(largest_difference(found.normals[smooth], normals[smooth]))
    return Check(max(differences), _LENGTH, "units")


def check_curve(device: Device) -> Check:
    differences = []
    t = tessellate("isoline", [[1, 40]], partitioning="integer", device=device).points[:, 0]
    for name, row in CURVES.items():
        numbers = {key: number.default for key, number in row.numbers.items()}
        found = curve(name, pieces=1, factor=40, partitioning="integer", device=device)
        positions, tangents = surfaces_reference.curve(name, t / FIXED_ONE, numbers)
        differences.append(largest_difference(found.points, positions))
        differences.append(largest_difference(found.tangents, tangents))
    return Check(max(differences), _LENGTH, "units")
