"""Terrain level of detail with a known error: Direct3D 11 tessellation in OpenCL, from Python.

>>> import terrain_lod as tl
>>> ground = tl.sample("ridge")
>>> camera = tl.default_camera(ground)
>>> mesh = tl.Terrain(ground).mesh(camera, lod=tl.ScreenErrorLod(pixels=1.0))
>>> mesh.save("ridge.glb")                                      # doctest: +SKIP
>>> tl.vertical_error(mesh, ground)                             # doctest: +SKIP
>>> tl.render(ground, "ridge.png")                              # doctest: +SKIP
>>> tl.report(ground, "levels_of_detail")                       # doctest: +SKIP
"""

from . import interrupts as interrupts  # first: Ctrl-C from here on

# isort: split
from .lazily import lazily as _lazily

__getattr__, __dir__, __all__ = _lazily(__name__, __file__)
