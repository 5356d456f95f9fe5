"""Three views
===========

One camera and three views side by side: the picture, its triangles, their level of detail.
"""

import numpy as np
from PIL import Image

import terrain_lod as tl

ground = tl.sample("ridge")
camera = tl.default_camera(ground, size=(1500, 640))
mesh = tl.Terrain(ground).mesh(camera, lod=tl.ScreenErrorLod(pixels=0.7))

styles = ("shaded", "wireframe", "lod")
views = {style: tl.render(mesh, camera=camera, style=style) for style in styles}
# slanted seams: where each view ends, row by row
row, column = np.mgrid[:640, :1500]
first, second = 560 + row // 6, 1000 + row // 6
picture = np.where((column < first)[..., None], views["shaded"], views["wireframe"])
picture = np.where((column < second)[..., None], picture, views["lod"])
picture[(abs(column - first) < 2) | (abs(column - second) < 2)] = 255

Image.fromarray(picture.astype(np.uint8)).save("three_views.png")
print(f"{len(mesh.triangles)} triangles, within {mesh.achieved.pixels:.2f} pixels")
