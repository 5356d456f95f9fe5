"""Ground on the device, ready to be meshed for any camera: the stages in a chain.

::

    heights --analysis--> planes, deviations --hull--> factors --tessellate--> points, triangles
                                                                 --displace--> vertices, normals

Data stays on the device between the stages and comes down once, as a Mesh.
"""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ..arguments import one_of
from ..camera.camera import Camera
from ..device import layout
from ..device.arrays import DeviceArray
from ..device.device import Device
from ..device.timeline import Timeline
from ..errors import InputError
from ..ground.grid import TileGrid
from ..ground.heightmap import Heightmap
from ..ground.relief import Relief
from ..mesh.hits import Hits, checked_points, checked_rays
from ..mesh.mesh import Achieved, Mesh, Patches
from ..mesh.vertices import DeviceVertices
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from ..tessellation.tessellator import tessellate_device
from .analysis import TileAnalysis, analyse_on_device, analyse_tiles
from .buffers import DeviceGround, DeviceLadder
from .domain import displace_on_device
from .holes import without_holes_on_device
from .hull import displace_corners, hull_on_device, patches_on_device
from .ladder import empty_ladder, ladder_on_device, measure_tiles
from .ladder_file import fingerprint, read_ladder, write_ladder
from .lod import (
    Lod,
    PromiseLod,
    Scene,
    ScreenErrorLod,
    Weighted,
)
from .promise import Promise
from .queries import heights_on_device, rays_on_device
from .weights import weights_on_device


