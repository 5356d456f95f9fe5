"""Ground as a grid of heights, and where it stands in the world.

World axes are x east, y north, z up, right-handed, in metres or whatever unit the raster has.
Row 0 is the northernmost row: sample ``[row, column]`` stands at
``(x0 + column * dx, y0 - row * dy)``. Samples are vertices; between them height is bilinear.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from operator import index
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..arguments import array, finite, instance, numbers, parts, steps, text, told
from ..errors import InputError
from .detail import between, reached, repeated, require_float32, steps_between
from .units import symbol

_UNITS: Final = ("unit of x and y", "unit of heights")
_LARGEST: Final = float(np.finfo(np.float32).max)
# between samples: positions, and areas of cells, have to stay numbers that float32 holds
_FINEST: Final = 1e-18
_COARSEST: Final = 1e18


@dataclass(frozen=True, init=False, eq=False)
class Heightmap:
    """A raster of heights with its spacing, origin and holes.

    Parameters
    ----------
    heights : array_like, (R, C), any real dtype
        Heights relative to `base`, row 0 north. NaN and masked elements are nodata. Not modified.
    spacing : float or (float, float), optional
        Distance between neighbouring samples along x and y, in world units.
    origin : (float, float), optional
        World x and y of sample [0, 0], the north-western corner.
    base : float, optional
        Added to every height.
    mask : array_like of bool, (R, C), optional
        True where there is no data, besides NaN and masked elements.
    crs : str, optional
        Coordinate reference system of the world axes, as an authority code or WKT.
    units : (str, str), optional
        Unit of x and y, and of heights, such as ``("metre", "metre")``. They say what numbers are
        called; nothing is converted.
    name : str, optional
        What reports call this ground.

    Attributes
    ----------
    heights : (R, C) float32
        Relative to `base`, read-only, 0 where there is no data. Where the given heights do not fit
        float32 exactly, `base` has been moved to the middle of their range: an elevation is
        ``base + heights`` in float64.
    spacing, origin : (float, float)
    base : float
    mask : (R, C) bool or None
        True where there is no data; None where data is everywhere.
    crs : str or None
    units : (str, str)
    name : str

    Raises
    ------
    InputError
        If the array is not two-dimensional with at least 2 x 2 samples, is not real, holds
        infinities or no data at all, or if spacing is not positive, or beyond 1e-18 to 1e+18.

    Examples
    --------
    >>> Heightmap([[0, 1], [2, float("nan")]], spacing=30.0)
    Heightmap(2 x 2, spacing=(30, 30) m, heights 0 to 2 m, 1 nodata)
    """

    heights: npt.NDArray[np.float32]
    spacing: tuple[float, float]
    origin: tuple[float, float]
    base: float
    mask: npt.NDArray[np.bool_] | None
    crs: str | None
    units: tuple[str, str]
    name: str

    def __init__(
        self,
        heights: npt.ArrayLike,
        *,
        spacing: float | tuple[float, float] = 1.0,
        origin: tuple[float, float] = (0.0, 0.0),
        base: float = 0.0,
        mask: npt.ArrayLike | None = None,
        crs: str | None = None,
        units: tuple[str, str] = ("metre", "metre"),
        name: str = "ground",
    ) -> None:
        values, hole = _heights_and_holes(heights, mask)
        stored, shift = _to_float32(values, hole)
        self._set("heights", _frozen(stored))
        self._set("mask", _frozen(hole) if hole.any() else None)
        self._set("spacing", tuple(map(_spacing, steps("spacing", spacing))))
        self._set("origin", numbers("origin", origin, "x", "y"))
        self._set("base", finite("base", base) + shift)
        if max(map(abs, self.height_range)) > _LARGEST:
            raise InputError(f"expected elevations that float32 can hold, got a base of {base:g}")
        self._set("crs", None if crs is None else text("crs", crs))
        self._set("units", tuple(text("units", unit) for unit in parts("units", units, *_UNITS)))
        self._set("name", text("name", name))

    @classmethod
    def from_xarray(cls, array: Any, **options: Any) -> Heightmap:
        """Return the ground in an ``xarray.DataArray``: :func:`terrain_lod.load` of it."""
        from ..files.rasters.loading import load

        return load(array, **options)

    def to_xarray(self) -> Any:
        """Return this ground as an ``xarray.DataArray`` along y and x, row 0 north.

        Elevations, NaN where there is no data: float32 where `base` is 0, else float64. Units are
        attributes; the CRS stands as WKT in ``spatial_ref``, as rioxarray and CF have it.

        Raises
        ------
        MissingExtraError
            If xarray, or rasterio for a CRS, is not installed.
        InputError
            If PROJ does not know the CRS.
        """
        from ..files.rasters.labelled import to_labelled

        return to_labelled(self)

    def _set(self, field: str, value: object) -> None:
        object.__setattr__(self, field, value)

    def with_elevations(
        self, rows: slice, columns: slice, elevations: npt.ArrayLike
    ) -> tuple[Heightmap, slice, slice]:
        """Return this ground with some of its samples replaced, and which, start and stop given.

        Parameters
        ----------
        rows, columns : slice
            Samples to replace: within the raster, without a step.
        elevations : array_like of these samples, any real dtype
            In the world, as :attr:`elevation`, not relative to `base`, which stays as it is. NaN
            and masked elements are nodata.

        Raises
        ------
        InputError
            If the slices are not such, the shape is another, the array is not real or holds
            infinities, or no data would be left.
        """
        part = within("rows", rows, self.shape[0]), within("columns", columns, self.shape[1])
        shape = tuple(piece.stop - piece.start for piece in part)
        values = array("heights", elevations, shape, None, is_finite=False)
        hole = _masked(elevations)
        _add_nan(hole, values)
        relative = np.where(hole, 0.0, np.subtract(values, self.base, dtype=np.float64))
        if np.abs(relative).max() > _LARGEST:
            raise InputError("expected heights that float32 can hold, got some beyond its range")
        mask = self.mask
        if mask is not None or hole.any():
            mask = np.zeros(self.shape, bool) if mask is None else mask.copy()
            mask[part] = hole
            if mask.all():
                raise InputError("expected some data to be left, got nodata for the last of it")
        heights = self.heights.copy()
        heights[part] = relative
        new = copy(self)
        new._set("heights", _frozen(heights))
        new._set("mask", _frozen(mask) if mask is not None and mask.any() else None)
        return new, *part

    def with_detail(self, detail: Heightmap) -> Heightmap:
        """Return this ground made finer, with a small heightmap added again and again.

        The samples are as far apart as the detail's. Sample [r, c] is this ground, bilinear there,
        plus detail [r % rows, c % columns]: the detail's first sample adds to this ground's first
        one, whatever the detail's origin. Where the ground lacks a sample that is needed, so does
        the sum.

        :class:`~terrain_lod.Terrain` takes detail without ever storing the sum; this is what its
        meshes are to be measured against.

        Parameters
        ----------
        detail : Heightmap
            With data everywhere, in the same units, its spacing a whole part of this ground's
            along each axis.

        Returns
        -------
        Heightmap
            Its shape is ((R - 1) * down + 1, (C - 1) * across + 1) for so many steps a cell.

        Raises
        ------
        InputError
            If the detail is not such, has another CRS, or the sums do not fit float32.
        """
        steps = self.steps_of(detail)
        heights = between(self.heights, steps)
        heights += repeated(detail.heights, (heights.shape[0], heights.shape[1]))
        (dx, dy), (across, down) = self.spacing, steps
        return Heightmap(
            heights,
            spacing=(dx / across, dy / down),
            origin=self.origin,
            base=self.base + detail.base,
            mask=None if self.mask is None else reached(self.mask, steps),
            crs=self.crs,
            units=self.units,
            name=self.name,
        )

    def with_crs(self, crs: str) -> Heightmap:
        """Return this ground with another name for where its x and y are."""
        new = copy(self)
        new._set("crs", text("crs", crs))
        return new

    def steps_of(self, detail: Heightmap) -> tuple[int, int]:
        """Return the samples of `detail` a cell of this ground, along x and y.

        Raises
        ------
        InputError
            If it does not fit this ground, as :meth:`with_detail` describes.
        """
        instance("a Heightmap for detail", detail, Heightmap)
        if detail.mask is not None:
            raise InputError(
                f"expected detail with data everywhere, got {int(detail.mask.sum())} of "
                f"{detail.mask.size} samples without: set them to 0, which adds nothing"
            )
        if detail.crs not in (None, self.crs):
            raise InputError(
                f"expected detail without a CRS, or in the ground's ({self.crs}), got {detail.crs}"
            )
        steps = steps_between(self.spacing, detail.spacing)
        require_float32(self.heights, detail.heights)
        return steps

    @property
    def shape(self) -> tuple[int, int]:
        """Samples along y and x: rows, columns."""
        rows, columns = self.heights.shape
        return rows, columns

    @property
    def valid(self) -> npt.NDArray[np.bool_]:
        """True where there is data; (R, C)."""
        return np.ones(self.shape, bool) if self.mask is None else ~self.mask

    @property
    def elevation(self) -> npt.NDArray[np.float64]:
        """``base + heights`` in float64, NaN where there is no data; (R, C)."""
        elevation = np.add(self.heights, self.base, dtype=np.float64)
        if self.mask is not None:
            elevation[self.mask] = np.nan
        return elevation

    @property
    def height_range(self) -> tuple[float, float]:
        """Lowest and highest elevation."""
        valid = self.heights if self.mask is None else self.heights[~self.mask]
        return self.base + float(valid.min()), self.base + float(valid.max())

    @property
    def extent(self) -> tuple[float, float]:
        """World size along x and y, first to last sample."""
        rows, columns = self.shape
        return (columns - 1) * self.spacing[0], (rows - 1) * self.spacing[1]

    @property
    def unit_symbols(self) -> tuple[str, str]:
        """What stands behind a number of x or y, and of height: ``("m", "m")``."""
        across, up = self.units
        return symbol(across), symbol(up)

    @property
    def centre(self) -> tuple[float, float, float]:
        """World point in the middle of the ground's bounding box."""
        width, depth = self.extent
        low, high = self.height_range
        return self.origin[0] + width / 2, self.origin[1] - depth / 2, (low + high) / 2

    def _repr_html_(self) -> str:
        from ..drawing.notebook import from_above, page

        low, high = self.height_range
        table = {
            "samples": " × ".join(f"{extent:,}" for extent in self.shape),
            "spacing": " × ".join(f"{step:g}" for step in self.spacing),
            "heights": f"{low:,.6g} to {high:,.6g}",
            "origin": ", ".join(f"{value:,.10g}" for value in self.origin),
        }
        if self.mask is not None:
            table["nodata"] = f"{int(self.mask.sum()):,} samples"
        if self.crs:
            table["CRS"] = self.crs
        picture = from_above(self.elevation, self.spacing, (low, high))
        return page(f"Heightmap {self.name}", table, picture)

    def __repr__(self) -> str:
        rows, columns = self.shape
        low, high = self.height_range
        across, up = self.unit_symbols
        holes = "" if self.mask is None else f", {int(self.mask.sum())} nodata"
        return (
            f"Heightmap({rows} x {columns}, spacing=({self.spacing[0]:g}, {self.spacing[1]:g}) "
            f"{across}, heights {low:g} to {high:g} {up}{holes})"
        )


