"""Ground on the device, ready to be meshed for any camera: the stages in a chain.

::

    heights --analysis--> planes, deviations --hull--> factors --tessellate--> points, triangles
                                                                 --displace--> vertices, normals

Data stays on the device between the stages and comes down once, as a Mesh.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from . import layout
from .analysis import TileAnalysis, analyse_on_device
from .buffers import DeviceFactors, DeviceGround, DeviceVertices
from .camera import Camera
from .device import Device
from .domain import displace_on_device
from .errors import InputError
from .grid import TileGrid
from .heightmap import Heightmap
from .holes import without_holes_on_device
from .hull import hull_on_device, patches_on_device
from .lod import CoplanarityLod, Lod, Scene
from .mesh import Mesh, Patches
from .pattern import DevicePattern
from .tessellator import tessellate_device


class Terrain:
    """A heightmap on a device, analysed once.

    Parameters
    ----------
    ground : Heightmap
    tile : int, optional
        Cells along a tile, 1 to 63. At 15 the tessellator's factor 15 reproduces the raster.
    plane : {"least_squares", "corners"}, optional
        Which plane deviations are measured from.
    device : Device, optional

    Attributes
    ----------
    ground : Heightmap
    grid : TileGrid
    device : Device

    Raises
    ------
    InputError
        If `tile` or `plane` is not one of these.
    DeviceMemoryError
        If the device cannot hold the raster.
    """

    def __init__(
        self,
        ground: Heightmap,
        *,
        tile: int = layout.DEFAULT_TILE,
        plane: str = "least_squares",
        device: Device | None = None,
    ) -> None:
        self.ground = ground
        self.grid = TileGrid.of(ground, tile)
        self.device = device or Device.open()
        self._ground = DeviceGround.upload(ground, self.device)
        self._analysis = analyse_on_device(self._ground, self.grid, plane=plane)
        low, _ = ground.height_range
        self._patches = patches_on_device(self._ground, self.grid, fallback=low - ground.base)

    @cached_property
    def analysis(self) -> TileAnalysis:
        """Planes, deviations and ranges of the tiles."""
        return TileAnalysis.of(self.grid, self._analysis)

    @property
    def origin(self) -> tuple[float, float, float]:
        """World point that meshes of this terrain are relative to."""
        return (*self.ground.origin, self.ground.base)

    @cached_property
    def scene(self) -> Scene:
        """What levels of detail take their defaults from."""
        low, high = self.ground.height_range
        known = self.analysis.deviation[~np.isnan(self.analysis.deviation)]
        return Scene(
            diagonal=float(np.hypot(np.hypot(*self.ground.extent), high - low)),
            rough_deviation=float(np.percentile(known, 90)),
        )

    def mesh(
        self,
        camera: Camera | None = None,
        *,
        lod: Lod | None = None,
        edges: str = "min",
        partitioning: str = "fractional_odd",
        cull: bool = True,
    ) -> Mesh:
        """Tessellate the terrain as a camera deserves it.

        Parameters
        ----------
        camera : Camera, optional
            Where detail is wanted, and what is in view. Without one, nothing is culled.
        lod : Lod, optional
            Segments that a patch deserves; defaults to :class:`CoplanarityLod`.
        edges : {"min", "max"}, optional
            Factor of a shared edge: the lower of the two tiles' levels, or the higher.
        partitioning : {"fractional_odd", "fractional_even", "integer", "pow2"}, optional
        cull : bool, optional
            Leave out the patches whose bounds are out of view.

        Returns
        -------
        Mesh
            Watertight: patches that share an edge have bit-equal vertices on it.

        Raises
        ------
        InputError
            If the level of detail needs a camera and there is none, or a name is unknown.
        DeviceMemoryError
            If the device cannot hold the mesh.
        """
        lod = lod or CoplanarityLod()
        if camera is None and lod.needs_camera:
            raise InputError(f"{type(lod).__name__} needs a camera, got none")
        with self.device.timed() as timeline:
            factors = self._factors(camera, lod, edges, cull)
            pattern = self._pattern(factors, partitioning)
            vertices = displace_on_device(self._ground, self.grid, pattern)
            mesh = self._download(factors, pattern, vertices)
        mesh.timings.update(timeline.seconds)
        return mesh

    def _factors(self, camera: Camera | None, lod: Lod, edges: str, cull: bool) -> DeviceFactors:
        view = np.zeros((), layout.VIEW) if camera is None else camera.view(self.origin)
        return hull_on_device(
            self.grid,
            self._patches,
            self._analysis,
            lod,
            self.scene,
            view,
            edges=edges,
            cull=cull and camera is not None,
        )

    def _pattern(self, factors: DeviceFactors, partitioning: str) -> DevicePattern:
        # v runs south, so clockwise in the domain is counter-clockwise seen from above
        pattern = tessellate_device(
            "quad", factors.edge, factors.inside, partitioning, clockwise=False
        )
        if not self._ground.masked:
            return pattern
        return without_holes_on_device(self._ground, self.grid, self._analysis, pattern)

    def _download(
        self, factors: DeviceFactors, pattern: DevicePattern, vertices: DeviceVertices
    ) -> Mesh:
        patches = Patches(
            shape=self.grid.shape,
            tile=self.grid.tile,
            edge_factors=factors.edge.host(),
            inside_factors=factors.inside.host(),
            point_offsets=pattern.point_offsets.host().astype(np.int64),
            triangle_offsets=pattern.primitive_offsets.host().astype(np.int64),
            deviation=self.analysis.deviation.ravel(),
        )
        return Mesh(
            vertices=vertices.positions.host(),
            normals=vertices.normals.host(),
            triangles=pattern.primitives.host(),
            origin=np.array(self.origin),
            crs=self.ground.crs,
            patches=patches,
        )

    def __repr__(self) -> str:
        rows, columns = self.grid.shape
        return f"Terrain({self.ground!r}, {rows} x {columns} tiles of {self.grid.tile})"
