"""A terrain over a pyramid on disk that holds a bounded part of it.

::

    camera ─▶ cut through the levels ─▶ chunks, read where they are missing ─▶ a mesh of each
                  ▲                                                                │
                  └────── finer, or asked for less, where the promise ◀── joined ◀─┘
                          does not hold
"""

from __future__ import annotations

import os
import threading
from collections import OrderedDict
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import file_path, flag, instance
from ..camera.camera import Camera
from ..device.device import Device
from ..errors import InputError
from ..ground.heightmap import Heightmap
from ..mesh.hits import Hits, checked_points, checked_rays
from ..mesh.mesh import Achieved, Mesh
from ..pyramid.store import Store
from ..terrain.lod import PromiseLod
from ..terrain.lod_promises import MaxErrorLod, ScreenErrorLod
from .cut import Chunks, Cut, Place
from .gathered import Gathered, grid_of
from .join import join
from .memory import bytes_of
from .piece import Piece
from .rays import chunks_on_ray
from .view import Asked
from .window import Window, window_bytes

# of what is asked, so much is asked of a chunk alone at first: joints, and of coarse levels the
# samples that they leave out, take the rest
_FIRST_SHARE: Final = 0.7
_FINEST_SHARE: Final = 0.95
# what exceeds is asked for less, by so much more than it exceeds
_LESS: Final = 0.97
# a chunk that would be asked for less than this is split
_LEAST_SHARE: Final = 0.25
_MOST_ROUNDS: Final = 12
# chunks that any view needs: one of each level around the eye, and those beside it
_LEAST_CHUNKS: Final = 8


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
        there, the coarsest first.
    """

    def __init__(
        self, store: Store, *, memory: int | str | None = None, device: Device | None = None
    ) -> None:
        self.store = instance("a Store for store", store, Store)
        self.device = Device.of(device)
        self.memory = bytes_of(memory)
        self._chunks, self._each = Chunks(store), window_bytes(store.division.chunk)
        least = self._each * _LEAST_CHUNKS
        if self.memory < least:
            raise InputError(
                f"expected memory of at least {least / 1e6:,.3g} MB for chunks of "
                f"{store.division.chunk} cells, got {self.memory / 1e6:,.3g} MB"
            )
        self._most = self.memory // self._each
        self._held: OrderedDict[Place, Window] = OrderedDict()
        self._coming: dict[Place, Future[Window]] = {}
        self._lock, self._meshing = threading.RLock(), threading.Lock()
        # one reader: coarse chunks come before fine ones
        self._reader = ThreadPoolExecutor(1, "terrain_lod reader")
        self._before: Camera | None = None
        self.missing: tuple[Place, ...] = ()

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

    @property
    def overview(self) -> Heightmap:
        """The coarsest level, as a heightmap by itself: to find one's way, not to measure."""
        return self._window(self._chunks.root).terrain.ground

    @property
    def held(self) -> int:
        """Bytes of ground that are held now."""
        with self._lock:
            return len(self._held) * self._each

    @property
    def in_flight(self) -> int:
        """Chunks that are being read."""
        with self._lock:
            return len(self._coming)

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
            mesh = self._kept(asked, wait)
            self._look_ahead(asked)
        return mesh

    def height_at(self, points: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Return the ground's elevations at points of the world; as :meth:`Terrain.height_at`.

        Parameters
        ----------
        points : array_like, (N, 2)
        """
        points = checked_points(points)
        own, (dx, dy) = self.store.description, self.spacing
        cells = (points - [*own.origin]) / [dx, -dy]
        inside = ((cells >= 0) & (cells <= [own.columns - 1, own.rows - 1])).all(axis=1)
        found, size = np.full(len(points), np.nan), self.store.division.chunk
        chunks = np.minimum(
            np.maximum(cells // size, 0), np.array(self.store.division.chunks(0))[::-1] - 1
        ).astype(int)
        for column, row in np.unique(chunks[inside], axis=0).tolist():
            these = inside & (chunks == (column, row)).all(axis=1)
            if self._has_data((0, row, column)):
                found[these] = self._window((0, row, column)).terrain.height_at(points[these])
        return found

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
        starts, ways = checked_rays(origins, directions)
        count = len(starts)
        found = Hits(
            np.full((count, 3), np.nan), np.full(count, np.nan), np.full(count, -1, np.int32),
            np.full(count, -1, np.int32), np.full((count, 2), np.nan, np.float32),
            np.full((count, 3), np.nan),
        )  # fmt: skip
        ahead = [
            list(chunks_on_ray(self._chunks, start, way))
            for start, way in zip(starts, ways, strict=True)
        ]
        # the next chunk of every ray that has met nothing yet, until none has one
        while any(ahead):
            by_chunk: dict[Place, list[int]] = {}
            for ray, places in enumerate(ahead):
                if places:
                    by_chunk.setdefault(places.pop(0), []).append(ray)
            for place, rays in by_chunk.items():
                hits = self._window(place).terrain.cast(starts[rays], ways[rays])
                for number, ray in enumerate(rays):
                    if hits.hit[number]:
                        found.position[ray] = hits.position[number]
                        found.distance[ray] = hits.distance[number]
                        found.normal[ray] = hits.normal[number]
                        ahead[ray] = []
        return found

    def _kept(self, asked: Asked, wait: bool) -> Mesh:
        """Cut, mesh and join until what is asked holds, or nothing more can be done."""
        shares: dict[Place, float] = {}
        made: dict[tuple[Place, float], tuple[Piece, Mesh]] = {}
        finer: frozenset[Place] = frozenset()
        for rounds in range(1, _MOST_ROUNDS + 1):  # noqa: B007
            cut = self._cut(asked, wait, finer)
            for place in cut.places:
                shares.setdefault(place, _FIRST_SHARE if place[0] else _FINEST_SHARE)
            wanted = [(place, shares[place]) for place in cut.places]
            made = {key: made[key] if key in made else self._piece(asked, *key) for key in wanted}
            meshes = [made[key][1] for key in wanted]
            joined = [
                self._window(place).measured(piece, mesh)
                for place, piece, mesh in zip(
                    cut.places, join([made[key][0] for key in wanted]), meshes, strict=True
                )
            ]
            failing = {
                place: used
                for place, used in zip(cut.places, map(_used, joined), strict=True)
                if used > 1.0
            }
            before, split = dict(shares), set(finer)
            for place, used in failing.items():
                less = shares[place] * _LESS / min(used, 2.0)
                if less >= _LEAST_SHARE:
                    shares[place] = less
                elif place[0] > 0 and cut.is_enough:
                    split.add(place)
            if before == shares and split == set(finer):
                break
            finer = frozenset(split)
        self.missing = cut.missing
        return self._whole(asked, cut, joined, meshes, rounds)

    def _piece(self, asked: Asked, place: Place, share: float) -> tuple[Piece, Mesh]:
        return self._window(place).piece(asked, _part_of(asked, share))

    def _cut(self, asked: Asked, wait: bool, finer: frozenset[Place]) -> Cut:
        cut = self._chunks.cut(asked, self._most, finer=finer)
        if wait:
            return cut
        self._window(self._chunks.root)
        with self._lock:
            held = set(self._held)
        cut = self._chunks.at_hand(cut, held)
        self._read_ahead(list(cut.missing))
        return cut

    def _whole(
        self, asked: Asked, cut: Cut, pieces: list[Piece], meshes: list[Mesh], rounds: int
    ) -> Mesh:
        """Put joined pieces into one mesh."""
        own, (dx, dy) = self.store.description, self.spacing
        first = np.zeros(2)
        if asked.camera is not None:
            # floats are finest near zero: there the eye is
            eye = (np.array(asked.camera.eye[:2]) - [*own.origin]) / [dx, -dy]
            first = np.clip(np.round(eye), 0, [own.columns - 1, own.rows - 1])
        patches = Gathered()
        for piece, mesh, place in zip(pieces, meshes, cut.places, strict=True):
            patches.add(piece, mesh, place, self.store.division.chunk)
        places, heights, normals, triangles = patches.arrays()
        vertices = np.empty((len(places), 3), np.float32)
        vertices[:, :2] = (places - first) * [dx, -dy]
        vertices[:, 2] = heights
        (x, y), (column, row) = own.origin, first
        worst = max((float(piece.errors.max(initial=0.0)) for piece in pieces), default=0.0)
        used = max((_used(piece) for piece in pieces), default=0.0)
        pixels = None if np.isinf(asked.pixels) else asked.pixels * used
        return Mesh(
            vertices,
            normals,
            triangles,
            origin=np.array([x + column * dx, y - row * dy, own.base]),
            crs=own.crs,
            patches=patches.patches(grid_of(own.rows, own.columns, own.spacing)),
            achieved=Achieved(worst, pixels, used <= 1.0, rounds),
        )

    def _window(self, place: Place) -> Window:
        """Return a chunk, from what is held or from the store."""
        with self._lock:
            if place in self._held:
                self._held.move_to_end(place)
                return self._held[place]
            coming = self._coming.get(place)
        window = coming.result() if coming is not None else self._read(place)
        with self._lock:
            # it may have gone again meanwhile
            self._keep(place, window)
        return window

    def _read(self, place: Place) -> Window:
        return Window.of(self.store, place, self.device)

    def _keep(self, place: Place, window: Window) -> None:
        self._held[place] = window
        self._held.move_to_end(place)
        while len(self._held) > self._most:
            self._held.popitem(last=False)

    def _read_ahead(self, places: list[Place]) -> None:
        """Let the reader bring chunks, unless they are here or on their way."""
        with self._lock:
            for place in places:
                if place not in self._held and place not in self._coming:
                    self._coming[place] = self._reader.submit(self._bring, place)

    def _bring(self, place: Place) -> Window:
        try:
            window = self._read(place)
            with self._lock:
                self._keep(place, window)
            return window
        finally:
            with self._lock:
                self._coming.pop(place, None)

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
        self._read_ahead(list(self._chunks.cut(replace(asked, camera=ahead), self._most).places))

    def _has_data(self, place: Place) -> bool:
        level, row, column = place
        return not np.isnan(self._chunks.known(level).ranges[row, column, 0])

    def __repr__(self) -> str:
        rows, columns = self.shape
        return (
            f"StreamingTerrain({self.store.description.name}: {rows:,} x {columns:,} samples, "
            f"{self.held / 1e6:,.3g} of {self.memory / 1e6:,.3g} MB held)"
        )


def _part_of(asked: Asked, share: float) -> PromiseLod:
    """Return a part of the error that is asked for, as a level of detail."""
    if asked.camera is not None and not np.isinf(asked.pixels):
        return ScreenErrorLod(pixels=asked.pixels * share)
    return MaxErrorLod(metres=asked.metres * share)


def _used(piece: Piece) -> float:
    """Return the largest error of a patch as a part of what it is allowed."""
    with np.errstate(divide="ignore", invalid="ignore"):
        used = np.where(piece.errors > 0, piece.errors / piece.allowed, 0.0)
    return float(used.max(initial=0.0))
