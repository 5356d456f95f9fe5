"""Meshes out, to files.

========  ============================  =================================================
ending    what                          where the origin and the CRS are
========  ============================  =================================================
``.glb``  binary glTF 2.0               on the node, exactly in its ``extras``; CRS there
``.obj``  Wavefront text                both in a comment, the last line
``.ply``  Stanford, binary              both in a comment of the header
``.stl``  binary, facets without shape  origin in the header; no room for the CRS
``.vtp``  VTK XML, with the cell data   both in the field data
========  ============================  =================================================

Vertices are written as they are: float32 relative to the origin, z up. A new format is one
function and one row of ``FORMATS``.
"""

from __future__ import annotations

import logging
import os
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

from ...arguments import file_path
from ...errors import InputError
from ...mesh.mesh import Mesh
from ...mesh.soundness import sound_mesh
from ...paths import replacing
from .glb import write_glb
from .picture import packed, write_beside
from .raw import ORIGIN_MARK

_log = logging.getLogger(__name__)

# bytes that an STL header has
_STL_HEADER: Final = 80


def save(mesh: Mesh, path: str | Path, picture: Any = None) -> Path:
    """Write a mesh to a file; see :meth:`terrain_lod.Mesh.save`."""
    path = file_path("path", path)
    write = FORMATS.get(path.suffix.lower())
    if write is None:
        raise InputError(
            f"unknown mesh format {path.suffix!r}: expected a name that ends in "
            f"{', '.join(FORMATS)}, got {path.name}"
        )
    if not len(mesh.triangles):
        raise InputError(f"expected triangles to save in {path.name}, got an empty mesh")
    sound_mesh(mesh)
    if picture is None:
        with replacing(path) as temporary:
            write(mesh, temporary)
        return path
    content = packed(picture, mesh)
    if write is write_glb:
        with replacing(path) as temporary:
            write_glb(mesh, temporary, content)
    elif write is _write_obj:
        with replacing(path) as temporary:
            _write_obj(mesh, temporary)
            start = write_beside(content, path).encode()
            temporary.write_bytes(start + temporary.read_bytes())
    else:
        raise InputError(f"expected .glb or .obj for a mesh with a picture, got {path.name}")
    return path


def _write_obj(mesh: Mesh, path: Path) -> None:
    from vtkmodules.vtkIOGeometry import vtkOBJWriter

    _write_with(vtkOBJWriter(), mesh, path)
    middle = "//{0}" if mesh.textures is None else "/{0}/{0}"
    corners = " ".join(f"{{0}}{middle}".format(corner) for corner in mesh.triangles[-1] + 1)
    _require_ending(path, f"f {corners}\n".encode())
    with path.open("a", encoding="utf-8") as file:
        file.write(f"# {_origin_note(mesh)}\n")


def _write_ply(mesh: Mesh, path: Path) -> None:
    from vtkmodules.vtkIOPLY import vtkPLYWriter

    writer = vtkPLYWriter()
    writer.SetFileTypeToBinary()
    writer.SetDataByteOrderToLittleEndian()
    writer.AddComment(_origin_note(mesh))
    _write_with(writer, mesh, path)
    _require_ending(path, struct.pack("<B3i", 3, *mesh.triangles[-1]))


def _write_stl(mesh: Mesh, path: Path) -> None:
    from vtkmodules.vtkIOGeometry import vtkSTLWriter

    writer = vtkSTLWriter()
    writer.SetFileTypeToBinary()
    note = _origin_note(mesh, with_crs=False)
    if len(note) > _STL_HEADER:
        _log.warning("the origin does not fit an STL header and is not recorded: %s", note)
        note = "terrain_lod"
    writer.SetHeader(note)
    _write_with(writer, mesh, path)


def _write_vtp(mesh: Mesh, path: Path) -> None:
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    # raw appended data: 0.1 s for two million triangles, where VTK's default takes 4
    writer = vtkXMLPolyDataWriter()
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToNone()
    _write_with(writer, mesh, path)


FORMATS: Final[dict[str, Callable[[Mesh, Path], None]]] = {
    ".glb": write_glb,
    ".obj": _write_obj,
    ".ply": _write_ply,
    ".stl": _write_stl,
    ".vtp": _write_vtp,
}


def _write_with(writer: Any, mesh: Mesh, path: Path) -> None:
    """Run one of VTK's writers, with its complaints as an OSError instead of on the terminal."""
    complaints: list[object] = []
    for source in (writer, writer.GetExecutive()):
        source.AddObserver("ErrorEvent", lambda *event: complaints.append(event))
    writer.SetFileName(str(path))
    writer.SetInputData(mesh.to_pyvista())
    if not writer.Write() or complaints:
        # below 20000 VTK's codes are the system's
        code = writer.GetErrorCode()
        reason = os.strerror(code) if 0 < code < 20000 else "is there room on the disk?"
        raise OSError(code, reason)


def _require_ending(path: Path, expected: bytes) -> None:
    """Make sure that a file ends as it must: some of VTK's writers do not notice a full disk."""
    with path.open("rb") as file:
        file.seek(-min(len(expected), path.stat().st_size), os.SEEK_END)
        if file.read() != expected:
            raise OSError("only part of it was written: is there room on the disk?")


def _origin_note(mesh: Mesh, *, with_crs: bool = True) -> str:
    """Return the comment that records the origin, and the CRS on the same line."""
    x, y, z = (repr(float(value)) for value in mesh.origin)
    crs = f" crs {' '.join(mesh.crs.split())}" if with_crs and mesh.crs else ""
    return f"{ORIGIN_MARK} {x} {y} {z}{crs}"
