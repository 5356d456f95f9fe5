"""Check of the kernel that asks a mesh for heights and casts rays at it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from ..device.device import Device
from ..mesh.queries import MeshQueries
from ..reference.mesh import queries
from .check import Bound, Check, Difference
from .grounds import Ground, hard_grounds, plain_grounds
from .terrain import asked_of

_HEIGHT: Final = Bound(
    "height of a mesh",
    "m",
    "1e-9 of the height range, and 1e-14 of the farthest from 0",
    "64-bit floats; a triangle that is nearly upright loses digits of them",
)
_RAY: Final = Bound("ray to a mesh", "m", "1e-9 of the mesh's diagonal", "the same")


def _queries(case: Ground, device: Device) -> Iterator[Difference]:
    mesh = case.crossing_triangles(seed=9)
    asked = MeshQueries(mesh, device=device)
    points, (origins, directions) = asked_of(case)
    extent = np.ptp(mesh.vertices.astype(np.float64), axis=0)
    expected = queries.heights(mesh, points)
    allowed = 1e-9 * extent[2] + 1e-14 * case.highest
    yield _HEIGHT.met_by(asked.height_at(points), expected, allowed)
    expected = queries.distances(mesh, origins, directions)
    allowed = 1e-9 * float(np.linalg.norm(extent))
    yield _RAY.met_by(asked.cast(origins, directions).distance, expected, allowed)


QUERIES: Final = Check(_queries, plain_grounds, hard_grounds)
