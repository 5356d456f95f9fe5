"""Memory of an open device: how much is in use, and what was freed and may serve again."""

from __future__ import annotations

import threading
from typing import Final

import pyopencl as cl
from pyopencl.tools import ImmediateAllocator, MemoryPool

from .drivers import require_own_process

# larger allocations are given back at once
_LARGEST_KEPT: Final = 2**28


class Memory:
    """The account of one device's memory, of `nbytes` in all.

    Attributes
    ----------
    allocated : int
        Bytes in use.
    """

    def __init__(self, nbytes: int, queue: cl.CommandQueue) -> None:
        self.allocated = 0
        self._whole, self._context = nbytes, queue.context
        self._lock = threading.RLock()  # an array may die, and be counted, in the middle of a call
        self._pool = MemoryPool(ImmediateAllocator(queue))
        self._lately = 0.0  # bytes in use at a time

    @property
    def held(self) -> int:
        """Bytes in use through the pool, or kept in it for the next."""
        held: int = self._pool.managed_bytes
        return held

    def allocate(self, nbytes: int) -> cl.MemoryObject:
        """Return memory, used before where there is some: pages new to a CPU cost most of all.

        What arrays have freed is kept for the next, which the queue's order makes safe: about as
        much as was lately in use at a time, and none where the device would run short.
        """
        require_own_process()  # before a lock that a thread may have held at the fork
        with self._lock:
            held = self._pool.managed_bytes - self._pool.active_bytes
            # half of it is forgotten in ten meshes, of some thirty arrays each
            self._lately = max(0.998 * self._lately, self._pool.active_bytes + nbytes)
            short = self._pool.managed_bytes + nbytes > self._whole // 2
            if nbytes > _LARGEST_KEPT or held > 1.5 * self._lately or short:
                self._pool.free_held()
            if nbytes > _LARGEST_KEPT:
                return cl.Buffer(self._context, cl.mem_flags.READ_WRITE, nbytes)
            return self._pool.allocate(nbytes)

    def trim(self) -> None:
        """Give back the memory that freed arrays have left for the next."""
        with self._lock:
            self._pool.free_held()

    def account(self, nbytes: int) -> None:
        """Count `nbytes` more in use, or fewer; arrays call it as they come and go."""
        with self._lock:
            self.allocated += nbytes
