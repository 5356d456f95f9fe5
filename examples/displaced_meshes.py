"""Displaced meshes
================

A ring that a map displaces across its seams, and a ball that was shot at.
"""

import numpy as np
import pyvista
from PIL import Image

import terrain_lod as tl


def ring(columns: int = 48, rows: int = 24) -> tl.Mesh:
    """Return a torus with a seam each way, where the texture begins again."""
    j, i = np.meshgrid(np.arange(rows + 1), np.arange(columns + 1), indexing="ij")
    # the same positions, to the bit, on both sides of a seam
    u, v = 2 * np.pi * (i % columns) / columns, 2 * np.pi * (j % rows) / rows
    outwards = np.stack([np.cos(u) * np.cos(v), np.sin(u) * np.cos(v), np.sin(v)], axis=-1)
    vertices = outwards + 3 * np.stack([np.cos(u), np.sin(u), 0 * u], axis=-1)
    first = np.arange(i.size).reshape(i.shape)[:-1, :-1, None]
    corners = first + np.array([0, 1, columns + 2, 0, columns + 2, columns + 1])
    return tl.Mesh(
        vertices.reshape(-1, 3).astype(np.float32),
        outwards.reshape(-1, 3).astype(np.float32),
        corners.reshape(-1, 3).astype(np.int32),
        textures=np.stack([i / columns, j / rows], axis=-1).reshape(-1, 2).astype(np.float32),
    )


def seen(mesh: tl.Mesh, style: str = "plain") -> np.ndarray:
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    middle, size = (low + high) / 2, np.linalg.norm(high - low)
    eye = middle + size * np.array([0.4, -0.85, 0.5])
    camera = tl.Camera(tuple(eye.tolist()), tuple(middle.tolist()), fov=42, size=(400, 320))
    return tl.render(mesh, camera=camera, style=style, sun=(215.0, 45.0))


# scales that overlap like those of a fish; twelve around, six along
y, x = np.mgrid[0:64, 0:64] / 64
scales = np.maximum(1 - np.hypot(x - 0.5, y) * 1.6, 1 - np.hypot((x + 0.5) % 1 - 0.5, y - 0.5) * 2)
scales = np.tile(np.clip(scales, 0, 1), (6, 12)).astype(np.float32)
mesh = ring()
factors = tl.curved.variation_factors(mesh, scales, scale=0.25, tolerance=0.002, maximum=15)
scaly = tl.displace(mesh, scales, factor=factors, scale=0.25)
print(f"ring: {mesh} -> {scaly}, {tl.crack_report(scaly)}")

# a crater: a bowl with a rim, seen from above
from_middle = np.hypot(*np.mgrid[-1:1:96j, -1:1:96j])
bowl = np.clip(1 - (from_middle / 0.7) ** 2, 0, None) ** 0.8
crater = bowl - 0.35 * np.exp(-(((from_middle - 0.75) / 0.1) ** 2))
pyvista.Icosphere(nsub=3).save("ball.vtk")
ball = tl.load_mesh("ball.vtk")
random = np.random.default_rng(6)
eyes, radii = random.normal(size=(40, 3)) * 9, random.uniform(0.05, 0.2, 40)
shots = tl.curved.shoot(ball, eyes, -eyes, radii, scale=radii / 3)
moon = tl.curved.dent(ball, shots, crater, 15, curved=True)
print(f"ball: {ball} -> {moon}, {tl.crack_report(moon)}")

sheet = [np.concatenate([seen(m), seen(d), seen(d, "wireframe")], axis=1)
         for m, d in ((mesh, scaly), (ball, moon))]  # fmt: skip
Image.fromarray(np.concatenate(sheet)).save("displaced_meshes.png")
