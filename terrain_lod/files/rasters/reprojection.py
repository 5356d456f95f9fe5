"""Rasters brought to another map, and how far that is from their own samples."""

from __future__ import annotations

import logging
import math
from dataclasses import replace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ...arguments import finite, steps, text
from ...errors import InputError
from .limits import require_memory
from .nodata import is_nodata, suspects
from .place import unit_of_heights
from .raster import Raster
from .readers_gdal import crs_called, in_system_called

Pair = tuple[float, float]
# the zone of Universal Transverse Mercator that a raster's middle is in
UTM: Final = "utm"
# samples whose place is looked up at a time
_ROWS: Final = 256

log = logging.getLogger(__name__)


def reprojected(
    raster: Raster, nodata: Any, name: str, crs: str, spacing: Any
) -> tuple[Raster, float]:
    """Return a raster in another system, and how far it is from its own samples at most.

    Between samples of the new grid, and between those of the old, heights are bilinear. The new
    grid has steps as long as the old ones where the raster has its middle.

    Parameters
    ----------
    nodata : float or None
        The number that stands for no data, instead of the raster's own.
    crs : str
        Authority code or WKT of a projection, or ``"utm"``.
    spacing : float or (float, float), optional
        Other steps, in the unit of the new system.

    Returns
    -------
    Raster, float
        The largest difference at the old samples that the new grid reaches, in numbers of the
        file.

    Raises
    ------
    InputError
        If PROJ does not know one of the systems, if the new one is in degrees, if the raster does
        not say where it is, or if the new system cannot show it.
    """
    crs = text("crs", crs)
    if raster.system.crs is None or raster.origin is None or raster.step is None:
        raise InputError(f"expected a file that says where it is and in which CRS, got {name}")
    if raster.values.ndim != 2 or raster.values.dtype.kind not in "iuf":
        raise InputError(f"expected one band of heights to reproject, got another in {name}")
    hole, notes = _holes(raster, nodata, name)
    with crs_called(raster.system.horizontal or raster.system.crs) as source:
        crs = _zone_of(raster, source, name) if crs.lower() == UTM else crs
        new = in_system_called(replace(raster, mask=None, nodata=None), crs)
        if new.system.angle is not None or new.system.unit is None:
            raise InputError(
                f"expected a projected CRS, whose unit is a length, got {crs[:60]}: "
                'crs="utm" takes the zone that the ground is in'
            )
        with crs_called(new.system.horizontal or crs) as target:
            values, origin, step = _warped(raster, hole, source, target, name, spacing)
            off = _largest_difference(raster, hole, source, target, values, origin, step)
    log.info(
        "%s is brought to %s: %d x %d samples, %.4g x %.4g apart, within %.4g of its own samples",
        name, crs[:60], *values.shape, *step, off * abs(raster.scale),
    )  # fmt: skip
    # what the old system says of heights, it says of them still
    height_unit = raster.height_unit or unit_of_heights(raster.system).name
    return replace(
        new, values=values, mask=np.isnan(values), origin=origin, step=step,
        height_unit=height_unit, notes=raster.notes + notes,
    ), off  # fmt: skip


def _holes(
    raster: Raster, nodata: Any, name: str
) -> tuple[npt.NDArray[np.bool_] | None, tuple[str, ...]]:
    """Return where a raster has no data, and what looks as if it stood for that, too."""
    value = raster.nodata if nodata is None else nodata
    hole = raster.mask
    if value is not None:
        known = is_nodata(raster.values, value if math.isnan(value) else finite("nodata", value))
        hole = known if hole is None else hole | known
    if raster.offset != 0:
        return hole, ()
    metres = abs(raster.scale) * unit_of_heights(raster.system).metres or 1.0
    return hole, suspects(raster, hole, name, metres)


