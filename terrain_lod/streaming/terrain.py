"""A terrain over a pyramid on disk that holds a bounded part of it.

::

    camera ─▶ cut through the levels ─▶ chunks, read where they are missing ─▶ joined ─▶ Mesh
"""

from __future__ import annotations

import os
import threading
from dataclasses import replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from ..arguments import array, file_path, finite, flag, instance
from ..camera.camera import Camera
from ..device.device import Device
from ..errors import InputError
from ..ground.heightmap import Heightmap, within
from ..mesh.hits import Hits, checked_points, checked_rays
from ..mesh.mesh import Mesh
from ..pyramid.store import Store
from ..pyramid.update import update
from ..terrain.lod import PromiseLod
from ..terrain.lod_promises import MaxErrorLod, ScreenErrorLod
from .cut import Chunks, Cut, Place, with_above
from .gathered import whole
from .keeping import Joined, keep
from .memory import bytes_of
from .pages import Pages
from .rays import first_hits
from .view import Asked


def open(
    path: str | os.PathLike[str],
    *,
    memory: int | str | None = None,
    device: Device | None = None,
) -> StreamingTerrain:
    """Open a pyramid that :func:`build` made, as a terrain that holds a bounded part of it.

    Parameters
    ----------
    path : str or path
    memory : int or str, optional
        Bytes of ground to hold, such as ``"512MB"``; a quarter of what is free where not given.
    device : Device, optional

    Raises
    ------
    FileError
        If there is no finished store, or what is asked of it first is damaged.
    InputError
        If `memory` is none, or less than a view needs at least, which is said.
    MissingExtraError
        If zarr is not installed.
    """
    store = Store.open(file_path("path", path))
    return StreamingTerrain(store, memory=memory, device=device)


