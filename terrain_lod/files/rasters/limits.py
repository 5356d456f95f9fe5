"""Bytes that a raster will need, refused before they are taken."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from ...errors import InputError

# while heights become ground: float32 beside masks and what compares them
WORK_BYTES: Final = 8
# heights and mask in the memory of a device
DEVICE_BYTES: Final = 5


def require_memory(
    rows: int, columns: int, dtype: npt.DTypeLike, name: str, ways: str = "window= or bounds="
) -> None:
    """Refuse a raster that will not fit into the memory that is free, before it is read.

    Parameters
    ----------
    rows, columns : int
        Samples, as the header of a file has them.
    dtype : dtype
        Of the samples in the file.
    name : str
        Of the file.
    ways : str
        What to give so that less is read.

    Raises
    ------
    InputError
        With the bytes needed here and on a device, and those that are free.
    """
    # the samples, and as many again while those with data are looked at
    needed = rows * columns * (2 * np.dtype(dtype).itemsize + WORK_BYTES)
    free = free_memory()
    if free is not None and needed > free:
        raise InputError(
            f"expected a raster that fits into {_size(free)} of free memory, got {rows:,} x "
            f"{columns:,} samples in {name}, which need {_size(needed)} here and "
            f"{_size(rows * columns * DEVICE_BYTES)} on a device: read a part with {ways}"
        )


def free_memory() -> int | None:
    """Return the bytes that this process may still take, None if the system does not say."""
    known = [
        bytes_free
        for bytes_free in (_available(), _within_group(), _within_limit())
        if bytes_free is not None
    ]
    return max(min(known), 0) if known else None


def _available() -> int | None:
    """Return what Linux could hand out without swapping."""
    return _entry(Path("/proc/meminfo"), "MemAvailable:")


def _within_group() -> int | None:
    """Return what the control group, a container's, leaves; its file cache counts as free."""
    folder = Path("/sys/fs/cgroup")
    try:
        limit = (folder / "memory.max").read_text().strip()
        used = int((folder / "memory.current").read_text())
        cached = _entry(folder / "memory.stat", "inactive_file", unit=1) or 0
        return None if limit == "max" else int(limit) - used + cached
    except (OSError, ValueError):
        return None


def _within_limit() -> int | None:
    """Return what the limit of the address space, ``ulimit -v``, leaves."""
    try:
        import resource

        limit = resource.getrlimit(resource.RLIMIT_AS)[0]
        pages = int(Path("/proc/self/statm").read_text().split()[0])
    except (ImportError, OSError, ValueError):
        return None
    return None if limit == resource.RLIM_INFINITY else limit - pages * os.sysconf("SC_PAGE_SIZE")


def _entry(path: Path, key: str, unit: int = 1024) -> int | None:
    try:
        lines = path.read_text().splitlines()
    except OSError:
        return None
    return next((int(line.split()[1]) * unit for line in lines if line.startswith(key)), None)


def _size(count: float) -> str:
    """Return bytes as people read them: ``17.4 GB``."""
    names = ["bytes", "kB", "MB", "GB", "TB"]
    while count >= 1000 and len(names) > 1:
        count /= 1000
        del names[0]
    return f"{count:,.3g} {names[0]}" if count < 1000 else f"{count:,.0f} {names[0]}"
