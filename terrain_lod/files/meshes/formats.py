"""Meshes by way of VTK and meshio: .vtp, .vtk, .vtu, Gmsh, Abaqus, Medit and more.

VTK follows whatever a file says, and may crash: call this in a child process alone.
"""

from __future__ import annotations

import contextlib
import io
import warnings
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import FileError, InputError, MissingExtraError
from ...mesh.soundness import require_sound
from .raw import RawMesh, of_triangles, strips_to_triangles


def read_foreign(path: Path) -> RawMesh:
    """Return the surface of a file that VTK or meshio reads; lines and points are left out.

    Raises
    ------
    FileError
        If the file is damaged.
    InputError
        If neither knows the ending, or a cell's corners are no points.
    MissingExtraError
        If only meshio might, and is not installed.
    """
    notes, dropped = list[str](), Counter[str]()
    surface = _surface_of(_read(path), notes)
    for what, count in (("lines", surface.n_lines), ("points", surface.n_verts)):
        if count:
            dropped[what] += count
    corners, sizes = _cells_of(surface.GetPolys())
    strips, lengths = _cells_of(surface.GetStrips())
    if len(strips):
        more_corners, more_sizes = of_triangles(strips_to_triangles(strips, lengths))
        corners = np.concatenate([corners, more_corners])
        sizes = np.concatenate([sizes, more_sizes])
    fields = surface.field_data
    return RawMesh(
        np.asarray(surface.points),
        corners,
        sizes,
        surface.point_data.active_normals,
        surface.point_data.active_texture_coordinates,
        np.array(fields["origin"], np.float64) if "origin" in fields else None,
        str(np.ravel(fields["crs"])[0]) if "crs" in fields else None,
        notes=notes,
        dropped=dropped,
    )


def _cells_of(cells: Any) -> tuple[Any, Any]:
    """Return the corners of a vtkCellArray, and how many each cell has."""
    import pyvista

    corners = pyvista.convert_array(cells.GetConnectivityArray()).astype(np.int64)
    return corners, np.diff(pyvista.convert_array(cells.GetOffsetsArray()).astype(np.int64))


def _surface_of(data: Any, notes: list[str]) -> Any:
    """Return pyvista.PolyData: volumes reduced to their surface, blocks joined."""
    import pyvista

    if isinstance(data, pyvista.MultiBlock):
        parts = [_surface_of(block, notes) for block in data if block is not None]
        return pyvista.PolyData().append_polydata(*parts)
    if isinstance(data, pyvista.PolyData):
        return data
    if not isinstance(data, pyvista.DataSet):
        raise ValueError(f"it holds a {type(data).__name__}, no surface")
    notes.append(f"taking the surface of {type(data).__name__}")
    return data.extract_surface(algorithm="dataset_surface")


def _read(path: Path) -> Any:
    """Return the pyvista object in a file."""
    import pyvista

    if _is_abaqus(path):
        return _read_with_meshio(path)
    with _vtk_complaints() as complaints:
        try:
            reader = pyvista.get_reader(path)
        except ValueError:
            return _read_with_meshio(path)
        # not reader.read(): it prints the complaints
        reader.reader.Update()
        data = pyvista.wrap(reader.reader.GetOutputDataObject(0))
    if complaints or data is None:
        reason = complaints[0].splitlines()[0] if complaints else "no output"
        raise FileError(f"cannot read {path}: {reason}")
    return data


@contextmanager
def _vtk_complaints() -> Iterator[list[str]]:
    """Collect what VTK complains about inside the block, instead of on the terminal."""
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    complaints: list[str] = []
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    with pyvista.VtkErrorCatcher(send_to_logging=False) as catcher, warnings.catch_warnings():
        # VTK's own readers give arrays that pyvista calls invalid
        warnings.simplefilter("ignore")
        yield complaints
    complaints += [event.alert for event in catcher.error_events]


def _is_abaqus(path: Path) -> bool:
    """Return True for the one of two formats with the ending .inp that VTK cannot read."""
    if path.suffix.lower() != ".inp":
        return False
    with path.open("rb") as file:
        return file.read(1) == b"*"


def _read_with_meshio(path: Path) -> Any:
    """Return the pyvista.UnstructuredGrid of a file."""
    import pyvista

    try:
        import meshio
    except ImportError:
        raise MissingExtraError(
            f"expected .glb, .gltf, .obj, .off, .ply, .stl, .vtp or another that VTK reads, "
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
