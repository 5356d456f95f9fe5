"""Triangles in the world, and which patch each came from."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from ..arguments import array, finite, instance, text
from ..errors import InputError
from ..ground.grid import TileGrid
from .normal_map import NormalMap

if TYPE_CHECKING:
    import pyvista


@dataclass(frozen=True, eq=False)
class Patches:
    """The P patches that a mesh was tessellated from: tiles, row by row, or squares of them.

    Attributes
    ----------
    grid : TileGrid
        The raster's samples, and how they are cut into tiles.
    areas : (P, 4) int32
        What each patch covers: its first row and column, and how many rows and columns of cells.
    edge_factors : (P, 4) float32
        Tessellation factors of the edges u = 0, v = 0, u = 1, v = 1 (west, north, east, south);
        0 where the patch was culled.
    inside_factors : (P, 2) float32
        Along u (east) and v (south).
    point_offsets, triangle_offsets : (P + 1,) int64
        Where each patch begins among the mesh's vertices and triangles.
    deviation : (P,) float32
        Standard deviation from the tile's plane, the largest of several; NaN without data.
    """

    grid: TileGrid
    areas: npt.NDArray[np.int32]
    edge_factors: npt.NDArray[np.float32]
    inside_factors: npt.NDArray[np.float32]
    point_offsets: npt.NDArray[np.int64]
    triangle_offsets: npt.NDArray[np.int64]
    deviation: npt.NDArray[np.float32]

    @property
    def shape(self) -> tuple[int, int]:
        """Tile rows and columns."""
        return self.grid.shape

    @property
    def tile(self) -> int:
        """Cells along a full tile."""
        return self.grid.tile

    @property
    def count(self) -> int:
        return len(self.edge_factors)

    @property
    def segment_cells(self) -> npt.NDArray[np.float64]:
        """Cells that a segment of a patch's inside spans: its size and its factors in one; (P,)."""
        cells = self.areas[:, :1:-1] / np.maximum(self.inside_factors, 1.0)
        lengths: npt.NDArray[np.float64] = np.sqrt(cells.prod(axis=1))
        return lengths

    @property
    def drawn(self) -> npt.NDArray[np.bool_]:
        """True where a patch emitted triangles; (P,)."""
        return np.diff(self.triangle_offsets) > 0

    def on_tiles(self, values: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
        """Return a value for each tile, of one a patch; NaN where no patch is; (TR, TC)."""
        grid = self.grid
        tiles = np.full(grid.shape, np.nan)
        top, left, down, across = self.areas.T
        first_row, first_column = (
            np.searchsorted(corners, begin)
            for corners, begin in ((grid.corner_rows, top), (grid.corner_columns, left))
        )
        end_row = np.searchsorted(grid.corner_rows, top + down)
        end_column = np.searchsorted(grid.corner_columns, left + across)
        single = (end_row - first_row == 1) & (end_column - first_column == 1)
        tiles[first_row[single], first_column[single]] = values[single]
        for patch in np.flatnonzero(~single):
            rows = slice(first_row[patch], end_row[patch])
            tiles[rows, first_column[patch] : end_column[patch]] = values[patch]
        return tiles

    def largest_on_tiles(self, values: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
        """Return the largest of a tile's values, (TR, TC), in each patch; NaN where all are; (P,).

        The way back from :meth:`on_tiles`.
        """
        grid = self.grid
        top, left, down, across = self.areas.T
        first = (np.searchsorted(grid.corner_rows, top), np.searchsorted(grid.corner_columns, left))
        end = (
            np.searchsorted(grid.corner_rows, top + down),
            np.searchsorted(grid.corner_columns, left + across),
        )
        largest: npt.NDArray[np.float64] = values[first].astype(np.float64)
        for patch in np.flatnonzero((end[0] - first[0] > 1) | (end[1] - first[1] > 1)):
            part = values[first[0][patch] : end[0][patch], first[1][patch] : end[1][patch]]
            largest[patch] = np.fmax.reduce(part, axis=None)
        return largest

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
        Relative to `origin`; x east, y north, z up. Arrays of other real dtypes are converted.
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
    normal_map : NormalMap or None
        What :func:`terrain_lod.bake_normals` found over the texture coordinates.
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
    normal_map: NormalMap | None = None

    def __post_init__(self) -> None:
        self._keep("vertices", ("V", 3), np.float32)
        self._keep("normals", (len(self.vertices), 3), np.float32)
        self._keep("triangles", ("T", 3), np.int32)
        self._keep("origin", (3,), np.float64)
        if self.textures is not None:
            self._keep("textures", (len(self.vertices), 2), np.float32)
        normal_map = instance("NormalMap or None for normal_map", self.normal_map, NormalMap | None)
        if normal_map is not None and (
            self.textures is None or len(normal_map.tangents) != len(self.vertices)
        ):
            given = "no textures" if self.textures is None else len(normal_map.tangents)
            raise InputError(
                f"expected a normal_map with texture coordinates and {len(self.vertices)} "
                f"tangents, got {given}"
            )
        if self.crs is not None:
            text("crs", self.crs)
        for stage, seconds in instance("a dict for timings", self.timings, dict).items():
            finite(text("a stage of timings", stage), seconds)
        instance("Patches or None for patches", self.patches, Patches | None)
        instance("Achieved or None for achieved", self.achieved, Achieved | None)

    def _keep(self, name: str, shape: tuple[int | str, ...], dtype: npt.DTypeLike) -> None:
        """Keep a field as an array of real numbers; what is not finite is left to who uses it."""
        made = array(name, getattr(self, name), shape, dtype, is_finite=False)
        object.__setattr__(self, name, made)

    @property
    def triangle_patches(self) -> npt.NDArray[np.int32]:
        """Index of the patch that each triangle came from; (T,)."""
        if self.patches is None:
            return np.zeros(len(self.triangles), np.int32)
        counts = np.diff(self.patches.triangle_offsets)
        return np.repeat(np.arange(self.patches.count, dtype=np.int32), counts)

    def save(self, path: str | Path, *, picture: npt.ArrayLike | None = None) -> Path:
        """Write the mesh to a file, whole or not at all; the ending chooses the format.

        Of several that save to one name at once, the last is what stays.

        Parameters
        ----------
        path : str or pathlib.Path
            Ends in .glb, .obj, .ply, .stl or .vtp. An existing file is replaced.
        picture : (H, W, 3) uint8, optional
            What lies over the mesh by its texture coordinates, row 0 where v is 1; in .glb, and
            beside .obj as a .jpg file and a .mtl file of the same name.

        Returns
        -------
        pathlib.Path
            The file.

        Raises
        ------
        InputError
            If the ending is none of these, if the mesh has no triangle, positions that are not
            finite or corners that are no vertices, or if it does not fit the format; if there is a
            picture and no texture coordinates, or no room for it in the format.
        FileError
            If the file cannot be written.
        """
        from ..files.meshes.export import save

        return save(self, path, picture)

    def to_pyvista(self) -> pyvista.PolyData:
        """Return the mesh as pyvista.PolyData that shares its memory.

        Returns
        -------
        pyvista.PolyData
            Points relative to the origin; add ``field_data["origin"]`` for world coordinates. Point
            data: ``Normals``, and texture coordinates where the mesh has them. Field data:
            ``origin`` (3,) float64, ``crs``. A terrain's cell data: ``patch`` int32, the patch's
            row-major number; ``factor`` float32, its larger inside factor; ``level`` int8, how
            often that doubles: 0 for 1, 1 for 2, 3 for 8; ``deviation`` float32, that of its tile
            from the plane.

        Examples
        --------
        Errors are measured against a ground; ``patch`` says where each belongs:

        >>> surface = mesh.to_pyvista()                             # doctest: +SKIP
        >>> errors = tl.patch_errors(mesh, ground)                  # doctest: +SKIP
        >>> surface["error"] = errors[surface["patch"]]             # doctest: +SKIP
        """
        import pyvista

        surface = pyvista.PolyData.from_regular_faces(self.vertices, self.triangles)
        surface.point_data.active_normals = self.normals
        if self.textures is not None:
            surface.point_data.active_texture_coordinates = self.textures
        surface.field_data["origin"] = np.asarray(self.origin, np.float64)
        if self.crs:
            surface.field_data["crs"] = self.crs
        if self.patches is not None:
            patch = self.triangle_patches
            factors = self.patches.inside_factors.max(axis=1)
            levels = np.round(np.log2(np.maximum(factors, 1.0))).astype(np.int8)
            surface.cell_data["patch"] = patch
            surface.cell_data["factor"] = factors[patch]
            surface.cell_data["level"] = levels[patch]
            surface.cell_data["deviation"] = self.patches.deviation[patch]
        return surface

    def _repr_html_(self) -> str:
        from ..drawing.notebook import page

        table = {"triangles": f"{len(self.triangles):,}", "vertices": f"{len(self.vertices):,}"}
        if len(self.vertices):
            with np.errstate(invalid="ignore"):  # of infinite ones
                size = np.ptp(self.vertices, axis=0)
            table["size"] = " × ".join(f"{extent:,.4g}" for extent in size)
        table["origin"] = ", ".join(f"{value:,.10g}" for value in self.origin)
        if self.patches is not None:
            drawn = self.patches.count - self.patches.culled_count
            table["patches"] = f"{drawn:,} drawn, {self.patches.culled_count:,} culled"
        if self.achieved is not None:
            pixels = self.achieved.pixels
            seen = "" if pixels is None else f", {pixels:.3g} pixels"
            table["largest error"] = f"{self.achieved.metres:.4g}{seen}"
        for stage, seconds in self.timings.items():
            table[stage] = f"{1e3 * seconds:.1f} ms"
        if self.crs:
            table["CRS"] = self.crs
        return page("Mesh", table)

    def __repr__(self) -> str:
        kind = type(self).__name__
        return f"{kind}({len(self.vertices)} vertices, {len(self.triangles)} triangles)"
