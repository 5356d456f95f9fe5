"""Ground on the device, ready to be meshed for any camera: the stages in a chain.

::

    heights --analysis--> planes, deviations --hull--> factors --tessellate--> points, triangles
                                                                 --displace--> vertices, normals

Data stays on the device between the stages and comes down once, as a Mesh.
"""

from __future__ import annotations

import threading

import numpy as np
import numpy.typing as npt

from ..arguments import flag, instance, one_of, whole
from ..camera.camera import Camera
from ..device import layout
from ..device.device import Device
from ..errors import InputError
from ..ground.grid import TileGrid
from ..ground.heightmap import Heightmap
from ..ground.relief import Relief
from ..mesh.device_mesh import DeviceMesh
from ..mesh.hits import Hits, checked_points, checked_rays
from ..mesh.mesh import Mesh
from .analysis import TileAnalysis
from .buffers import DeviceGround
from .fitted import HEIGHTS, check_fitted
from .hull import hull_on_device
from .leaves import Drawn
from .lod import AnyLod, PromiseLod, Scene, Weighted, checked_lod, unweighted
from .lod_formulas import UniformLod
from .lod_promises import ScreenErrorLod
from .meshing import Tessellated, device_mesh_of, mesh_of
from .promise import Promise
from .queries import heights_on_device, rays_on_device
from .sky import sky_seen
from .steady import Steady
from .tiles import DeviceTiles
from .turns import Turns
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
        Cells along a tile, 1 to 63. Default: 4, or 15 in a flat grid.
    levels : int, optional
        Sizes of patches that promises are kept with: of 1, 2 x 2, 4 x 4, ... tiles. Default: up to
        the whole raster. 1 is the flat grid of the book, which formulas are at their best on.
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
        If `tile`, `levels` or `plane` is not one of these, or the detail does not fit the ground.
    DeviceMemoryError
        If the device cannot hold the raster.

    Notes
    -----
    Threads may share one: an update waits until the calls before it have ended, and those after it
    wait for it.
    """

    def __init__(
        self,
        ground: Heightmap,
        *,
        detail: Heightmap | None = None,
        tile: int | None = None,
        levels: int | None = None,
        plane: str = "least_squares",
        device: Device | None = None,
    ) -> None:
        self.levels = None if levels is None else whole("levels", levels, 1, layout.MAX_LEVELS)
        if tile is None:
            tile = layout.FLAT_TILE if self.levels == 1 else layout.DEFAULT_TILE
        relief, device = Relief(ground, detail), Device.of(device)
        self._tiles = DeviceTiles.of(DeviceGround.upload(relief, tile, device), plane=plane)
        self._turns, self._measuring = Turns(), threading.Lock()
        self._sky: tuple[Heightmap, npt.NDArray[np.float32]] | None = None

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
        DeviceMemoryError
            If the device cannot hold what is replaced beside what replaces it.
        """
        with self._turns.changing():
            ground, rows, columns = self.ground.with_elevations(rows, columns, heights)
            self._tiles, count = self._tiles.updated(ground, rows, columns)
        return count

    @property
    def device(self) -> Device:
        return self._tiles.device

    @property
    def grid(self) -> TileGrid:
        return self._tiles.grid

    @property
    def plane(self) -> str:
        """Which plane deviations are from."""
        return self._tiles.analysis.plane

    @property
    def analysis(self) -> TileAnalysis:
        """Planes, deviations and ranges of the tiles."""
        with self._turns.reading():
            return self._tiles.found

    @property
    def ground(self) -> Heightmap:
        """The heightmap, as it is now, without its detail."""
        return self._tiles.ground.relief.ground

    @property
    def detail(self) -> Heightmap | None:
        """What is laid over it."""
        return self._tiles.ground.relief.detail

    @property
    def origin(self) -> tuple[float, float, float]:
        """World point that meshes of this terrain are relative to."""
        return self._tiles.ground.origin

    @property
    def sky(self) -> npt.NDArray[np.float32]:
        """Share of the sky's light that each sample has, 0 to 1, without detail; (R, C).

        Found once, and again after an update.
        """
        with self._turns.reading(), self._measuring:
            ground = self.ground
            if self._sky is None or self._sky[0] is not ground:
                self._sky = ground, sky_seen(ground, self.device)
            return self._sky[1]

    @property
    def scene(self) -> Scene:
        """What levels of detail take their defaults from."""
        with self._turns.reading():
            return self._tiles.scene

    def mesh(
        self,
        camera: Camera | None = None,
        *,
        lod: AnyLod | None = None,
        edge_rule: str | None = None,
        partitioning: str | None = None,
        heights: str = "ground",
        cull: bool = True,
        steady: Steady | None = None,
    ) -> Mesh:
        """Tessellate the terrain as a camera deserves it.

        Parameters
        ----------
        camera : Camera, optional
            Where detail is wanted, and what is in view. Without one, nothing is culled.
        lod : Lod, PromiseLod or Weighted, optional
            A formula for the segments that a patch deserves, or an error to keep, or either with
            weights on it. Defaults to ``ScreenErrorLod(1.0)`` for a camera; without one to the
            raster in full, ``UniformLod`` of the tile's cells: every sample is a vertex.
        edge_rule : {"min", "max"}, optional
            With a formula, the factor of an edge that two tiles share: the lower of theirs (the
            default, and the book's) or the higher. A promise goes by the edge's own error.
        partitioning : {"integer", "fractional_odd", "fractional_even", "pow2"}, optional
            How factors divide a patch. Default: ``"integer"`` with a promise, which is then kept by
            patches of every size; with a formula ``"fractional_odd"``, which moves smoothly, and
            ``"integer"`` in tiles of an even number of cells, where it would miss the samples.
        heights : {"ground", "fitted"}, optional
            Whether vertices stand on the ground, or float within the error that is promised, where
            that makes it least: fewer triangles, in more time. For promises in the partitioning
            ``"integer"``. Normals are the ground's.
        cull : bool, optional
            Leave out the patches whose bounds are out of view.
        steady : Steady, optional
            What lets the patches of a promise stay as they were in its last mesh.

        Returns
        -------
        Mesh
            Watertight: patches that share an edge have bit-equal vertices on it.

        Raises
        ------
        InputError
            If `lod` is no level of detail, or needs a camera and there is none, or a name is
            unknown, or heights are to be fitted to what is no promise.
        DeviceMemoryError
            If the device cannot hold the mesh.
        """
        with self._turns.reading(), self.device.timed() as timeline:
            made, tiles, drawn = self._tessellated(
                camera, lod, edge_rule, partitioning, heights, cull, steady
            )
            return mesh_of(made, *tiles.described(drawn), timeline)

    def mesh_on_device(
        self,
        camera: Camera | None = None,
        *,
        lod: AnyLod | None = None,
        edge_rule: str | None = None,
        partitioning: str | None = None,
        heights: str = "ground",
        cull: bool = True,
        steady: Steady | None = None,
    ) -> DeviceMesh:
        """Tessellate the terrain as :meth:`mesh` does, and leave the mesh on the device.

        Parameters are those of :meth:`mesh`, and so is what is raised.

        Returns
        -------
        DeviceMesh
            The same vertices, normals and triangles, to the bit. It says how NumPy, OpenCL and
            others take them without a copy.
        """
        with self._turns.reading():
            made, _, _ = self._tessellated(
                camera, lod, edge_rule, partitioning, heights, cull, steady
            )
            return device_mesh_of(made)

    def _tessellated(
        self,
        camera: Camera | None,
        lod: AnyLod | None,
        edge_rule: str | None,
        partitioning: str | None,
        heights: str,
        cull: bool,
        steady: Steady | None,
    ) -> tuple[Tessellated, DeviceTiles, Drawn | None]:
        """Return the pattern asked for, the tiles it is of, and what leaves were drawn."""
        if lod is None:
            lod = UniformLod(self.grid.tile) if camera is None else ScreenErrorLod()
        lod = checked_lod(lod)
        if camera is not None:
            instance("a Camera for camera", camera, Camera)
        bare = unweighted(lod)
        promised = bare if isinstance(bare, PromiseLod) else None
        if partitioning is None:
            even = self.grid.tile % 2 == 0
            partitioning = "integer" if promised or even else "fractional_odd"
        one_of("partitioning", partitioning, layout.PARTITIONINGS)
        if promised and edge_rule is not None:
            raise InputError(
                f"expected a formula with edge_rule=, got {promised}: promises go by the edge's "
                "own error"
            )
        if steady and not (promised and promised.triangles is None and partitioning == "integer"):
            raise InputError(
                f"expected an error to keep by patches of every size with {steady}, got "
                f"{bare} in {partitioning}"
            )
        one_of("heights", heights, HEIGHTS)
        if heights == "fitted":
            check_fitted(lod, partitioning, steady)
        if camera is None and lod.needs_camera:
            raise InputError(f"{type(lod).__name__} needs a camera, got none")
        cull = flag("cull", cull) and camera is not None
        weighted, lod = lod, unweighted(lod)
        tiles = self._tiles
        if isinstance(lod, PromiseLod):
            tiles = self._with_tree() if partitioning == "integer" else self._with_ladder()
        weights = None
        if isinstance(weighted, Weighted) and camera is not None:
            weights = weights_on_device(
                tiles, camera, horizon=weighted.horizon, silhouette=weighted.silhouette
            )
        if isinstance(lod, PromiseLod):
            promise = Promise(tiles, camera, partitioning, "edge", cull, weights, steady, heights)
            kept = promise.keep(lod)
            made, drawn = kept.made, kept.drawn
        else:
            factors = hull_on_device(
                tiles,
                lod,
                camera,
                edge_rule="min" if edge_rule is None else edge_rule,
                cull=cull,
                weights=weights,
            )
            made, drawn = Tessellated.of(tiles.patch_set, factors, partitioning), None
        return made, tiles, drawn

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
        points = checked_points(points)
        with self._turns.reading():
            return heights_on_device(self._tiles, points)

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
        rays = checked_rays(origins, directions)
        with self._turns.reading():
            return rays_on_device(self._tiles, *rays)

    def _with_ladder(self) -> DeviceTiles:
        """Return the tiles with their ladder, which one of the threads that read measures."""
        with self._measuring:
            self._tiles = self._tiles.with_ladder()
            return self._tiles

    def _with_tree(self) -> DeviceTiles:
        """Return the tiles with the quadtree over them, which threads make once."""
        with self._measuring:
            self._tiles = self._tiles.with_tree(self.levels)
            return self._tiles

    def _repr_html_(self) -> str:
        from ..drawing.notebook import page

        rows, columns = self.grid.shape
        tiles = f"{rows} × {columns} of {self.grid.tile} cells"
        table = {"tiles": tiles, "device": self.device.info.name}
        if self.detail is not None:
            table["detail"] = " × ".join(f"{extent:,}" for extent in self.detail.shape)
        return page(f"Terrain {self.ground.name}", table) + self.ground._repr_html_()

    def __repr__(self) -> str:
        rows, columns = self.grid.shape
        detail = "" if self.detail is None else f", detail={self.detail!r}"
        return f"Terrain({self.ground!r}{detail}, {rows} x {columns} tiles of {self.grid.tile})"
