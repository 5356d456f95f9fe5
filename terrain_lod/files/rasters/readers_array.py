"""NumPy's files: an array, or an archive of them."""

from __future__ import annotations

import math
import zipfile
from pathlib import Path
from typing import IO, Any, Final

import numpy as np

from ...errors import FileError, InputError
from .limits import require_memory
from .parts import Part
from .raster import Raster

# what people call the heights among other arrays
HEIGHT_NAMES: Final[tuple[str, ...]] = ("heights", "height", "elevation", "dem", "z")

Header = tuple[tuple[int, ...], "np.dtype[Any]"]


def read_numpy(path: Path, part: Part) -> Raster:
    """Read an array, or of an archive the only 2-D array of numbers or the one named as heights."""
    part.require_one_band(path.name)
    with path.open("rb") as file:
        packed = file.read(2) == b"PK"
    if packed:
        return part.cut(_of_archive(path), path.name)
    # mapped, so a part of an array is read alone, and one that the file cannot hold is none
    try:
        values = np.lib.format.open_memmap(path, mode="r")
    except MemoryError:
        # a map takes none: the words of the header were too many for Python's parser
        raise FileError(f"expected a NumPy array in {path.name}, got a damaged header") from None
    raster = part.cut(Raster(values), path.name)
    if raster.values.ndim == 2:
        rows, columns = raster.values.shape
        require_memory(rows, columns, raster.values.dtype, path.name)
    return Raster(np.array(raster.values))


def _of_archive(path: Path) -> Raster:
    with zipfile.ZipFile(path) as archive:
        arrays: dict[str, Header] = {}
        for member in archive.infolist():
            if member.filename.endswith(".npy"):
                with archive.open(member) as file:
                    shape, dtype = _header(file)
                    size = file.tell() + math.prod(shape) * dtype.itemsize
                if size != member.file_size:
                    raise FileError(
                        f"expected {size} bytes of {member.filename} in {path.name}, got "
                        f"{member.file_size}: damaged?"
                    )
                arrays[member.filename.removesuffix(".npy")] = shape, dtype
        grids = [key for key, (shape, dtype) in arrays.items()
                 if len(shape) == 2 and dtype.kind in "iuf"]  # fmt: skip
        if len(grids) != 1:
            grids = [key for key in HEIGHT_NAMES if key in grids][:1]
        if not grids:
            found = ", ".join(f"{key} {shape}" for key, (shape, _) in arrays.items()) or "nothing"
            raise InputError(
                f"expected one 2-D array of heights in {path.name}, or one named "
                f"{' or '.join(HEIGHT_NAMES)}; got {found}"
            )
        (rows, columns), dtype = arrays[grids[0]]
        require_memory(rows, columns, dtype, path.name)
        with archive.open(f"{grids[0]}.npy") as file:
            return Raster(np.lib.format.read_array(file, allow_pickle=False))


def _header(file: IO[bytes]) -> Header:
    """Return shape and type of an array, from the first bytes of its file."""
    version = np.lib.format.read_magic(file)
    read = (
        np.lib.format.read_array_header_1_0
        if version == (1, 0)
        else np.lib.format.read_array_header_2_0
    )
    shape, _, dtype = read(file)
    if dtype.hasobject or not all(extent >= 0 for extent in shape):
        raise FileError(f"expected an array of numbers, got {dtype} of shape {shape}")
    return shape, dtype
