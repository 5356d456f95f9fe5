"""Your own heights
================

Any array is ground: here a function on a grid, with a hole in it, within a centimetre.
"""

import numpy as np

import terrain_lod as tl

y, x = np.mgrid[-3:3:401j, -3:3:401j]
radius = np.hypot(x, y)
heights = 40 * np.cos(4 * radius) / (1 + radius)
heights[np.hypot(x - 1, y - 1) < 0.3] = np.nan  # nodata: no triangle reaches into it

ground = tl.Heightmap(heights, spacing=1.0, origin=(500_000, 4_000_000), name="ripples")
terrain = tl.Terrain(ground)
for metres in (0.01, 0.1, 1.0):
    mesh = terrain.mesh(lod=tl.MaxErrorLod(metres))
    error = tl.vertical_error(mesh, ground)
    print(f"asked {metres} m, got {error.maximum:.4f} m from {len(mesh.triangles)} triangles")
mesh.save("ripples.ply")
camera = tl.default_camera(ground, size=(1280, 720))
tl.render(mesh, "ripples.png", camera=camera, wireframe=True)
