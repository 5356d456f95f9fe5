"""Meshes in: triangles from any surface file, whatever polygons it has."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ...errors import InputError
from ...mesh.mesh import Mesh
from ...mesh.normals import vertex_normals
from ...mesh.soundness import require_sound
from .polygons import cut_polygons
from .raw import Floats, Integers, RawMesh, require_corners
from .readers import mesh_file, read

_log = logging.getLogger(__name__)

# a normal may be this far off unit length
_NEARLY_UNIT: Final = 1e-2

Vectors = npt.NDArray[np.floating[Any]]


def load_mesh(path: str | Path) -> Mesh:
    """Read a mesh from a file: .glb, .gltf, .obj, .off, .ply, .stl, .vtp, .vtk, .vtu and more.

    The first six are read by readers that look before they leap; all others by VTK, with the extra
    ``meshes`` also by meshio (.msh, .inp, .mesh, .nas and more), in a child process, so that a
    damaged file cannot take this one along: that takes a second more. glTF compressed with Draco
    needs the extra ``compress``; meshopt and quantized attributes are read as they are.

    All groups, nodes and blocks become one mesh, each where it stands. Polygons are cut into
    triangles, concave ones too, volumes reduced to their surface. Left out are lines, points, faces
    of fewer than three corners and vertices of no triangle: one warning counts them. Missing
    normals are computed as the mean of the faces around, weighted by area. Texture coordinates come
    along where each vertex has a pair. An origin and CRS that
    :func:`~terrain_lod.files.meshes.export.save` recorded are restored.
    Coordinates far from zero in 64 bits, or in text, get an origin of whole numbers near their
    middle, so that float32 loses the least. glTF of others is turned from y up to z up; nodes that
    mirror keep their outside out.

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
        If there is no reader for the ending, if there is no triangle in the file, if a position or
        the origin is not finite or passes float32, or a corner is no vertex.
    MissingExtraError
        If a package is needed to read it that is not installed; the message names the extra.
    """
    path = mesh_file(path)
    raw = read(path)
    for note in raw.notes:
        _log.info("%s: %s", path, note)
    corners, sizes, used = _polygons_of(raw, path)
    points, origin = _placed(raw, used, path)
    triangles, crossing = cut_polygons(points, corners, sizes)
    if len(triangles) > len(sizes):
        _log.info("%s: polygons cut into %d triangles", path, len(triangles))
    if crossing:
        _log.warning("%s: %d polygons cross themselves: their triangles overlap", path, crossing)
    corners32 = triangles.astype(np.int32)
    return Mesh(
        points.astype(np.float32),
        _normals_of(raw, points, corners32, used, path).astype(np.float32),
        corners32,
        origin,
        raw.crs,
        textures=_textures_of(raw, used),
    )


def _polygons_of(raw: RawMesh, path: Path) -> tuple[Integers, Integers, npt.NDArray[np.bool_]]:
    """Return polygons of three and more corners, and which points they use; say what is left out.

    Corners are numbered among the points that are used.
    """
    require_corners(raw.corners, raw.sizes, len(raw.points))
    enough = raw.sizes >= 3
    raw.dropped["faces of fewer than three corners"] += int(np.count_nonzero(~enough))
    corners, sizes = raw.corners[np.repeat(enough, raw.sizes)], raw.sizes[enough]
    used = np.zeros(len(raw.points), np.bool_)
    used[corners] = True
    raw.dropped["vertices of no triangle"] += int(np.count_nonzero(~used))
    if not len(sizes):
        raise InputError(f"expected triangles in {path}, got none")
    if dropped := +raw.dropped:
        left_out = ", ".join(f"{count:,} {what}" for what, count in dropped.items())
        _log.warning("%s: left out %s", path, left_out)
    return (np.cumsum(used) - 1)[corners], sizes, used


def _placed(
    raw: RawMesh, used: npt.NDArray[np.bool_], path: Path
) -> tuple[Floats, npt.NDArray[np.float64]]:
    """Return the points that are used, and the origin that they are relative to.

    Raises
    ------
    InputError
        If a point or the origin is not finite, or float32 cannot hold a point.
    """
    # a number that stands for no data may be anything, where no triangle uses it
    require_sound(
        np.where(used[:, None], raw.points, raw.points.dtype.type(0)),
        np.zeros((0, 3), np.int32),
        f"a mesh in {path.name}",
    )
    points = raw.points[used]
    if raw.origin is None:
        with np.errstate(over="ignore"):
            origin = _origin_near(points)
            points = points - origin
    else:
        origin = raw.origin
    if origin.shape != (3,) or not np.isfinite(origin).all():
        raise InputError(f"expected a finite origin of three numbers in {path}, got {origin}")
    largest = float(abs(points).max())
    if largest > float(np.finfo(np.float32).max):
        raise InputError(f"expected positions that 32 bits can hold in {path}, got {largest:g}")
    return points, origin


def _origin_near(points: Floats) -> npt.NDArray[np.float64]:
    """Return whole numbers near the middle, along axes on which zero is far away."""
    if points.dtype == np.float32:
        return np.zeros(3)
    low, high = points.min(axis=0), points.max(axis=0)
    middle = low / 2 + high / 2
    return np.where(abs(middle) > high - low, np.round(middle), 0.0)


def _normals_of(
    raw: RawMesh,
    points: Floats,
    triangles: npt.NDArray[np.int32],
    used: npt.NDArray[np.bool_],
    path: Path,
) -> Floats:
    """Return the file's own normals where they are usable, else the faces'."""
    if raw.normals is not None and raw.normals.shape == raw.points.shape:
        own = raw.normals[used].astype(np.float64)
        with np.errstate(over="ignore"):
            lengths = np.linalg.norm(own, axis=1)
        if (abs(lengths - 1) < _NEARLY_UNIT).all():
            return np.asarray(own / lengths[:, None])
    _log.info("%s: normals computed from the triangles", path)
    return vertex_normals(points, triangles)


def _textures_of(raw: RawMesh, used: npt.NDArray[np.bool_]) -> npt.NDArray[np.float32] | None:
    """Return the texture coordinates of a file where they are usable."""
    if raw.textures is None or raw.textures.shape != (len(raw.points), 2):
        return None
    with np.errstate(over="ignore"):
        own = raw.textures[used].astype(np.float32)
    return own if np.isfinite(own).all() else None
