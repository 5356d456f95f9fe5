"""A closed mesh whose surface is known: a ring with a wavy girth."""

from __future__ import annotations

import numpy as np

from terrain_lod.mesh.mesh import Mesh


def wavy_torus(columns: int, rows: int, waves: int = 7) -> Mesh:
    """Return a smooth ring, with the normals of a plain one."""
    u, v = np.meshgrid(
        np.linspace(0, 2 * np.pi, columns, endpoint=False),
        np.linspace(0, 2 * np.pi, rows, endpoint=False),
    )
    across = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=-1)
    ring = np.stack([np.cos(u), np.sin(u), np.zeros_like(u)], axis=-1)
    vertices = 3 * ring + (1 + 0.1 * np.sin(waves * u))[..., None] * across
    index = np.arange(u.size).reshape(u.shape)
    right, below = np.roll(index, -1, axis=1), np.roll(index, -1, axis=0)
    corner = np.roll(right, -1, axis=0)
    cells = np.stack([index, right, corner, index, corner, below], axis=-1)
    return Mesh(vertices.reshape(-1, 3), across.reshape(-1, 3), cells.reshape(-1, 3))
