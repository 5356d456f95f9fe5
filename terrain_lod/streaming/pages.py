"""Chunks that are held, and the reader that brings more."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Iterable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final

from ..device.device import Device
from ..errors import FileError, InputError
from ..pyramid.store import Store
from .cut import Place
from .window import Window, window_bytes

# chunks that any view needs: one of each level around the eye, and those beside it
_LEAST: Final = 8


class Pages:
    """A bounded number of chunks of a store; the least recently used goes first.

    Parameters
    ----------
    store : Store
    device : Device
    memory : int
        Bytes.

    Attributes
    ----------
    most : int
        Chunks that are held at most.
    damaged : dict of Place to str
        What the reader could not read, and why; it does not try again.

    Raises
    ------
    InputError
        If the memory is less than a view needs at least, which is said.
    """

    def __init__(self, store: Store, device: Device, memory: int) -> None:
        self._store, self._device = store, device
        self._each = window_bytes(store.division.chunk)
        least = self._each * _LEAST
        if memory < least:
            raise InputError(
                f"expected memory of at least {least / 1e6:,.3g} MB for chunks of "
                f"{store.division.chunk} cells, got {memory / 1e6:,.3g} MB"
            )
        self.most = memory // self._each
        self._held: OrderedDict[Place, Window] = OrderedDict()
        self._coming: dict[Place, Future[Window]] = {}
        self._lock = threading.RLock()
        # one reader: coarse chunks come before fine ones
        self._reader = ThreadPoolExecutor(1, "terrain_lod reader")
        self.damaged: dict[Place, str] = {}

    def here(self) -> dict[Place, Window]:
        """Return what is held now."""
        with self._lock:
            return dict(self._held)

    @property
    def bytes(self) -> int:
        """Bytes that are held now."""
        with self._lock:
            return len(self._held) * self._each

    @property
    def in_flight(self) -> int:
        """Chunks that are being read."""
        with self._lock:
            return len(self._coming)

    def get(self, place: Place) -> Window:
        """Return a chunk, read now if it is not held.

        Raises
        ------
        FileError
            If it is missing or damaged; names it.
        """
        with self._lock:
            if place in self._held:
                self._held.move_to_end(place)
                return self._held[place]
            coming = self._coming.get(place)
        window = coming.result() if coming is not None else self._read(place)
        self._keep(place, window)
        return window

    def ahead(self, places: Iterable[Place]) -> None:
        """Let the reader bring chunks, unless they are here or on their way."""
        with self._lock:
            for place in places:
                known = self._held, self._coming, self.damaged
                if not any(place in those for those in known):
                    self._coming[place] = self._reader.submit(self._bring, place)

    def forget(self) -> None:
        """Hold nothing, for the store has changed."""
        with self._lock:
            for coming in self._coming.values():
                coming.cancel()
            self._coming.clear()
            self._held.clear()
            self.damaged.clear()

    def _read(self, place: Place) -> Window:
        return Window.of(self._store, place, self._device)

    def _keep(self, place: Place, window: Window) -> None:
        with self._lock:
            self._held[place] = window
            self._held.move_to_end(place)
            while len(self._held) > self.most:
                self._held.popitem(last=False)

    def _bring(self, place: Place) -> Window:
        try:
            window = self._read(place)
            self._keep(place, window)
            return window
        except FileError as error:
            with self._lock:
                self.damaged[place] = str(error)
            raise
        finally:
            with self._lock:
                self._coming.pop(place, None)
