"""What all sources have in common: a place, and windows of heights."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from ..errors import FileError, InputError
from ..files.rasters.raster import Raster
from ..files.rasters.reading import Reading

Heights = npt.NDArray[np.floating[Any]]


class Source(Protocol):
    """A raster of R x C samples that need not fit into memory.

    It can be sent to other processes, which find its files under the same names.

    Attributes
    ----------
    shape : (int, int)
        R and C.
    reading : Reading
        Where it stands, and how its numbers become heights.
    is_exact : bool
        Whether float32 holds its heights as they are.
    """

    @property
    def shape(self) -> tuple[int, int]: ...
    @property
    def reading(self) -> Reading: ...
    @property
    def is_exact(self) -> bool: ...

    def read(self, rows: slice, columns: slice) -> Heights:
        """Return heights of a window, row 0 north, NaN where there is no data.

        Raises
        ------
        InputError
            If some are infinite.
        FileError
            If a file cannot be read.
        """
        ...

    def fingerprint(self) -> str:
        """Return what is another when the source has changed."""
        ...


def virtual(shape: tuple[int, int], dtype: npt.DTypeLike) -> npt.NDArray[Any]:
    """Return an array of a shape and a type that takes no memory, for headers."""
    return np.broadcast_to(np.zeros((), dtype), shape)


def is_exact(reading: Reading, header: Raster) -> bool:
    """Return whether float32 holds heights of this reading as they are."""
    dtype = header.values.dtype
    return reading.is_plain(header) and (dtype.itemsize < 4 or dtype == np.float32)


def heights_of(reading: Reading, raster: Raster, row: int, column: int) -> Heights:
    """Return a part's heights, NaN where there is no data; its first sample is [row, column]."""
    hole, heights = reading.holes(raster), reading.heights(raster)
    if heights.dtype.kind not in "biuf":
        raise InputError(f"expected real heights, got an array of {heights.dtype}")
    if heights.dtype.kind != "f" or heights.dtype.itemsize < 4:
        heights = heights.astype(np.float32 if heights.dtype.itemsize < 4 else np.float64)
    elif heights is raster.values:
        heights = heights.copy()
    if hole is not None:
        heights[hole] = np.nan
    infinite = np.isinf(heights)
    if infinite.any():
        found = np.argwhere(infinite)[0]
        raise InputError(
            f"expected finite heights in {reading.name}, got {heights[tuple(found)]} at "
            f"[{row + found[0]}, {column + found[1]}]: nodata= leaves such a value out"
        )
    return heights


def fingerprint_of_files(paths: list[Path], options: object) -> str:
    """Return what is another when one of the files was written, or is read in another way."""
    digest = hashlib.sha256(repr(options).encode())
    for path in paths:
        try:
            found = path.stat()
        except OSError as error:
            raise FileError(f"cannot read {path}: {error.strerror}") from None
        digest.update(f"{path.name} {found.st_size} {found.st_mtime_ns}\n".encode())
    return digest.hexdigest()
