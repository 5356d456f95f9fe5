"""Memory over a long flight: what the C library keeps."""

from __future__ import annotations

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
