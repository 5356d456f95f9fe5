"""Checks of the kernels that answer questions about a surface."""

from __future__ import annotations

import numpy as np

from ..device.device import Device
from ..mesh.hits import checked_rays
from ..mesh.mesh import Mesh
from ..mesh.queries import MeshQueries
from ..reference.mesh import queries as queries_mesh
from ..reference.terrain import queries as queries_ground
from ..terrain.queries import heights_on_device, rays_on_device
from .checkup import Array, Check, largest_difference
from .promise import cases
from .terrain import METRES, Case

_COUNT = 150


def check_queries_ground(device: Device) -> Check:
    differences = []
    for case in cases():
        tiles = case.tiles(device)
        points, (origins, directions) = _asked(case)
        found = heights_on_device(tiles, points)
        differences.append(largest_difference(found, queries_ground.heights(case.ground, points)))
        hits = rays_on_device(tiles, origins, directions)
        expected = queries_ground.distances(case.ground, origins, directions)
        differences.append(largest_difference(hits.distance, expected))
    return Check(max(differences), METRES, "m")


def check_queries_mesh(device: Device) -> Check:
    case = cases()[0]
    random = np.random.default_rng(9)
    rows, columns = case.ground.shape
    # triangles of all sizes that cross each other
    corners = random.uniform((0, -rows, -400), (columns, 0, 100), (300, 3)) * (30, 20, 1)
    mesh = Mesh(
        corners.astype(np.float32),
        np.tile(np.array([0, 0, 1], np.float32), (len(corners), 1)),
        random.integers(0, len(corners), (200, 3)).astype(np.int32),
        origin=np.array(case.origin),
    )
    surface = MeshQueries(mesh, device=device)
    points, (origins, directions) = _asked(case)
    found = surface.height_at(points)
    differences = [largest_difference(found, queries_mesh.heights(mesh, points))]
    expected = queries_mesh.distances(mesh, origins, directions)
    differences.append(largest_difference(surface.cast(origins, directions).distance, expected))
    return Check(max(differences), METRES, "m")


def _asked(case: Case) -> tuple[Array, tuple[Array, Array]]:
    """Return points on and beside the ground, and rays from above and below it."""
    random = np.random.default_rng(8)
    width, depth = case.ground.extent
    low, high = case.ground.height_range
    places = random.uniform(-0.1, 1.1, (_COUNT, 2)) * (width, -depth) + case.ground.origin
    heights = random.uniform(low - 100, high + 300, (_COUNT, 1))
    return places, checked_rays(np.hstack([places, heights]), random.normal(size=(_COUNT, 3)))
