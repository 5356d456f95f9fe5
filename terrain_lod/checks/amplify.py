"""The doctor's check of the ways to amplify."""

from __future__ import annotations

from functools import cache
from typing import Final

import numpy as np

from ..curved.adjacency import Adjacency
from ..curved.amplify import WAYS, amplify
from ..device.device import Device
from ..mesh.mesh import Mesh
from ..reference.curved import amplify as reference
from .checkup import Check, largest_difference

_LEVEL: Final = 7
_POSITIONS: Final = 4e-6  # of coordinates up to 8
_NORMALS: Final = 2e-5


@cache
def _tent() -> Mesh:
    """Return an open fan of six triangles with normals that lean in all directions."""
    angle = np.arange(6) * np.pi / 3
    rim = np.stack([np.cos(angle), np.sin(angle), 0.2 * np.sin(2 * angle)], axis=1)
    vertices = np.concatenate([[(0, 0, 1)], rim]).astype(np.float32)
    normals = vertices + np.float32(0.3) * np.roll(vertices, 1, axis=0)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    around = np.arange(6)
    triangles = np.stack([np.zeros(6), 1 + around, 1 + (around + 1) % 6], axis=1)
    return Mesh(vertices, normals, triangles.astype(np.int32))


def check_amplify(device: Device) -> Check:
    """Return the worst difference of a corner's position or normal over all ways."""
    mesh, turn = _tent(), np.array([[0.0, -1, 0, 5], [1, 0, 0, -2], [0, 0, 1, 0.5]])
    wide = mesh.vertices.astype(np.float64), mesh.normals.astype(np.float64)
    positions, normals = reference.sub_triangles(Adjacency.of(mesh).patches, *wide, _LEVEL)
    positions, normals = positions @ turn[:, :3].T + turn[:, 3], normals @ turn[:, :3].T
    worst = 0.0
    for way in WAYS:
        found = amplify(mesh, _LEVEL, way=way, transforms=turn[None], device=device)
        worst = max(
            worst,
            largest_difference(found.vertices[found.triangles], positions) / _POSITIONS,
            largest_difference(found.normals[found.triangles], normals) / _NORMALS,
        )
    return Check(worst, 1.0, "of the tolerance")
