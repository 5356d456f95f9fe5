"""Curved meshes
=============

Five meshes before and after their triangles are curved, shaded and as wireframe.

Each row of the sheet shows a mesh, the same mesh curved, both of them as wireframe, and the mesh
refined only where its outline is.
"""

import numpy as np
import pyvista
from PIL import Image
from pyvista import examples

import terrain_lod as tl

SUN = (215.0, 45.0)


def camera_at(mesh: tl.Mesh) -> tl.Camera:
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    middle, size = (low + high) / 2, np.linalg.norm(high - low)
    eye = middle + size * np.array([0.4, -0.85, 0.5])
    return tl.Camera(tuple(eye.tolist()), tuple(middle.tolist()), fov=45, size=(320, 280))


pyvista.Cone(resolution=14).triangulate().save("cone.vtk")
pyvista.ParametricTorus(u_res=13, v_res=9, w_res=3).save("torus.vtk")

rows = []
for name, path, sharp in (
    ("ant", examples.antfile, True),
    ("nut, smooth", examples.nutfile, True),
    ("nut, sharp from 30 degrees", examples.nutfile, 30.0),
    ("torus", "torus.vtk", True),
    ("cone, sharp from 60 degrees", "cone.vtk", 60.0),
):
    mesh = tl.load_mesh(path)
    camera = camera_at(mesh)
    smooth = tl.pn_triangles(mesh, 7, sharp=sharp)
    outline = tl.pn_triangles(mesh, lod=tl.curved.SilhouetteFactor(), camera=camera, sharp=sharp)
    print(f"{name}: {mesh} -> {smooth}, {tl.crack_report(smooth)}")
    pictures = [
        tl.render(mesh, camera=camera, style="plain", sun=SUN),
        tl.render(smooth, camera=camera, style="plain", sun=SUN),
        tl.render(mesh, camera=camera, style="wireframe"),
        tl.render(smooth, camera=camera, style="wireframe"),
        tl.render(outline, camera=camera, style="wireframe"),
    ]
    rows.append(np.concatenate(pictures, axis=1))
Image.fromarray(np.concatenate(rows)).save("curved_meshes.png")
