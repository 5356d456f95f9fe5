# The public names, and where they come from: __init__.py imports each when it is asked for.
from . import curved
from .camera.camera import Camera
from .camera.viewpoint import default_camera
from .curved.displaced import displace
from .curved.smooth import pn_triangles
from .device.device import Device, DeviceArray
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
from .mesh.device_mesh import DeviceMesh
from .mesh.hits import Hits
from .mesh.mesh import Achieved, Mesh, Patches
from .mesh.queries import MeshQueries
from .numbered import Number, number
from .pyramid.build import build
from .reports.compare.compare import compare
from .reports.compare.outcome import SweepReport
from .reports.report import Report, report
from .streaming.terrain import StreamingTerrain

# not in __all__: ``from terrain_lod import *`` leaves Python's own open alone
from .streaming.terrain import open as open
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
    "DeviceArray",
    "DeviceError",
    "DeviceMemoryError",
    "DeviceMesh",
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
