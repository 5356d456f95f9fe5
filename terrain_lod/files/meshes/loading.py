"""Meshes in: triangles from any surface file that pyvista or meshio reads."""

from __future__ import annotations

import logging
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ...errors import FileError, InputError
from ...mesh.mesh import Mesh
from ...mesh.normals import vertex_normals
from ...mesh.soundness import require_sound
from .export import ORIGIN_MARK
from .formats import is_abaqus, read_with_meshio
from .glb import read_glb, textures_upside_down
from .ply import require_whole_ply

_log = logging.getLogger(__name__)

_ORIGIN: Final = re.compile(
    rb"%b (\S+) (\S+) ([^\s\0]+)(?: crs ([^\n\r\0]+))?" % ORIGIN_MARK.encode()
)
# how far from either end of a file the comment with the origin is looked for, in bytes
_MARGIN: Final = 4096
# a normal may be this far off unit length
_NEARLY_UNIT: Final = 1e-2

Vectors = npt.NDArray[np.floating[Any]]


def load_mesh(path: str | Path) -> Mesh:
    """Read a mesh from a file: .glb, .gltf, .obj, .ply, .stl, .vtk, .vtp, .vtu and more.

    With the extra ``meshes`` also what meshio reads: .msh, .inp, .mesh, .off, .nas and more.
    Polygons are cut into triangles, volumes reduced to their surface, lines and points dropped,
    missing normals computed as the mean of the faces around, weighted by area; each is logged.
    Texture coordinates come along where each vertex has a pair. An origin and CRS that
    :func:`~terrain_lod.files.meshes.export.save` recorded are restored.
    Coordinates far from zero in 64 bits get an origin of whole numbers near their middle, so that
    float32 loses the least. glTF of others is turned from y up to z up.

    Parameters
    ----------
    path : str or pathlib.Path

    Returns
    -------
    Mesh

    Raises
    ------
    FileError
        If there is no such file, or it is damaged or truncated.
    InputError
        If there is no reader for the ending, if there is no triangle in the file, if a position is
        not finite or a corner is no vertex.
    MissingExtraError
        If only meshio might read the ending, and is not installed.
    """
    path = Path(path)
    if not path.is_file():
        raise FileError(f"expected a mesh file, got none at {path}")
    suffix = path.suffix.lower()
    mesh = read_glb(path) if suffix == ".glb" else None
    if mesh is not None:
        require_sound(mesh.vertices, mesh.triangles, f"a mesh in {path.name}")
        return mesh
    if suffix == ".ply":
        require_whole_ply(path)
    surface = _triangles_of(_read(path), path)
    points, triangles = np.asarray(surface.points), surface.regular_faces.astype(np.int32)
    if not len(triangles):
        raise InputError(f"expected triangles in {path}, got none")
    require_sound(points, triangles, f"a mesh in {path.name}")
    normals = _normals_of(surface, points, triangles, path)
    textures = _textures_of(surface)
    if suffix in (".glb", ".gltf"):
        points, normals = _to_z_up(points), _to_z_up(normals)
        textures = None if textures is None else textures_upside_down(textures)
    origin, crs = _recorded_origin(surface, path)
    if origin is None:
        origin = _origin_near(points)
        points = points - origin
    return Mesh(
        points.astype(np.float32), normals.astype(np.float32), triangles, origin, crs,
        textures=textures,
    )  # fmt: skip


@contextmanager
def _vtk_complaints() -> Iterator[list[str]]:
    """Collect what VTK complains about inside the block, instead of on the terminal."""
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    complaints: list[str] = []
    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_OFF)
    try:
        with pyvista.VtkErrorCatcher(send_to_logging=False) as catcher, warnings.catch_warnings():
            # VTK's own readers give arrays that pyvista calls invalid
            warnings.simplefilter("ignore")
            yield complaints
    finally:
        vtkLogger.SetStderrVerbosity(verbosity)
        complaints += [event.alert for event in catcher.error_events]


