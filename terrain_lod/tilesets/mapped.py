"""Ground larger than memory: its heights in a file, of which what is looked at is in memory.

A lattice of a coarse tile asks for heights all over the ground, in an order of its own. So they are
in a file of float32 that is mapped; pages that were looked at are given back.
"""

from __future__ import annotations

import mmap
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

# heights taken together: each may bring 64 KiB of the file into memory
_TAKEN: Final = 1 << 12


@dataclass(frozen=True)
class MappedGround:
    """What a :class:`~terrain_lod.ground.heightmap.Heightmap` says of itself, without its heights.

    It can be sent to other processes of this machine, which map the same file.

    Attributes
    ----------
    path : Path
        R x C float32, row 0 north, relative to the base.
    shape : (int, int)
    spacing, origin : (float, float)
    base : float
    crs : str or None
    units : (str, str)
    height_range : (float, float)
    fingerprint : str
        Another when the source has changed.
    """

    path: Path
    shape: tuple[int, int]
    spacing: tuple[float, float]
    origin: tuple[float, float]
    base: float
    crs: str | None
    units: tuple[str, str]
    height_range: tuple[float, float]
    fingerprint: str
    mask: None = None

    @cached_property
    def heights(self) -> npt.NDArray[np.float32]:
        return np.memmap(self.path, np.float32, "r", shape=self.shape)

    def __reduce__(self) -> tuple[type[MappedGround], tuple[Any, ...]]:
        return MappedGround, tuple(getattr(self, name) for name in self.__dataclass_fields__)

    def with_crs(self, crs: str) -> MappedGround:
        return replace(self, crs=crs)

    def take(self, numbers: npt.NDArray[np.int64]) -> npt.NDArray[np.float32]:
        """Return the heights of these samples, numbered row by row."""
        taken = np.empty(numbers.shape, np.float32)
        flat, into, asked = self.heights.reshape(-1), taken.reshape(-1), numbers.reshape(-1)
        for first in range(0, len(asked), _TAKEN):
            part = slice(first, first + _TAKEN)
            into[part] = flat[asked[part]]
            self.release()
        return taken

    def release(self) -> None:
        """Give back the memory of what was looked at."""
        mapped: Any = self.heights
        mapped._mmap.madvise(mmap.MADV_DONTNEED)
