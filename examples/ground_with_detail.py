"""Ground with detail
==================

Sand ripples on dunes: a small map, repeated over ground that is eight times as coarse.

The sum of both is stored nowhere. Left of the seam are the dunes alone, right of it with ripples.
"""

import numpy as np
from PIL import Image

import terrain_lod as tl

PERIOD, STEPS = 128, 8  # samples of the small map, and of those a cell of the dunes

dunes = tl.sample("dunes")
dx, dy = dunes.spacing

# ripples that bend and fork, and meet themselves at the map's border
v, u = np.mgrid[:PERIOD, :PERIOD] * (2 * np.pi / PERIOD)
random, bend, swell = np.random.default_rng(4), 0, 0
for across in range(-3, 4):
    for down in range(4):
        wave = across * u + down * v + random.uniform(0, 2 * np.pi)
        bend = bend + np.sin(wave) * random.normal() / (1 + np.hypot(across, down))
        swell = swell + np.cos(wave) * random.normal() / (1 + np.hypot(across, down))
crest = 24 * u + 5 * v + bend
heights = 0.16 * (np.sin(crest) + 0.3 * np.sin(2 * crest + 1)) * (1 + 0.3 * swell)
ripples = tl.Heightmap(heights, spacing=(dx / STEPS, dy / STEPS))

# a walker's view
x, y, _ = dunes.centre
eye = tl.Terrain(dunes).height_at([(x, y)])[0] + 6
camera = tl.Camera((x, y, eye), (x + 110, y + 120, eye - 24), fov=50, size=(1400, 600))
lod = tl.ScreenErrorLod(pixels=1.0)

halves = []
for detail in (None, ripples):
    terrain = tl.Terrain(dunes, detail=detail)
    mesh = terrain.mesh(camera, lod=lod)
    halves.append(tl.render(mesh, camera=camera, sun=(165, 28), height_range=dunes.height_range))
    rows, columns = terrain.grid.rows, terrain.grid.columns
    print(f"{rows} x {columns} samples: {mesh}, within {mesh.achieved.pixels:.2f} pixels")
print(tl.screen_error(mesh, dunes.with_detail(ripples), camera))

row, column = np.mgrid[: camera.size[1], : camera.size[0]]
seam = 520 + row // 4
picture = np.where((column < seam)[..., None], halves[0], halves[1])
picture[abs(column - seam) < 2] = 255
Image.fromarray(picture).save("ground_with_detail.png")
