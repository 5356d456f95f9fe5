"""A mesh that was tessellated from another, and what it can carry over from it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arguments import array
from ..device.layout import FIXED_ONE
from ..errors import InputError
from ..mesh.mesh import Mesh


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class CurvedMesh(Mesh):
    """A mesh, and where each of its vertices lies on the triangles that it was made from.

    Attributes
    ----------
    source_triangles : (T, 3) int32
        Corners of the triangles, among the source's vertices.
    points : (V, 2) uint32
        u and v of each vertex in 16.16 fixed point: the weights of corners 0 and 1 of its triangle;
        that of corner 2 is 65536 - u - v.
    point_offsets : (T + 1,) int64
        Where each triangle begins among the vertices.
    """

    source_triangles: npt.NDArray[np.int32]
    points: npt.NDArray[np.uint32]
    point_offsets: npt.NDArray[np.int64]

    def __post_init__(self) -> None:
        super().__post_init__()
        self._keep("source_triangles", ("T", 3), np.int32)
        self._keep("points", (len(self.vertices), 2), np.uint32)
        self._keep("point_offsets", (len(self.source_triangles) + 1,), np.int64)
        first, last = self.point_offsets[[0, -1]].tolist()
        if (first, last) != (0, len(self.vertices)) or (np.diff(self.point_offsets) < 0).any():
            raise InputError(
                f"expected point_offsets that rise from 0 to {len(self.vertices)}, got {first} to "
                f"{last}"
            )

    def interpolate(self, values: npt.ArrayLike) -> npt.NDArray[np.float32]:
        """Return what the source has at its vertices, blended: texture coordinates, colours.

        Parameters
        ----------
        values : (source vertices, ...) array_like
            Of the mesh that this one was made from.

        Returns
        -------
        (V, ...) float32
            Linear in each triangle. Both sides of an edge between two vertices agree to the bit.

        Raises
        ------
        InputError
            If there are fewer values than vertices.
        """
        wanted = int(self.source_triangles.max(initial=-1)) + 1
        given = array("values", values, ("V", ...), is_finite=False)
        if len(given) < wanted:
            raise InputError(f"expected values for {wanted} vertices, got shape {given.shape}")
        corners = np.repeat(self.source_triangles, np.diff(self.point_offsets), axis=0)
        u, v = self.points.T.astype(np.float64) / FIXED_ONE
        with np.errstate(over="ignore", invalid="ignore"):  # of what is not finite
            blended = sum(
                weight.reshape(-1, *(1,) * (given.ndim - 1)) * given[corners[:, corner]]
                for corner, weight in enumerate((u, v, 1 - u - v))
            )
            return np.asarray(blended, np.float32)
