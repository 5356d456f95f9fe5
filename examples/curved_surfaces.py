"""Surfaces without any ground: Bezier patches from a file, formulas, and a thread through space."""

from pathlib import Path

import numpy as np

import terrain_lod as tl

# 24 bicubic patches of our own; any .bpt file of the Utah teapot does as well
pot = tl.curved.bezier(Path(__file__).parent / "data" / "pot.bpt", factor=7.5)
print(pot, tl.crack_report(pot, closed=True))
pot.save("pot.glb")

# the patches meet, and the surface closes, to the bit: watertight
for name in ("torus", "klein", "seashell", "superquadric"):
    mesh = tl.curved.surface(name, patches=(16, 8), factor=9)
    print(name, mesh, tl.crack_report(mesh))
    mesh.save(f"{name}.glb")

knot = tl.curved.curve("torus_knot", p=2, q=5, tube=0.5)
length = np.linalg.norm(np.diff(knot.points, axis=0), axis=1).sum()
print(knot, f"{length:.2f} long")
