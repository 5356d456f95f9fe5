"""Terrain level of detail with a known error: Direct3D 11 tessellation in OpenCL, from Python.

>>> import terrain_lod as tl
>>> ground = tl.sample("ridge")
>>> camera = tl.default_camera(ground)
>>> mesh = tl.Terrain(ground).mesh(camera, lod=tl.ScreenErrorLod(pixels=1.0))
>>> mesh.save("ridge.glb")                                      # doctest: +SKIP
>>> tl.vertical_error(mesh, ground)                             # doctest: +SKIP
"""

from .analysis import TileAnalysis, analyse
from .camera import Camera
from .cracks import CrackReport, crack_report
from .device import Device, devices
from .error import VerticalError, vertical_error
from .errors import (
    DeviceError,
    DeviceMemoryError,
    FileError,
    InputError,
    MissingExtraError,
    TerrainError,
)
from .heightmap import Heightmap
from .loading import load
from .lod import (
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
from .mesh import Achieved, Mesh, Patches
from .mesh_loading import load_mesh
from .pattern import Pattern
from .queries import Hits
from .queries_mesh import Surface
from .samples import sample, sample_names
from .screen_error import (
    Pop,
    ScreenError,
    normal_error,
    pop_metric,
    screen_error,
    silhouette_error,
)
from .terrain import Terrain
from .tessellator import tessellate
from .viewpoint import default_camera

__all__ = [
    "Achieved",
    "BudgetLod",
    "Camera",
    "CoplanarityLod",
    "CrackReport",
    "Device",
    "DeviceError",
    "DeviceMemoryError",
    "DistanceLod",
    "FileError",
    "Heightmap",
    "Hits",
    "InputError",
    "Lod",
    "MaxErrorLod",
    "Mesh",
    "MissingExtraError",
    "Patches",
    "Pattern",
    "Pop",
    "PromiseLod",
    "ScreenAreaLod",
    "ScreenError",
    "ScreenErrorLod",
    "Surface",
    "Terrain",
    "TerrainError",
    "TileAnalysis",
    "UniformLod",
    "VerticalError",
    "Weighted",
    "analyse",
    "crack_report",
    "default_camera",
    "devices",
    "load",
    "load_mesh",
    "normal_error",
    "pop_metric",
    "sample",
    "sample_names",
    "screen_error",
    "silhouette_error",
    "tessellate",
    "vertical_error",
]
