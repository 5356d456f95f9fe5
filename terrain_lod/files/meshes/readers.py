"""Which reader reads a mesh file, and where: in this process or in a child."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Final

from ...arguments import file_path
from ...errors import FileError, TerrainError
from .child import read_in_child
from .draco import DRACO
from .formats import read_foreign
from .gltf import read_gltf
from .obj import read_obj
from .off import read_off
from .ply import read_ply
from .raw import RawMesh
from .stl import read_stl

# a new format is one function and one row; these look before they leap
READERS: Final[dict[str, Callable[[Path], RawMesh]]] = {
    ".glb": read_gltf,
    ".gltf": read_gltf,
    ".obj": read_obj,
    ".off": read_off,
    ".ply": read_ply,
    ".stl": read_stl,
}


def mesh_file(path: object) -> Path:
    """Return the path of a file that is there, or raise FileError."""
    found = file_path("path", path)
    if not os.path.isfile(found):  # as Path.is_file, but a folder may be closed
        raise FileError(f"expected a mesh file, got none at {found}")
    return found


def read(path: Path) -> RawMesh:
    """Return what a mesh file holds; readers that may crash do so in a child process.

    Raises
    ------
    FileError
        If it is damaged, truncated or cannot be read.
    InputError
        If there is no reader for it, or a corner is no vertex.
    MissingExtraError
        If a package is needed that is not installed.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None or (reader is read_gltf and _has_draco(path)):
        return read_in_child(path)
    return read_here(path)


def read_here(path: Path) -> RawMesh:
    """Return what a mesh file holds, read in this process. Raises the same."""
    reader = READERS.get(path.suffix.lower(), read_foreign)
    try:
        return reader(path)
    except TerrainError:
        raise
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror or error}") from None
    except MemoryError:
        raise FileError(f"cannot read {path}: it needs more memory than there is") from None
    except ValueError as error:
        first_line = (str(error).splitlines() or [""])[0]
        raise FileError(f"cannot read {path}: {first_line}") from None


def _has_draco(path: Path) -> bool:
    try:
        return DRACO.encode() in path.read_bytes()
    except OSError as error:
        raise FileError(f"cannot read {path}: {error.strerror}") from None