def _zone_of(raster: Raster, source: Any, name: str) -> str:
    """Return the code of the zone of UTM that the middle of a raster is in."""
    x, y = _places(raster, slice(len(raster.values) // 2, len(raster.values) // 2 + 1))
    middle = x.shape[1] // 2
    east, north = _moved(source, "EPSG:4326", x[0, middle : middle + 1], y[0, middle : middle + 1])
    if not (-80 <= north[0] <= 84 and math.isfinite(east[0])):
        raise InputError(
            f"expected ground between 80° south and 84° north for a zone of UTM, got {name} at "
            f"{north[0]:.4g}°: name another CRS"
        )
    zone = int((east[0] + 180) % 360 // 6) + 1
    return f"EPSG:{326 if north[0] >= 0 else 327}{zone:02d}"


def _places(raster: Raster, rows: slice) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return x and y of the samples of some rows."""
    assert raster.origin is not None
    assert raster.step is not None
    (x, y), (dx, dy) = raster.origin, raster.step
    columns = np.arange(raster.values.shape[1])
    across, down = np.meshgrid(x + dx * columns, y - dy * np.arange(rows.start, rows.stop))
    return across, down


def _moved(
    source: Any, target: Any, x: npt.NDArray[np.float64], y: npt.NDArray[np.float64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return points of one system in another; infinite where it cannot show them."""
    from rasterio.warp import transform

    moved = transform(source, target, x.ravel(), y.ravel())
    across, down = (np.asarray(part, np.float64).reshape(x.shape) for part in moved)
    return across, down


def _warped(
    raster: Raster, hole: npt.NDArray[np.bool_] | None, source: Any, target: Any, name: str,
    spacing: Any,
) -> tuple[npt.NDArray[np.float64], Pair, Pair]:  # fmt: skip
    """Return the values in the new system, NaN where there are none, and where they stand."""
    from rasterio import Affine
    from rasterio.warp import Resampling, reproject

    border = _border(raster, source, target)
    if not all(np.isfinite(part).all() for part in border):
        raise InputError(
            f"expected ground that lies within the new CRS, got {name}, some of whose border "
            "it cannot show: take a part with bounds="
        )
    step = _steps(raster, source, target) if spacing is None else steps("spacing", spacing)
    (west, east), (south, north) = ((part.min(), part.max()) for part in border)
    columns = max(math.ceil((east - west) / step[0] - 1e-6), 1) + 1
    rows = max(math.ceil((north - south) / step[1] - 1e-6), 1) + 1
    require_memory(rows, columns, np.dtype("f8"), name)
    heights = raster.values.astype(np.float64)
    if hole is not None:
        heights[hole] = np.nan
    made = np.full((rows, columns), np.nan)
    assert raster.origin is not None
    assert raster.step is not None
    reproject(
        heights, made, src_crs=source, dst_crs=target, src_nodata=np.nan, dst_nodata=np.nan,
        src_transform=_corners(Affine, raster.origin, raster.step),
        dst_transform=_corners(Affine, (west, north), step),
        resampling=Resampling.bilinear, tolerance=0.0,
    )  # fmt: skip
    if np.isnan(made).all():
        raise InputError(f"expected some ground in the new CRS, got none of {name}")
    return made, (float(west), float(north)), step


def _corners(affine: Any, origin: Pair, step: Pair) -> Any:
    """Return GDAL's transform, which is of the corners of cells."""
    (x, y), (dx, dy) = origin, step
    return affine(dx, 0.0, x - dx / 2, 0.0, -dy, y + dy / 2)


def _border(
    raster: Raster, source: Any, target: Any
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return x and y of the outermost samples in the new system."""
    last = len(raster.values) - 1
    first_row, last_row = (_places(raster, slice(row, row + 1)) for row in (0, last))
    every = _columns(raster)
    x = np.concatenate([first_row[0].ravel(), last_row[0].ravel(), every[0]])
    y = np.concatenate([first_row[1].ravel(), last_row[1].ravel(), every[1]])
    return _moved(source, target, x, y)


def _columns(raster: Raster) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Return x and y of the samples of the first and the last column."""
    assert raster.origin is not None
    assert raster.step is not None
    (x, y), (dx, dy), (rows, columns) = raster.origin, raster.step, raster.values.shape
    down = y - dy * np.arange(rows)
    across = np.repeat([x, x + dx * (columns - 1)], rows)
    return across, np.concatenate([down, down])


def _steps(raster: Raster, source: Any, target: Any) -> Pair:
    """Return how long a column's and a row's step are in the middle, in the new system."""
    assert raster.origin is not None
    assert raster.step is not None
    (x, y), (dx, dy), (rows, columns) = raster.origin, raster.step, raster.values.shape
    x, y = x + dx * (columns - 1) / 2, y - dy * (rows - 1) / 2
    across, down = _moved(source, target, np.array([x, x + dx, x]), np.array([y, y, y - dy]))
    return (
        math.hypot(across[1] - across[0], down[1] - down[0]),
        math.hypot(across[2] - across[0], down[2] - down[0]),
    )


def _largest_difference(
    raster: Raster, hole: npt.NDArray[np.bool_] | None, source: Any, target: Any,
    values: npt.NDArray[np.float64], origin: Pair, step: Pair,
) -> float:  # fmt: skip
    """Return how far old samples are from the new grid, at most; 0 where it reaches none."""
    largest = 0.0
    for row in range(0, len(raster.values), _ROWS):
        rows = slice(row, min(row + _ROWS, len(raster.values)))
        x, y = _moved(source, target, *_places(raster, rows))
        seen = bilinear(values, (x - origin[0]) / step[0], (origin[1] - y) / step[1])
        off = np.abs(seen - raster.values[rows].astype(np.float64))
        known = np.isfinite(off) if hole is None else np.isfinite(off) & ~hole[rows]
        largest = max(largest, float(off[known].max(initial=0.0)))
    return largest


def bilinear(
    values: npt.NDArray[np.float64], column: npt.NDArray[np.float64], row: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return values between samples, NaN outside of them and beside NaN."""
    rows, columns = values.shape
    # what rounding has moved outside belongs to the border still
    inside = (column > -1e-6) & (row > -1e-6) & (column < columns - 1 + 1e-6)
    inside &= row < rows - 1 + 1e-6
    column, row = np.where(inside, column, 0.0), np.where(inside, row, 0.0)
    left = np.clip(np.floor(column).astype(np.int64), 0, columns - 2)
    top = np.clip(np.floor(row).astype(np.int64), 0, rows - 2)
    u, v = column - left, row - top
    above = values[top, left] * (1 - u) + values[top, left + 1] * u
    below = values[top + 1, left] * (1 - u) + values[top + 1, left + 1] * u
    between: npt.NDArray[np.float64] = np.where(inside, above * (1 - v) + below * v, np.nan)
    return between