def _read(path: Path) -> Any:
    """Return the pyvista object in a file."""
    import pyvista

    if is_abaqus(path):
        return read_with_meshio(path)
    with _vtk_complaints() as complaints:
        try:
            reader = pyvista.get_reader(path)
        except ValueError:
            return read_with_meshio(path)
        # not reader.read(): it prints the complaints
        reader.reader.Update()
        data = pyvista.wrap(reader.reader.GetOutputDataObject(0))
    if complaints or data is None:
        reason = complaints[0].splitlines()[0] if complaints else "no output"
        raise FileError(f"cannot read {path}: {reason}")
    return data


def _triangles_of(data: Any, path: Path) -> Any:
    """Return pyvista.PolyData that has triangles only."""
    import pyvista

    if isinstance(data, pyvista.MultiBlock):
        parts = [_triangles_of(block, path) for block in data if block is not None]
        return pyvista.PolyData().append_polydata(*parts)
    if not isinstance(data, pyvista.PolyData):
        _log.info("%s: taking the surface of %s", path, type(data).__name__)
        data = data.extract_surface(algorithm="dataset_surface")
    dropped = data.n_lines + data.n_verts
    if dropped:
        _log.info("%s: dropping %d lines and points", path, dropped)
    if data.n_cells > dropped and not data.is_all_triangles:
        # VTK follows any index: look at them first
        corners = pyvista.convert_array(data.GetPolys().GetConnectivityArray())
        require_sound(data.points, corners.reshape(-1, 1), f"a mesh in {path.name}")
        data = data.triangulate()
        _log.info("%s: polygons cut into %d triangles", path, data.n_cells)
    return data


def _normals_of(
    surface: Any, points: Vectors, triangles: npt.NDArray[np.int32], path: Path
) -> Vectors:
    """Return the file's own normals where they are usable, else the faces'."""
    own = surface.point_data.active_normals
    if own is None:
        own = surface.point_data.get("NORMAL")
    if own is not None and own.shape == points.shape:
        lengths = np.linalg.norm(own, axis=1)
        if (abs(lengths - 1) < _NEARLY_UNIT).all():
            return np.asarray(own / lengths[:, None])
    _log.info("%s: normals computed from the triangles", path)
    return vertex_normals(points, triangles)


def _textures_of(surface: Any) -> npt.NDArray[np.float32] | None:
    """Return the texture coordinates of a file where they are usable."""
    own = surface.point_data.active_texture_coordinates
    if own is None:
        own = surface.point_data.get("TEXCOORD_0")
    if own is None or own.shape != (surface.n_points, 2) or not np.isfinite(own).all():
        return None
    return np.array(own, np.float32)


def _to_z_up(vectors: Vectors) -> Vectors:
    """Return vectors of a y-up world, turned by 90 degrees about x."""
    return np.stack([vectors[:, 0], -vectors[:, 2], vectors[:, 1]], axis=1)


def _recorded_origin(surface: Any, path: Path) -> tuple[npt.NDArray[np.float64] | None, str | None]:
    """Return the origin and CRS that were saved with a mesh; None where there is none."""
    if "origin" in surface.field_data:
        names = surface.field_data.get("crs")
        crs = None if names is None else str(np.ravel(names)[0])
        return np.array(surface.field_data["origin"], np.float64), crs
    with path.open("rb") as file:
        ends = file.read(_MARGIN)
        file.seek(max(0, path.stat().st_size - _MARGIN))
        ends += b"\n" + file.read()
    note = _ORIGIN.search(ends)
    if note is None:
        return None, None
    crs = note[4].decode().strip() if note[4] else None
    return np.array([float(number) for number in note.groups()[:3]]), crs


def _origin_near(points: Vectors) -> npt.NDArray[np.float64]:
    """Return whole numbers near the middle, along axes on which zero is far away."""
    if points.dtype == np.float32:
        return np.zeros(3)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = low / 2 + high / 2
    return np.where(abs(middle) > high - low, np.round(middle), 0.0)