class StreamingTerrain:
    """Ground of any size: what a view needs is read and held, and no more.

    Parameters
    ----------
    store : Store
    memory : int or str, optional
    device : Device, optional

    Attributes
    ----------
    store : Store
    device : Device
    memory : int
        Bytes of ground that are held at most.
    missing : tuple of (int, int, int)
        Level, row and column of the chunks that the last mesh would have had but that were not
        there but can be read, the coarsest first.
    """

    def __init__(
        self, store: Store, *, memory: int | str | None = None, device: Device | None = None
    ) -> None:
        store = instance("a Store for store", store, Store)
        self.device, self.memory = Device.of(device), bytes_of(memory)
        self._meshing = threading.Lock()
        self._hold(store)

    def _hold(self, store: Store) -> None:
        """Begin with a store of which nothing is held."""
        self.store = store
        self._chunks, self._pages = Chunks(store), Pages(store, self.device, self.memory)
        self._before: Camera | None = None
        self._joined: Joined | None = None
        self.missing: tuple[Place, ...] = ()
        vars(self).pop("overview", None)

    @property
    def shape(self) -> tuple[int, int]:
        """Samples along y and x."""
        own = self.store.description
        return own.rows, own.columns

    @property
    def spacing(self) -> tuple[float, float]:
        return self.store.description.spacing

    @property
    def origin(self) -> tuple[float, float, float]:
        """World point of sample [0, 0], and what heights are relative to."""
        own = self.store.description
        return *own.origin, own.base

    @property
    def crs(self) -> str | None:
        return self.store.description.crs

    @property
    def height_range(self) -> tuple[float, float]:
        """Lowest and highest elevation."""
        own, top = self.store.description, self.store.division.top
        low, high = self._chunks.known(top).ranges.reshape(2).tolist()
        return own.base + low, own.base + high

    @cached_property
    def overview(self) -> Heightmap:
        """The coarsest level, as a heightmap by itself: to find one's way, not to measure."""
        return self._pages.get(self._chunks.root).terrain.ground

    @property
    def held(self) -> int:
        """Bytes of ground that are held now."""
        return self._pages.bytes

    @property
    def in_flight(self) -> int:
        """Chunks that are being read."""
        return self._pages.in_flight

    @property
    def damage(self) -> tuple[str, ...]:
        """A line for each chunk that ``wait=False`` could not have read; coarser ones stand in."""
        return tuple(self._pages.damaged.values())

    def mesh(
        self,
        camera: Camera | None = None,
        *,
        lod: PromiseLod | None = None,
        cull: bool = True,
        wait: bool = True,
    ) -> Mesh:
        """Return the mesh that keeps an error, of as coarse levels as do.

        Parameters
        ----------
        camera : Camera, optional
            Without one, all of the ground is meshed.
        lod : MaxErrorLod or ScreenErrorLod, optional
            Defaults to ``ScreenErrorLod(1.0)``.
        cull : bool, optional
            Leave out what is out of view.
        wait : bool, optional
            Read what is missing first. Else the mesh is made of what is held, with
            ``achieved.kept`` false where that is not enough, and what is missing is read
            meanwhile: see ``missing``.

        Returns
        -------
        Mesh
            Watertight, whatever levels meet. ``achieved`` is a bound for every sample of the
            source; ``kept`` is false where the memory does not suffice for what was asked.

        Raises
        ------
        InputError
            If `lod` is neither of these, or needs a camera and there is none.
        FileError
            If a chunk is missing or damaged; names it.
        """
        lod = ScreenErrorLod() if lod is None else lod
        kept = "MaxErrorLod or ScreenErrorLod of a pyramid"
        lod = instance(kept, lod, MaxErrorLod | ScreenErrorLod)
        if camera is not None:
            instance("a Camera for camera", camera, Camera)
        cull, wait = flag("cull", cull), flag("wait", wait)
        if camera is None and lod.needs_camera:
            raise InputError(f"{type(lod).__name__} needs a camera, got none")
        asked = Asked(camera, lod.metres, lod.pixels, cull and camera is not None)
        with self._meshing:
            found = self._kept(asked, wait)
            self._look_ahead(asked)
        return whole(self.store, asked, found)

    def height_at(self, points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Return the ground's elevations at points of the world; as :meth:`Terrain.height_at`.

        Parameters
        ----------
        points : array_like, (N, 2)
        """
        points = checked_points(points)
        rows, columns = self.shape
        cells = (points - [*self.store.description.origin]) / np.array(self.spacing) * [1, -1]
        inside = ((cells >= 0) & (cells <= [columns - 1, rows - 1])).all(axis=1)
        found, chunks = np.full(len(points), np.nan), self._chunks.at(cells)
        for column, row in np.unique(chunks[inside], axis=0).tolist():
            these = inside & (chunks == (column, row)).all(axis=1)
            if self._has_data((0, row, column)):
                found[these] = self._pages.get((0, row, column)).terrain.height_at(points[these])
        return found

    def update(self, rows: slice, columns: slice, heights: npt.ArrayLike) -> None:
        """Replace samples in the store, all that is known of them, and what is held.

        The store is then as if it had been built of the new ground, but that it is not its source's
        any more. Where this is cut off it has to be built anew. Not while other threads ask.

        Parameters
        ----------
        rows, columns : slice
            Which samples: within the raster, without a step.
        heights : array_like of these samples, any real dtype
            Elevations in the world. NaN and masked elements are nodata from now on.

        Raises
        ------
        InputError
            If the slices reach out of the raster, the shape is another, heights are infinite, or
            no data would be left.
        FileError
            If the store cannot be written, or another process is at work on it.
        """
        part = within("rows", rows, self.shape[0]), within("columns", columns, self.shape[1])
        shape = tuple(piece.stop - piece.start for piece in part)
        values = array("heights", heights, shape, None, is_finite=False).astype(np.float64)
        values[np.ma.getmaskarray(np.ma.asarray(heights))] = np.nan
        with self._meshing:
            self._hold(update(self.store, *part, values))

    def ground_near(self, x: float, y: float) -> Heightmap:
        """Return the finest ground that is held around a point, or the nearest. Reads nothing.

        Parameters
        ----------
        x, y : float
            World units.
        """
        point = [[finite("x", x), finite("y", y)]]
        cells = (np.array(point) - [*self.store.description.origin]) / np.array(self.spacing)
        column, row = self._chunks.at(cells * [1, -1])[0].tolist()
        held = self._pages.here()
        found = next((held[place] for place in with_above((0, row, column)) if place in held), None)
        return self.overview if found is None else found.terrain.ground

    def cast(self, origins: npt.ArrayLike, directions: npt.ArrayLike) -> Hits:
        """Find what rays meet first of the ground; as :meth:`Terrain.cast`, but for the tiles.

        Parameters
        ----------
        origins, directions : array_like, (N, 3)

        Returns
        -------
        Hits
            `tile` is -1.
        """
        return first_hits(self._chunks, self._pages.get, *checked_rays(origins, directions))

    def _kept(self, asked: Asked, wait: bool) -> Joined:
        """Return the chunks that keep what is asked, or of those at hand, what comes next to it."""
        if wait:
            found = keep(
                asked,
                lambda finer: self._chunks.cut(asked, self._pages.most, finer=finer),
                self._pages.get,
                self._joined,
            )
        else:
            self._pages.get(self._chunks.root)
            # what the reader puts out meanwhile stays until the mesh is there
            held = self._pages.here()

            def cut(finer: frozenset[Place]) -> Cut:
                wanted = self._chunks.cut(asked, self._pages.most, finer=finer)
                return self._chunks.at_hand(wanted, held)

            found = keep(asked, cut, held.__getitem__, self._joined)
            self._pages.ahead(found.cut.missing)
        self._joined, damaged = found, self._pages.damaged
        self.missing = tuple(place for place in found.cut.missing if place not in damaged)
        return found

    def _look_ahead(self, asked: Asked) -> None:
        """Read what the camera will see if it goes on as it went since the last mesh."""
        camera, before = asked.camera, self._before
        self._before = camera
        if camera is None or before is None or camera.eye == before.eye:
            return
        if self.in_flight:
            return
        way = np.subtract(camera.eye, before.eye)
        try:
            x, y, z = way + camera.target
            ahead = replace(camera, eye=tuple(way + camera.eye), target=(x, y, z))
        except InputError:
            return  # beyond all numbers
        self._pages.ahead(self._chunks.cut(replace(asked, camera=ahead), self._pages.most).places)

    def _has_data(self, place: Place) -> bool:
        level, row, column = place
        return not np.isnan(self._chunks.known(level).ranges[row, column, 0])

    def __repr__(self) -> str:
        rows, columns = self.shape
        return (
            f"StreamingTerrain({self.store.description.name}: {rows:,} x {columns:,} samples, "
            f"{self.held / 1e6:,.3g} of {self.memory / 1e6:,.3g} MB held)"
        )