class Terrain:
    """A heightmap on a device, analysed once.

    Parameters
    ----------
    ground : Heightmap
    detail : Heightmap, optional
        Laid all over the ground, again and again, and added to it: see
        :meth:`Heightmap.with_detail`, which this is the same as, to the bit, in a fraction of the
        memory. Tiles are then cells of the detail, and errors promised are those of the sum.
    tile : int, optional
        Cells along a tile, 1 to 63. At 15 the tessellator's factor 15 reproduces the raster.
    plane : {"least_squares", "corners"}, optional
        Which plane deviations are measured from.
    device : Device, optional

    Attributes
    ----------
    ground : Heightmap
    detail : Heightmap or None
    grid : TileGrid
    device : Device

    Raises
    ------
    InputError
        If `tile` or `plane` is not one of these, or the detail does not fit the ground.
    DeviceMemoryError
        If the device cannot hold the raster.
    """

    def __init__(
        self,
        ground: Heightmap,
        *,
        detail: Heightmap | None = None,
        tile: int = layout.DEFAULT_TILE,
        plane: str = "least_squares",
        device: Device | None = None,
    ) -> None:
        self._relief = Relief(ground, detail)
        self.device = device or Device.open()
        self._ground = DeviceGround.upload(self._relief, self.device)
        self.grid = TileGrid.of(self._relief, tile)
        self._plane = plane
        self._analysis = analyse_on_device(self._ground, self.grid, plane=plane)
        self._patches = patches_on_device(self._ground, self.grid, self._lowest)

    def update(self, rows: slice, columns: slice, heights: npt.ArrayLike) -> int:
        """Replace samples of the ground, and analyse the tiles that they touch anew.

        Detail stays what it is: samples and heights are those of the ground without it.

        All that is known of these tiles is as if the terrain had been made of the new ground, to
        the bit; :attr:`ground` is that new ground. On an error nothing has changed.

        Parameters
        ----------
        rows, columns : slice
            Which samples: within the raster, without a step.
        heights : array_like of these samples, any real dtype
            Elevations in the world. NaN and masked elements are nodata from now on.

        Returns
        -------
        int
            Tiles analysed: those that hold one of the samples, be it on their border.

        Raises
        ------
        InputError
            If the slices reach out of the raster, the shape is another, heights are infinite, or
            no data would be left.
        """
        ground, rows, columns = self.ground.with_elevations(rows, columns, heights)
        self._relief = Relief(ground, self.detail)
        tiles = self.grid.touching(*self._relief.touching(rows, columns))
        self._ground = self._ground.updated(ground, rows)
        analyse_tiles(self._ground, self.grid, self._analysis, tiles, plane=self._plane)
        # corners without data stand at the lowest height there is: all of them may move
        displace_corners(self._ground, self.grid, self._patches, self._lowest)
        if "_ladder" in self.__dict__:
            measure_tiles(self._ground, self.grid, self._analysis, self._ladder, tiles)
        for known in ("analysis", "scene"):
            self.__dict__.pop(known, None)
        return len(tiles)

    def save_ladder(self, path: str | Path) -> Path:
        """Write the error ladder, which promises are kept with, to a file beside the raster.

        Parameters
        ----------
        path : str or pathlib.Path
            By custom ends in .npz; an existing file is replaced.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        FileError
            If the file cannot be written.
        """
        path = Path(path)
        arrays = {name: array.host() for name, array in self._ladder.measured().items()}
        write_ladder(path, fingerprint(self._relief, self.grid.tile), arrays)
        return path

    def load_ladder(self, path: str | Path) -> None:
        """Take the error ladder from a file of :meth:`save_ladder`, instead of measuring it.

        Raises
        ------
        FileError
            If the file cannot be read, or is the ladder of other ground or of other tiles.
        """
        ladder = empty_ladder(self.device, self.grid)
        shapes = {name: array.shape for name, array in ladder.measured().items()}
        arrays = read_ladder(Path(path), fingerprint(self._relief, self.grid.tile), shapes)
        for name, array in ladder.measured().items():
            array.write(arrays[name])
        self.__dict__["_ladder"] = ladder

    @property
    def _lowest(self) -> float:
        """Lowest height above the base, from the tiles: samples are hundreds of times as many."""
        return float(np.nanmin(self._analysis.details.host()[..., 1]))

    @cached_property
    def analysis(self) -> TileAnalysis:
        """Planes, deviations and ranges of the tiles."""
        return TileAnalysis.of(self.grid, self._analysis)

    @property
    def ground(self) -> Heightmap:
        """The heightmap, as it is now, without its detail."""
        return self._relief.ground

    @property
    def detail(self) -> Heightmap | None:
        """What is laid over it."""
        return self._relief.detail

    @property
    def origin(self) -> tuple[float, float, float]:
        """World point that meshes of this terrain are relative to."""
        return (*self.ground.origin, self._relief.base)

    @cached_property
    def scene(self) -> Scene:
        """What levels of detail take their defaults from."""
        low = float(np.nanmin(self.analysis.minimum))
        high = float(np.nanmax(self.analysis.maximum))
        known = self.analysis.deviation[~np.isnan(self.analysis.deviation)]
        return Scene(
            diagonal=float(np.hypot(np.hypot(*self.grid.extent), high - low)),
            rough_deviation=float(np.percentile(known, 98)),
        )

    def mesh(
        self,
        camera: Camera | None = None,
        *,
        lod: Lod | PromiseLod | Weighted | None = None,
        edge_rule: str | None = None,
        partitioning: str = "fractional_odd",
        cull: bool = True,
    ) -> Mesh:
        """Tessellate the terrain as a camera deserves it.

        Parameters
        ----------
        camera : Camera, optional
            Where detail is wanted, and what is in view. Without one, nothing is culled.
        lod : Lod, PromiseLod or Weighted, optional
            A formula for the segments that a patch deserves, or an error to keep, or either with
            weights on it; defaults to ``ScreenErrorLod(1.0)``.
        edge_rule : {"min", "max", "edge"}, optional
            Factor of a shared edge: the lower of the two tiles' (the default with a formula, and
            the book's), the higher, or by the edge's own error (the default with a promise, and
            for promises alone).
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
        lod = lod or ScreenErrorLod()
        one_of("partitioning", partitioning, layout.PARTITIONINGS)
        if camera is None and lod.needs_camera:
            raise InputError(f"{type(lod).__name__} needs a camera, got none")
        cull = cull and camera is not None
        achieved = None
        with self.device.timed() as timeline:
            weights = self._weights(camera, lod)
            lod = lod.lod if isinstance(lod, Weighted) else lod
            if isinstance(lod, PromiseLod):
                promise = self._promise(camera, edge_rule or "edge", partitioning, cull, weights)
                kept = promise.keep(lod)
                factors, pattern, achieved = kept.factors, kept.pattern, kept.achieved
            else:
                factors = self._factors(camera, lod, edge_rule or "min", cull, weights)
                pattern = self._pattern(factors, partitioning)
            vertices = displace_on_device(self._ground, self.grid, pattern)
            return self._download(factors, pattern, vertices, timeline, achieved)

    def height_at(self, points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Return the ground's elevations at points of the world.

        Parameters
        ----------
        points : array_like, (N, 2)
            World x and y.

        Returns
        -------
        (N,) float64
            Bilinear between samples; NaN outside the raster and where a sample has no data.

        Raises
        ------
        InputError
            If the points are not such, or not finite.
        DeviceError
            If the device has no 64-bit floats.
        """
        return heights_on_device(self._ground, self.grid, self.origin, checked_points(points))

    def cast(self, origins: npt.ArrayLike, directions: npt.ArrayLike) -> Hits:
        """Find what rays meet first of the ground itself, bilinear between its samples.

        Parameters
        ----------
        origins, directions : array_like, (N, 3)
            World points, and directions of any length; one of either serves all.

        Returns
        -------
        Hits
            Those of cells whose four samples have data, from above or below. A ray that comes in
            under the ground at the raster's border is below it.

        Raises
        ------
        InputError
            If the rays are not such, not finite, or a direction is zero.
        DeviceError
            If the device has no 64-bit floats.
        """
        return rays_on_device(
            self._ground,
            self.grid,
            self._analysis,
            self.origin,
            *checked_rays(origins, directions),
        )

    @cached_property
    def _ladder(self) -> DeviceLadder:
        return ladder_on_device(self._ground, self.grid, self._analysis)

    def _view(self, camera: Camera | None) -> npt.NDArray[Any]:
        return np.zeros((), layout.VIEW) if camera is None else camera.view(self.origin)

    def _weights(
        self, camera: Camera | None, lod: Lod | PromiseLod | Weighted
    ) -> DeviceArray | None:
        if not isinstance(lod, Weighted):
            return None
        return weights_on_device(
            self.grid,
            self._analysis,
            self._view(camera),
            horizon=lod.horizon,
            silhouette=lod.silhouette,
        )

    def _promise(
        self,
        camera: Camera | None,
        edges: str,
        partitioning: str,
        cull: bool,
        weights: DeviceArray | None = None,
    ) -> Promise:
        return Promise(
            self._ground,
            self.grid,
            self._analysis,
            self._ladder,
            self._view(camera),
            has_camera=camera is not None,
            tessellate=lambda factors: self._pattern(factors, partitioning),
            edges=edges,
            cull=cull,
            weights=weights,
        )

    def _factors(
        self,
        camera: Camera | None,
        lod: Lod,
        edges: str,
        cull: bool,
        weights: DeviceArray | None = None,
    ) -> DeviceFactors:
        return hull_on_device(
            self.grid,
            self._patches,
            self._analysis,
            lod,
            self.scene,
            self._view(camera),
            edges=edges,
            cull=cull,
            weights=weights,
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
        self,
        factors: DeviceFactors,
        pattern: DevicePattern,
        vertices: DeviceVertices,
        timeline: Timeline,
        achieved: Achieved | None,
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
            timings=timeline.seconds,
            achieved=achieved,
        )

    def _repr_html_(self) -> str:
        from ..drawing.notebook import terrain_html

        return terrain_html(self)

    def __repr__(self) -> str:
        rows, columns = self.grid.shape
        detail = "" if self.detail is None else f", detail={self.detail!r}"
        return f"Terrain({self.ground!r}{detail}, {rows} x {columns} tiles of {self.grid.tile})"
