"""Terrain level of detail with a known error: Direct3D 11 tessellation in OpenCL, from Python.

>>> import terrain_lod as tl
>>> ground = tl.sample("ridge")
>>> camera = tl.default_camera(ground)
>>> mesh = tl.Terrain(ground).mesh(camera, lod=tl.CoplanarityLod())
>>> mesh.save("ridge.glb")                                      # doctest: +SKIP
>>> tl.vertical_error(mesh, ground)                             # doctest: +SKIP
"""

from .analysis import TileAnalysis, analyse
from .camera import Camera
from .device import Device, devices
from .errors import (
    DeviceError,
    DeviceMemoryError,
    FileError,
    InputError,
    MissingExtraError,
    TerrainError,
)
from .heightmap import Heightmap
from .lod import CoplanarityLod, DistanceLod, Lod, UniformLod
from .mesh import Mesh, Patches
from .pattern import Pattern
from .terrain import Terrain

__all__ = [
    "Camera",
    "CoplanarityLod",
    "Device",
    "DeviceError",
    "DeviceMemoryError",
    "DistanceLod",
    "FileError",
    "Heightmap",
    "InputError",
    "Lod",
    "Mesh",
    "MissingExtraError",
    "Patches",
    "Pattern",
    "Terrain",
    "TerrainError",
    "TileAnalysis",
    "UniformLod",
    "analyse",
    "devices",
]
