"""Triangles in the world, and which patch each came from."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from ..errors import InputError

if TYPE_CHECKING:
    import pyvista

    from ..ground.heightmap import Heightmap


@dataclass(frozen=True, eq=False)
class Patches:
    """The P patches that a mesh was tessellated from, row by row.

    Attributes
    ----------
    shape : (int, int)
        Tile rows and columns; P is their product.
    tile : int
        Cells along a full tile.
    edge_factors : (P, 4) float32
        Tessellation factors of the edges u = 0, v = 0, u = 1, v = 1 (west, north, east, south);
        0 where the patch was culled.
    inside_factors : (P, 2) float32
        Along u (east) and v (south).
    point_offsets, triangle_offsets : (P + 1,) int64
        Where each patch begins among the mesh's vertices and triangles.
    deviation : (P,) float32
        Standard deviation from the tile's plane; NaN where a tile has no data.
    """

    shape: tuple[int, int]
    tile: int
    edge_factors: npt.NDArray[np.float32]
    inside_factors: npt.NDArray[np.float32]
    point_offsets: npt.NDArray[np.int64]
    triangle_offsets: npt.NDArray[np.int64]
    deviation: npt.NDArray[np.float32]

    @property
    def count(self) -> int:
        return len(self.edge_factors)

    @property
    def drawn(self) -> npt.NDArray[np.bool_]:
        """True where a patch emitted triangles; (P,)."""
        return np.diff(self.triangle_offsets) > 0

    @property
    def culled_count(self) -> int:
        return self.count - int(np.count_nonzero(self.drawn))


@dataclass(frozen=True)
class Achieved:
    """What a promise came to, measured on the finished triangles at every sample.

    Attributes
    ----------
    metres : float
        Largest vertical error, in the raster's unit.
    pixels : float or None
        Bound of the largest error in the picture; None without a camera, infinite where a budget
        leaves no bound.
    kept : bool
        Whether that is within what was asked for.
    rounds : int
        How often the mesh was measured.
    """

    metres: float
    pixels: float | None
    kept: bool
    rounds: int


@dataclass(frozen=True, eq=False)
class Mesh:
    """An indexed triangle mesh with normals.

    Attributes
    ----------
    vertices : (V, 3) float32
        Relative to `origin`; x east, y north, z up.
    normals : (V, 3) float32
        Unit length.
    triangles : (T, 3) int32
        Corners, counter-clockwise seen from outside (for terrain: from above).
    origin : (3,) float64
        World point that `vertices` are relative to.
    crs : str or None
    patches : Patches or None
        Where the triangles came from; None for a mesh that was loaded.
    timings : dict of str to float
        Seconds of device time by stage.
    achieved : Achieved or None
        The measured error, where the level of detail promised one.
    textures : (V, 2) float32, or None
        Texture coordinates: u to the right, v up.
    """

    vertices: npt.NDArray[np.float32]
    normals: npt.NDArray[np.float32]
    triangles: npt.NDArray[np.int32]
    origin: npt.NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    crs: str | None = None
    patches: Patches | None = None
    timings: dict[str, float] = field(default_factory=dict)
    achieved: Achieved | None = None
    textures: npt.NDArray[np.float32] | None = None

    def __post_init__(self) -> None:
        for name, array, width in (
            ("vertices", self.vertices, 3),
            ("normals", self.normals, 3),
            ("triangles", self.triangles, 3),
        ):
            if array.ndim != 2 or array.shape[1] != width:
                raise InputError(f"expected {name} of shape (n, {width}), got {array.shape}")
        if len(self.normals) != len(self.vertices):
            raise InputError(
                f"expected a normal a vertex, got {len(self.normals)} for {len(self.vertices)}"
            )
        if self.textures is not None and self.textures.shape != (len(self.vertices), 2):
            raise InputError(
                f"expected texture coordinates of shape ({len(self.vertices)}, 2), one pair a "
                f"vertex, got {self.textures.shape}"
            )

    @property
    def triangle_patches(self) -> npt.NDArray[np.int32]:
        """Index of the patch that each triangle came from; (T,)."""
        if self.patches is None:
            return np.zeros(len(self.triangles), np.int32)
        counts = np.diff(self.patches.triangle_offsets)
        return np.repeat(np.arange(self.patches.count, dtype=np.int32), counts)

    def save(self, path: str | Path) -> Path:
        """Write the mesh to a file, whole or not at all; the ending chooses the format.

        Parameters
        ----------
        path : str or pathlib.Path
            Ends in .glb, .obj, .ply, .stl or .vtp. An existing file is replaced.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        InputError
            If the ending is none of these, or if the mesh has no triangle, positions that are not
            finite or corners that are no vertices.
        FileError
            If the file cannot be written.
        """
        from ..files.meshes.export import save

        return save(self, path)

    def to_pyvista(self, ground: Heightmap | None = None) -> pyvista.PolyData:
        """Return the mesh as pyvista.PolyData that shares its memory.

        Parameters
        ----------
        ground : Heightmap, optional
            What to measure the error of each tile against.

        Returns
        -------
        pyvista.PolyData
            Points relative to the origin, which is field data, as is the CRS. A terrain's cell data
            are ``patch``, ``factor``, ``level``, ``deviation`` and, with `ground`, ``error``.
        """
        from ..files.meshes.export import to_pyvista

        return to_pyvista(self, ground)

    def _repr_html_(self) -> str:
        from ..drawing.notebook import mesh_html

        return mesh_html(self)

    def __repr__(self) -> str:
        kind = type(self).__name__
        return f"{kind}({len(self.vertices)} vertices, {len(self.triangles)} triangles)"
