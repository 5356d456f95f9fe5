"""Other makers of meshes from heights, each behind one call; their errors are measured, not read.

A peer knows no data that is missing: it gets the lowest height there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ...ground.heightmap import Heightmap
from ...mesh.mesh import Mesh

Heights = npt.NDArray[np.float32]
Corners = npt.NDArray[np.int32]


@dataclass(frozen=True)
class Peer:
    """A maker of meshes.

    Attributes
    ----------
    name, module : str
        What people call it, and what Python imports for it.
    asks : str
        Unit of its parameter: ``"m"`` of vertical error, the ``"share"`` of the triangles of all
        samples to keep, or the ``"samples"`` from one vertex to the next.
    make : callable
        Heights (R, C) above the ground's base, spacing and the parameter to positions in columns,
        rows and heights (V, 3), and corners (T, 3).
    """

    name: str
    module: str
    asks: str
    make: Callable[[Heights, float], tuple[npt.NDArray[Any], Corners]]

    @property
    def command(self) -> str:
        """What installs it."""
        return f"pip install {'vtk' if self.module == 'vtkmodules' else self.module}"

    @property
    def is_installed(self) -> bool:
        return find_spec(self.module) is not None

    def mesh(self, ground: Heightmap, parameter: float) -> Mesh:
        """Return the peer's mesh of `ground`, in the ground's world."""
        heights = ground.heights
        if ground.mask is not None:
            heights = np.where(ground.mask, heights[ground.valid].min(), heights)
        points, triangles = self.make(np.ascontiguousarray(heights, np.float32), parameter)
        vertices = np.empty((len(points), 3), np.float32)
        vertices[:, 0] = points[:, 0] * ground.spacing[0]
        vertices[:, 1] = points[:, 1] * -ground.spacing[1]
        vertices[:, 2] = points[:, 2]
        return Mesh(
            vertices,
            np.zeros_like(vertices),
            np.ascontiguousarray(triangles, np.int32),
            origin=np.array((*ground.origin, ground.base)),
        )


def uniform_grid(heights: Heights, step: float) -> tuple[npt.NDArray[Any], Corners]:
    """Return every `step`-th sample, the last row and column too, two triangles a cell."""
    rows, columns = (_stations(extent, int(step)) for extent in heights.shape)
    column, row = np.meshgrid(columns, rows)
    points = np.stack([column, row, heights[np.ix_(rows, columns)]], axis=-1).reshape(-1, 3)
    index = np.arange(row.size, dtype=np.int32).reshape(row.shape)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    triangles = np.stack([a, c, b, b, c, d], axis=-1).reshape(-1, 3)
    return points, triangles


def _stations(extent: int, step: int) -> npt.NDArray[np.intp]:
    return np.unique(np.append(np.arange(0, extent, step), extent - 1))


def delatin(heights: Heights, metres: float) -> tuple[npt.NDArray[Any], Corners]:
    """Greedy Delaunay triangulation (Garland and Heckbert 1995, as in fogleman's hmm)."""
    from pydelatin import Delatin

    made = Delatin(heights, max_error=metres)
    points = np.array(made.vertices, np.float64).reshape(-1, 3)
    points[:, 1] = len(heights) - 1 - points[:, 1]  # its y runs from the last row
    return points, np.asarray(made.triangles).reshape(-1, 3)


def martini(heights: Heights, metres: float) -> tuple[npt.NDArray[Any], Corners]:
    """Right-triangulated irregular network (Evans, Kirkpatrick, Townsend 2001, as in martini).

    It takes squares of 2^k + 1 samples alone: the last row and column are repeated, and triangles
    beyond them left out.
    """
    from pymartini import Martini

    rows, columns = heights.shape
    size = 1 << int(np.ceil(np.log2(max(rows, columns) - 1)))
    square = np.pad(heights, ((0, size + 1 - rows), (0, size + 1 - columns)), mode="edge")
    tile = Martini(size + 1).create_tile(np.ascontiguousarray(square, np.float32))
    corners, triangles = tile.get_mesh(metres)
    places = np.asarray(corners).reshape(-1, 2).astype(np.intp)
    triangles = np.asarray(triangles).reshape(-1, 3)
    # some corner above the last row, and some before the last column
    is_before = (places < (columns - 1, rows - 1))[triangles]
    inside = np.all(np.any(is_before, axis=1), axis=1)
    points = np.column_stack([places, square[places[:, 1], places[:, 0]]])
    return points, triangles[inside].astype(np.int32)


def vtk_greedy(heights: Heights, metres: float) -> tuple[npt.NDArray[Any], Corners]:
    """VTK's greedy terrain decimation (Garland and Heckbert 1995), to an absolute error."""
    import pyvista as pv
    from vtkmodules.vtkFiltersHybrid import vtkGreedyTerrainDecimation

    rows, columns = heights.shape
    image = pv.ImageData(dimensions=(columns, rows, 1))
    image.point_data["height"] = heights.ravel()
    image.set_active_scalars("height")
    decimation = vtkGreedyTerrainDecimation()
    decimation.SetInputData(image)
    decimation.SetErrorMeasureToAbsoluteError()
    decimation.SetAbsoluteError(metres)
    decimation.BoundaryVertexDeletionOff()  # without this the outline is lost, and the error too
    decimation.Update()
    return _of_vtk(pv.wrap(decimation.GetOutput()))


def quadric(heights: Heights, share: float) -> tuple[npt.NDArray[Any], Corners]:
    """Quadric edge collapse (Garland and Heckbert 1997) of all samples, by VTK through pyvista."""
    import pyvista as pv

    points, triangles = uniform_grid(heights, 1)
    full = pv.PolyData.from_regular_faces(points.astype(np.float32), triangles)
    return _of_vtk(full.decimate(1 - share))


def _of_vtk(surface: Any) -> tuple[npt.NDArray[Any], Corners]:
    return np.asarray(surface.points), surface.regular_faces.astype(np.int32)


PEERS: Final = (
    Peer("uniform grid", "numpy", "samples", uniform_grid),
    Peer("pydelatin", "pydelatin", "m", delatin),
    Peer("pymartini", "pymartini", "m", martini),
    Peer("VTK greedy", "vtkmodules", "m", vtk_greedy),
    Peer("pyvista decimate", "pyvista", "share", quadric),
)
