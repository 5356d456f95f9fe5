"""The error ladder of a raster, kept beside it: measured once, read ever after."""

from __future__ import annotations

import hashlib
import zipfile
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..errors import FileError
from ..ground.relief import Relief
from ..paths import replacing

# a file of another number was measured by other rules
_VERSION: Final = 1

Arrays = dict[str, npt.NDArray[Any]]


def fingerprint(relief: Relief, tile: int) -> str:
    """Return what tells this ground in tiles of `tile` cells from any other."""
    digest = hashlib.blake2b(digest_size=16)
    for heightmap in (relief.ground, relief.detail):
        if heightmap is None:
            continue
        digest.update(repr(heightmap.shape).encode())
        digest.update(np.ascontiguousarray(heightmap.heights).data)
        if heightmap.mask is not None:
            digest.update(np.packbits(heightmap.mask).data)
    return f"{_VERSION} {tile} {relief.steps} {digest.hexdigest()}"


def write_ladder(path: Path, key: str, arrays: Arrays) -> None:
    """Write the arrays of a ladder, and what ground they are of; ``.npz``.

    Raises
    ------
    FileError
        If the file cannot be written.
    """
    with replacing(path) as temporary, temporary.open("wb") as file:
        np.savez(file, key=np.array(key), **arrays)  # type: ignore[arg-type]


def read_ladder(path: Path, key: str, expected: dict[str, tuple[int, ...]]) -> Arrays:
    """Return the arrays of a ladder, of these shapes and float32.

    Raises
    ------
    FileError
        If there is no such file, it is no ladder, or that of other ground or other tiles.
    """
    try:
        with path.open("rb") as file:
            stored = np.load(file, allow_pickle=False)
            of = str(stored["key"])
            arrays = {name: stored[name] for name in expected}
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from None
    except (ValueError, KeyError, IndexError, EOFError, zipfile.BadZipFile):
        raise FileError(
            f"expected an error ladder in {path}, got something else: save_ladder() writes one"
        ) from None
    found = {name: array.shape for name, array in arrays.items() if array.dtype == np.float32}
    if of != key or found != expected:
        raise FileError(
            f"expected the error ladder of this ground and tile size in {path}, got that of "
            "another: save_ladder() replaces it"
        )
    return arrays
