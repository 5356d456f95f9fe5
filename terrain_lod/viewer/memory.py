"""Memory over a long flight: what the C library keeps, and Python's collector of cycles."""

from __future__ import annotations

import gc
from contextlib import suppress
from ctypes import CDLL
from typing import Final

# glibc's names
_M_TRIM_THRESHOLD: Final = -1
_M_MMAP_THRESHOLD: Final = -3
_LARGE: Final = 2**22  # bytes: more than most arrays of a view
_KEPT: Final = 2**25  # of what smaller blocks have left, for pages that are new cost most of all


def keep_large_blocks_apart() -> None:
    """Have the C library give large blocks back as they are freed and keep small ones, if glibc.

    By itself it learns from the first large block that is freed to keep such blocks, and meshes of
    ever other sizes leave holes between them. This is for the whole process.
    """
    # others do not know it
    with suppress(AttributeError, OSError, TypeError):
        CDLL(None).mallopt(_M_MMAP_THRESHOLD, _LARGE)
        CDLL(None).mallopt(_M_TRIM_THRESHOLD, _KEPT)


class Collector:
    """Python's collector of cycles, off by itself from the first that wants so to the last."""

    def __init__(self) -> None:
        self._holders: set[object] = set()
        self._was_on = False

    def hold(self, holder: object) -> None:
        """Have it off until :meth:`release`, whoever else is done before."""
        if not self._holders:
            self._was_on = gc.isenabled()
            gc.disable()
        self._holders.add(holder)

    def release(self, holder: object) -> None:
        """Turn it on as it was if nobody else wants it off."""
        if self._holders == {holder} and self._was_on:
            gc.enable()
        self._holders.discard(holder)


COLLECTOR: Final = Collector()
