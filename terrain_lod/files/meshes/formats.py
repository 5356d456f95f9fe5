"""Meshes that VTK has no reader for, by way of meshio: Gmsh, Abaqus, Medit, OFF and more."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path
from typing import Any

from ...errors import FileError, InputError, MissingExtraError
from ...mesh.soundness import require_sound


def is_abaqus(path: Path) -> bool:
    """Return True for the one of two formats with the ending .inp that VTK cannot read."""
    if path.suffix.lower() != ".inp":
        return False
    with path.open("rb") as file:
        return file.read(1) == b"*"


def read_with_meshio(path: Path) -> Any:
    """Return the pyvista.UnstructuredGrid of a file.

    Raises
    ------
    MissingExtraError
        If there is no meshio here.
    InputError
        If meshio does not know the ending either, or a cell's corners are no points.
    FileError
        If the file is damaged.
    """
    import pyvista

    try:
        import meshio
    except ImportError:
        raise MissingExtraError(
            f"expected .glb, .gltf, .obj, .ply, .stl, .vtk, .vtp, .vtu or another that VTK reads, "
            f"got {path.name}: for more formats, install 'terrain_lod[meshes]'"
        ) from None
    if path.suffix.lower() not in meshio.extension_to_filetypes:
        raise InputError(
            f"unknown mesh format {path.suffix!r}: expected .glb, .obj, .ply, .stl, .vtp or "
            f"another that pyvista or meshio reads, got {path.name}"
        )
    said = io.StringIO()
    try:
        # it prints what is wrong, and ends the process
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            mesh = meshio.read(path)
            grid = pyvista.from_meshio(mesh)
    except (Exception, SystemExit) as error:
        lines = [line for line in said.getvalue().splitlines() if line.strip()] or [str(error)]
        raise FileError(f"cannot read {path}: {lines[0].strip() or type(error).__name__}") from None
    # VTK follows any index: look at them first
    for block in mesh.cells:
        if not block.type.startswith("polyhedron"):
            require_sound(grid.points, block.data.reshape(-1, 1), f"a mesh in {path.name}")
    return grid
