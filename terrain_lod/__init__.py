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
from . import curved
from .camera.camera import Camera
from .camera.viewpoint import default_camera
from .curved.displaced import displace
from .curved.smooth import pn_triangles
from .device.device import Device
from .device.drivers import devices
from .drawing.render import render
from .errors import (
    DeviceError,
    DeviceMemoryError,
    FileError,
    GraphicsError,
    InputError,
    MissingExtraError,
    TerrainError,
    WorkerError,
)
from .files.meshes.loading import load_mesh
from .files.rasters.loading import load
from .files.rasters.samples import sample, sample_names
from .ground.heightmap import Heightmap
from .measure.cracks import CrackReport, crack_report
from .measure.error import VerticalError, vertical_error
from .measure.patch_errors import patch_errors
from .measure.screen_error import (
    Pop,
    ScreenError,
    normal_error,
    pop_metric,
    screen_error,
    silhouette_error,
)
from .mesh.bake import bake_normals
from .mesh.hits import Hits
from .mesh.mesh import Achieved, Mesh, Patches
from .mesh.normal_map import NormalMap
from .mesh.queries import MeshQueries
from .numbered import Number, number
from .pyramid.build import build
from .reports.compare.compare import compare
from .reports.compare.outcome import SweepReport
from .reports.report import Report, report
from .streaming.terrain import StreamingTerrain, open
from .terrain.analysis import TileAnalysis, analyse
from .terrain.lod import Lod, PromiseLod, Scene, Weighted
from .terrain.lod_formulas import (
    BookCoplanarityLod,
    CoplanarityLod,
    DistanceLod,
    ScreenAreaLod,
    UniformLod,
)
from .terrain.lod_promises import BudgetLod, MaxErrorLod, ScreenErrorLod
from .terrain.steady import Steady
from .terrain.terrain import Terrain
from .tessellation.pattern import Pattern
from .tessellation.semi_uniform import semi_uniform
from .tessellation.tessellator import tessellate
from .tilesets.journal import Record as TileRecord
from .tilesets.write import TilesReport, write_tiles
from .viewer.view import view

__all__ = [
    "Achieved",
    "BookCoplanarityLod",
    "BudgetLod",
    "Camera",
    "CoplanarityLod",
    "CrackReport",
    "Device",
    "DeviceError",
    "DeviceMemoryError",
    "DistanceLod",
    "FileError",
    "GraphicsError",
    "Heightmap",
    "Hits",
    "InputError",
    "Lod",
    "MaxErrorLod",
    "Mesh",
    "MeshQueries",
    "MissingExtraError",
    "NormalMap",
    "Number",
    "Patches",
    "Pattern",
    "Pop",
    "PromiseLod",
    "Report",
    "Scene",
    "ScreenAreaLod",
    "ScreenError",
    "ScreenErrorLod",
    "Steady",
    "StreamingTerrain",
    "SweepReport",
    "Terrain",
    "TerrainError",
    "TileAnalysis",
    "TileRecord",
    "TilesReport",
    "UniformLod",
    "VerticalError",
    "Weighted",
    "WorkerError",
    "analyse",
    "bake_normals",
    "build",
    "compare",
    "crack_report",
    "curved",
    "default_camera",
    "devices",
    "displace",
    "load",
    "load_mesh",
    "normal_error",
    "number",
    "open",
    "patch_errors",
    "pn_triangles",
    "pop_metric",
    "render",
    "report",
    "sample",
    "sample_names",
    "screen_error",
    "semi_uniform",
    "silhouette_error",
    "tessellate",
    "vertical_error",
    "view",
    "write_tiles",
]
