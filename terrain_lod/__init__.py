"""Terrain level of detail with a known error: Direct3D 11 tessellation in OpenCL, from Python.

>>> import terrain_lod as tl
>>> ground = tl.sample("ridge")
>>> camera = tl.default_camera(ground)
>>> mesh = tl.Terrain(ground).mesh(camera, lod=tl.ScreenErrorLod(pixels=1.0))
>>> mesh.save("ridge.glb")                                      # doctest: +SKIP
>>> tl.vertical_error(mesh, ground)                             # doctest: +SKIP
"""

from . import interrupts as interrupts  # first: Ctrl-C from here on

# isort: split
from .camera.camera import Camera
from .camera.viewpoint import default_camera
from .curved.bezier import bezier
from .curved.creases import split_at_creases
from .curved.curved_mesh import CurvedMesh
from .curved.curves import Polyline, curve
from .curved.decals import Decal, dent, shoot
from .curved.displaced import displace
from .curved.displaced_maps import variation_factors
from .curved.patch_factors import (
    CurvatureFactor,
    DistanceFactor,
    LengthFactor,
    OrientationFactor,
    SilhouetteFactor,
    UniformFactor,
)
from .curved.smooth import pn_triangles
from .curved.surfaces import surface
from .device.device import Device
from .device.drivers import devices
from .errors import (
    DeviceError,
    DeviceMemoryError,
    FileError,
    GraphicsError,
    InputError,
    MissingExtraError,
    TerrainError,
)
from .files.meshes.bpt import load_bpt, save_bpt
from .files.meshes.loading import load_mesh
from .files.rasters.loading import load
from .files.rasters.samples import sample, sample_names
from .ground.heightmap import Heightmap
from .measure.cracks import CrackReport, crack_report
from .measure.error import VerticalError, vertical_error
from .measure.screen_error import (
    Pop,
    ScreenError,
    normal_error,
    pop_metric,
    screen_error,
    silhouette_error,
)
from .mesh.hits import Hits
from .mesh.mesh import Achieved, Mesh, Patches
from .mesh.surface import Surface
from .terrain.analysis import TileAnalysis, analyse
from .terrain.lod import (
    BudgetLod,
    CoplanarityLod,
    DistanceLod,
    Lod,
    MaxErrorLod,
    PromiseLod,
    ScreenAreaLod,
    ScreenErrorLod,
    UniformLod,
    Weighted,
)
from .terrain.terrain import Terrain
from .tessellation.pattern import Pattern
from .tessellation.semi_uniform import semi_uniform
from .tessellation.tessellator import tessellate
from .viewer.view import view

__all__ = [
    "Achieved",
    "BudgetLod",
    "Camera",
    "CoplanarityLod",
    "CrackReport",
    "CurvatureFactor",
    "CurvedMesh",
    "Decal",
    "Device",
    "DeviceError",
    "DeviceMemoryError",
    "DistanceFactor",
    "DistanceLod",
    "FileError",
    "GraphicsError",
    "Heightmap",
    "Hits",
    "InputError",
    "LengthFactor",
    "Lod",
    "MaxErrorLod",
    "Mesh",
    "MissingExtraError",
    "OrientationFactor",
    "Patches",
    "Pattern",
    "Polyline",
    "Pop",
    "PromiseLod",
    "ScreenAreaLod",
    "ScreenError",
    "ScreenErrorLod",
    "SilhouetteFactor",
    "Surface",
    "Terrain",
    "TerrainError",
    "TileAnalysis",
    "UniformFactor",
    "UniformLod",
    "VerticalError",
    "Weighted",
    "analyse",
    "bezier",
    "crack_report",
    "curve",
    "default_camera",
    "dent",
    "devices",
    "displace",
    "load",
    "load_bpt",
    "load_mesh",
    "normal_error",
    "pn_triangles",
    "pop_metric",
    "sample",
    "sample_names",
    "save_bpt",
    "screen_error",
    "semi_uniform",
    "shoot",
    "silhouette_error",
    "split_at_creases",
    "surface",
    "tessellate",
    "variation_factors",
    "vertical_error",
    "view",
]
