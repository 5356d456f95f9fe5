"""Subdivision surfaces
====================

Boxes of a few polygons, as Catmull-Clark surfaces; sharp edges, and a ring of B-splines.
"""

import numpy as np
from PIL import Image

import terrain_lod as tl

corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
box = tl.curved.ControlMesh(corners, sides)
lid = tl.curved.ControlMesh(corners, sides, creases=[(1, 3), (3, 7), (7, 5), (5, 1)])

# a star of ten walls between two lids, each a polygon of ten corners
angles, radii = np.arange(10) * np.pi / 5, np.tile([1.0, 0.45], 5)
star = np.stack([radii * np.cos(angles), radii * np.sin(angles), np.full(10, 0.3)], axis=1)
walls = [(i, i + 10, (i + 1) % 10 + 10, (i + 1) % 10) for i in range(10)]
star = tl.curved.ControlMesh(
    np.concatenate([star, star * (1, 1, -1)]), [range(10), range(19, 9, -1), *walls]
)

u, v = np.meshgrid(np.arange(12) * np.pi / 6, np.arange(6) * np.pi / 3, indexing="ij")
wide = 3 + np.cos(v) * (1 + 0.5 * (np.arange(12) % 2)[:, None])
ring = np.stack([np.cos(u) * wide, np.sin(u) * wide, np.sin(v)], axis=-1)


def seen(mesh: tl.Mesh, style: str) -> np.ndarray:
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    eye = (low + high) / 2 + np.linalg.norm(high - low) * np.array([0.6, -0.9, 0.8])
    target = tuple(((low + high) / 2).tolist())
    camera = tl.Camera(tuple(eye.tolist()), target, fov=45, size=(320, 260))
    return tl.render(mesh, camera=camera, style=style)


meshes = [
    *(tl.curved.catmull_clark(control, factor=9) for control in (box, lid, star)),
    tl.curved.bezier(tl.curved.b_spline(ring, closed=(True, True)), factor=7),
]
for mesh in meshes:
    print(mesh, tl.crack_report(mesh, closed=True))
sheet = [
    np.concatenate([seen(m, style) for m in meshes], axis=1) for style in ("plain", "wireframe")
]
Image.fromarray(np.concatenate(sheet)).save("subdivision_surfaces.png")
