"""First mesh
==========

Real ground, a camera, and a mesh that is off by at most a pixel, measured.
"""

import terrain_lod as tl

ground = tl.sample("jacksboro")  # or tl.load("dem.tif")
terrain = tl.Terrain(ground)
camera = tl.default_camera(ground)
mesh = terrain.mesh(camera, lod=tl.ScreenErrorLod(pixels=1.0))

print(mesh, "of", 2 * ground.heights.size, "at full resolution")
print(tl.vertical_error(mesh, ground))
print(tl.screen_error(mesh, ground, camera))
print(tl.crack_report(mesh))
mesh.save("jacksboro.glb")
tl.render(mesh, "jacksboro.png", camera=camera)
