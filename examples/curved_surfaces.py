"""Curved surfaces
===============

Surfaces without any ground: Bézier patches from a file, formulas, and a thread through space.
"""

from pathlib import Path

import numpy as np
from PIL import Image

import terrain_lod as tl


def seen(mesh: tl.Mesh) -> np.ndarray:
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    middle, size = (low + high) / 2, np.linalg.norm(high - low)
    eye = middle + size * np.array([0.4, -0.8, 0.55])
    camera = tl.Camera(tuple(eye.tolist()), tuple(middle.tolist()), fov=45, size=(360, 300))
    return tl.render(mesh, camera=camera, style="plain", sun=(215.0, 45.0), wireframe=True)


# 24 bicubic patches of our own; any .bpt file of the Utah teapot does as well
nets = tl.curved.load_bpt(Path(__file__).parent / "data" / "pot.bpt")
pot = tl.curved.bezier(nets, factor=7.5)
print(pot, tl.crack_report(pot, closed=True))
print(tl.curved.patch_continuity(nets))
pot.save("pot.glb")
pictures = [seen(pot)]

# the patches meet, and the surface closes, to the bit: watertight
for name in ("torus", "klein", "seashell", "superquadric"):
    mesh = tl.curved.surface(name, patches=(16, 8), factor=9)
    print(name, mesh, tl.crack_report(mesh))
    mesh.save(f"{name}.glb")
    pictures.append(seen(mesh))
Image.fromarray(np.concatenate(pictures, axis=1)).save("curved_surfaces.png")

knot = tl.curved.curve("torus_knot", p=2, q=5, tube=0.5)
length = np.linalg.norm(np.diff(knot.points, axis=0), axis=1).sum()
print(knot, f"{length:.2f} long")

# four arcs that nearly are a circle: the same tangents and curvatures where they meet
arc = np.array([(1, 0, 0), (1, 0.5523, 0), (0.5523, 1, 0), (0, 1, 0)])
quarter = np.array([(0, 1, 0), (-1, 0, 0), (0, 0, 1)])
arcs = [arc @ np.linalg.matrix_power(quarter, turns) for turns in range(4)]
print(tl.curved.bezier_curve(arcs), tl.curved.curve_continuity(arcs, closed=True))