def _frozen(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    array.setflags(write=False)
    return array


def _heights_and_holes(
    heights: npt.ArrayLike, mask: npt.ArrayLike | None
) -> tuple[npt.NDArray[Any], npt.NDArray[np.bool_]]:
    """Return the plain array and where it has no data, or say what is wrong with it."""
    values = array("heights", heights, ("R", "C"), None, is_finite=False)
    if min(values.shape) < 2:
        raise InputError(f"expected heights of at least 2 x 2 samples, got shape {values.shape}")
    hole = _masked(heights)
    if mask is not None:
        hole |= array("mask", mask, values.shape, bool)
    _add_nan(hole, values)
    if hole.all():
        raise InputError("expected heights, got no data at all (every sample is NaN or masked)")
    return values, hole


def _masked(heights: npt.ArrayLike) -> npt.NDArray[np.bool_]:
    return np.array(np.broadcast_to(np.ma.getmaskarray(np.ma.asarray(heights)), np.shape(heights)))


def _add_nan(hole: npt.NDArray[np.bool_], values: npt.NDArray[Any]) -> None:
    """Add NaN to the holes, and refuse infinities elsewhere."""
    if values.dtype.kind != "f":
        return
    hole |= np.isnan(values)
    infinite = np.isinf(values) & ~hole
    if infinite.any():
        row, column = np.argwhere(infinite)[0]
        raise InputError(
            f"expected finite heights, got {values[row, column]} at [{row}, {column}]: "
            "mask it or set it to NaN where it stands for nodata"
        )


def within(name: str, part: slice, extent: int) -> slice:
    """Return `part` with start and stop filled in, or say what is wrong with it."""
    instance(f"a slice for {name}", part, slice)
    given = (part.start, 0), (part.stop, extent), (part.step, 1)
    try:
        start, stop, step = (usual if end is None else index(end) for end, usual in given)
    except TypeError:  # no whole numbers
        start = stop = step = 0
    if step != 1 or not 0 <= start < stop <= extent:
        raise InputError(f"expected {name} within slice(0, {extent}), got {told(part)}")
    return slice(start, stop)


def _spacing(step: float) -> float:
    """Return a distance between samples, or say that float32 cannot hold what comes of it."""
    if not _FINEST <= step <= _COARSEST:
        raise InputError(
            f"expected spacing from {_FINEST:g} to {_COARSEST:g}, got {step:g}: is it right?"
        )
    return step


def _to_float32(
    values: npt.NDArray[Any], hole: npt.NDArray[np.bool_]
) -> tuple[npt.NDArray[np.float32], float]:
    """Return heights in float32 and what was taken off them so that they lose the least."""
    known = values[~hole] if hole.any() else values
    low, high = float(known.min()), float(known.max())
    if max(-low, high, high - low) > _LARGEST:
        raise InputError(f"expected heights that float32 can hold, got {low:g} to {high:g}")
    exact = values.dtype.itemsize < 4 or values.dtype == np.float32
    if not exact:
        exact = bool((known.astype(np.float32) == known).all())
    # a whole number, so that the shift itself costs nothing
    shift = 0.0 if exact else float(np.round(low / 2 + high / 2))
    # what stands in a hole may be beyond float32
    with np.errstate(over="ignore", invalid="ignore"):
        stored = np.array(values - shift if shift else values, np.float32, order="C")
    stored[hole] = 0.0
    return stored, shift
