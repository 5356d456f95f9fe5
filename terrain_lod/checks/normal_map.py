"""Check of the kernel that bakes normal maps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Final

import numpy as np

from ..device.device import Device
from ..mesh.bake import bake_normals
from ..mesh.mesh import Mesh
from ..reference.mesh.normal_map import normal_map
from .check import Array, Bound, Check, Difference

_SHAPE: Final = (24, 32)  # texels of maps that are compared
_SAYS: Final = Bound(
    "what texels say",
    "of length 1",
    "half a colour and 1e-6",
    "64-bit floats; where a texel's middle is on an edge, both sides blend to the same",
)


def _lattice(heights: Array, *, turned: bool = False) -> Mesh:
    """Return a square of the plane at heights (N, N), with normals; mirrored about its middle."""
    across = len(heights)
    ticks = np.linspace(0, 1, across)
    x, y = np.meshgrid(ticks, ticks)
    slope_y, slope_x = np.gradient(heights, ticks, ticks)
    normals = np.stack([-slope_x, -slope_y, np.ones_like(x)], axis=-1).reshape(-1, 3)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    row, column = (part.ravel() for part in np.mgrid[: across - 1, : across - 1])
    a = row * across + column
    triangles = np.concatenate(
        [np.stack([a, a + 1, a + across + 1], 1), np.stack([a, a + across + 1, a + across], 1)]
    )
    vertices = np.stack([x, y, heights], axis=-1).reshape(-1, 3)
    turn = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]]) if turned else np.eye(3)
    return Mesh(vertices @ turn.T, normals @ turn.T, triangles, origin=np.array([5e5, 4e6, 9.0]))


def _waves(count: int, height: float) -> Array:
    ticks = np.linspace(0, 7, count)
    waves: Array = height * np.sin(ticks) * np.cos(1.3 * ticks)[:, None]
    return waves


def _meshes(case: str) -> tuple[Mesh, Mesh, Array | None]:
    """Return a coarse mesh, a fine one, and the way from one to the other; None: its normals."""
    if case == "ground":
        return _lattice(_waves(5, 0.05)), _lattice(_waves(30, 0.08)), np.array([0.0, 0.0, 1.0])
    coarse = _lattice(_waves(5, 0.02), turned=True)
    fine = _lattice(_waves(30, 0.5 if case == "steep" else 0.04), turned=True)
    u, v = np.meshgrid(np.linspace(0.05, 0.9, 5), np.linspace(0.1, 0.97, 5))
    if case == "mirrored":
        u = 0.95 - u
    textures = np.stack([u, v], axis=-1).reshape(-1, 2).astype(np.float32)
    return replace(coarse, textures=textures), fine, None


def _normal_map(case: str, device: Device) -> Iterator[Difference]:
    coarse, fine, way = _meshes(case)
    baked = bake_normals(coarse, fine, (_SHAPE[1], _SHAPE[0]), device=device)
    assert baked.normal_map is not None
    expected = normal_map(baked, fine, _SHAPE, way)
    covered = ~np.isnan(expected).any(axis=2)
    found = baked.normal_map.pixels[covered] / 127.5 - 1
    yield _SAYS.met_by(found, expected[covered], 1 / 255 + 1e-6)


NORMAL_MAP: Final = Check(
    _normal_map,
    lambda: {case: case for case in ("ground", "textured")},
    lambda: {case: case for case in ("mirrored", "steep")},
)
