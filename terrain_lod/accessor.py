"""``polydata.terrain_lod``: what pyvista's triangles can do once this package is installed.

Pyvista 0.48 and later finds this module by its entry point; nothing needs to be imported.

>>> surface.terrain_lod.vertical_error(ground)                  # doctest: +SKIP
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
import pyvista

from .ground.heightmap import Heightmap
from .measure.cracks import CrackReport, crack_report
from .measure.error import VerticalError, vertical_error
from .mesh.mesh import Mesh

NAME: Final = "terrain_lod"


class SurfaceAccessor:
    """Triangles of pyvista as a mesh of this package.

    Parameters
    ----------
    surface : pyvista.PolyData
        Other polygons are cut into triangles.
    """

    def __init__(self, surface: Any) -> None:
        self._surface = surface

    def mesh(self) -> Mesh:
        """Return the triangles as a mesh; its origin and CRS come from the field data, if there.

        Points that float32 would round, in UTM coordinates for one, are taken from the middle of
        the surface, which the origin is moved to.
        """
        surface = self._surface
        if not surface.is_all_triangles:
            surface = surface.triangulate()
        field, textures = surface.field_data, surface.point_data.active_texture_coordinates
        vertices, shift = _near_zero(np.asarray(surface.points))
        origin = np.array(field["origin"], np.float64) if "origin" in field else np.zeros(3)
        return Mesh(
            vertices=vertices,
            normals=np.asarray(_normals(surface), np.float32),
            triangles=np.asarray(surface.regular_faces, np.int32),
            origin=origin + shift,
            crs=str(np.atleast_1d(field["crs"])[0]) if "crs" in field else None,
            textures=None if textures is None else np.asarray(textures, np.float32),
        )

    def vertical_error(self, ground: Heightmap) -> VerticalError:
        """Measure the distance to the ground; see :func:`terrain_lod.vertical_error`."""
        return vertical_error(self.mesh(), ground)

    def crack_report(self) -> CrackReport:
        """Look for cracks; see :func:`terrain_lod.crack_report`."""
        return crack_report(self.mesh())

    def save(self, path: str | Path) -> Path:
        """Write the triangles to a file; see :meth:`terrain_lod.Mesh.save`."""
        return self.mesh().save(path)


def _near_zero(points: npt.NDArray[Any]) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float64]]:
    """Return points in float32, and what was taken off them so that they lose the least."""
    rounded = np.asarray(points, np.float32)
    if not len(points) or (rounded == points).all():
        return rounded, np.zeros(3)
    # whole numbers, so that the shift itself costs nothing
    shift = np.round((points.min(axis=0) + points.max(axis=0)) / 2)
    return np.asarray(points - shift, np.float32), shift


def _normals(surface: Any) -> Any:
    known = surface.point_data.active_normals
    if known is not None:
        return known
    return surface.compute_normals(
        cell_normals=False, split_vertices=False, consistent_normals=False
    ).point_data.active_normals


if hasattr(pyvista, "register_dataset_accessor"):  # from 0.48 on
    pyvista.register_dataset_accessor(NAME, pyvista.PolyData)(SurfaceAccessor)
