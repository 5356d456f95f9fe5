"""Arrays of xarray: what their coordinates and attributes say, and ground as one of them.

The conventions are those of CF 1.11 (units, _FillValue, scale_factor, grid_mapping) and of
rioxarray, which keeps the coordinate reference system in ``spatial_ref``.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final, TypeGuard

import numpy as np

from ...errors import InputError, MissingExtraError
from ...ground.heightmap import Heightmap
from ...ground.units import unit_called
from .affine import Affine, first_and_steps, moved, placed, require_upright
from .limits import require_memory
from .parts import Part
from .place import UNSAID
from .raster import Raster
from .readers_gdal import in_system_called, wkt_called
from .wkt import System, in_degrees

EXTRA: Final = 'pip install "terrain_lod[xarray]"'
# the coordinate that holds the coordinate reference system
_SYSTEM: Final = "spatial_ref"
# steps between coordinates that are called even differ by less than this part of one
_EVEN: Final = 1e-3
_ACROSS: Final = ("x", "lon", "long", "longitude", "easting")
_DOWN: Final = ("y", "lat", "latitude", "northing")
_DEGREES: Final = ("degree", "degrees", "degrees_east", "degree_east", "degrees_north",
                   "degree_north", "degrees_e", "degrees_n", "deg")  # fmt: skip


def is_labelled(ground: object) -> TypeGuard[Any]:
    """Return whether this is an array of xarray."""
    return hasattr(ground, "coords") and hasattr(ground, "dims") and hasattr(ground, "attrs")


def name_of(array: Any) -> str:
    return str(array.name if getattr(array, "name", None) else "ground")


def labelled(array: Any) -> tuple[Any, Raster, Affine | None]:
    """Return an array with its rows along y, what it says of itself, and where its samples stand.

    Returns
    -------
    (xarray.DataArray, Raster, Affine or None)
        Nothing is read: the raster's values take no memory. Rows are in the array's order.

    Raises
    ------
    InputError
        If it is no array of two dimensions, rotated, mirrored or uneven, or says what cannot be
        honoured.
    """
    if not hasattr(array, "dtype"):
        raise InputError(
            f"expected one array of heights, got a Dataset of {', '.join(map(str, array))}: "
            "choose one by its name"
        )
    # a band by itself, as rioxarray has it, is no dimension of the ground
    array = array.squeeze(drop=True)
    if len(array.dims) != 2:
        raise InputError(
            f"expected an array of two dimensions, y and x, got {', '.join(map(str, array.dims))}:"
            " choose one with isel()"
        )
    if _runs(array, array.dims[0], "X", _ACROSS) or _runs(array, array.dims[1], "Y", _DOWN):
        array = array.transpose()
    name = name_of(array)
    raster = Raster(
        np.broadcast_to(np.zeros((), array.dtype), array.shape),
        nodata=_nodata(array, name),
        scale=float(array.attrs.get("scale_factor", 1.0)),
        offset=float(array.attrs.get("add_offset", 0.0)),
        height_unit=array.attrs.get("units"),
    )
    raster, affine = _in_system(raster, array, name), _affine(array, name)
    if affine is None:
        return array, raster, None
    require_upright(affine, array.shape, name)
    return array, *_in_one_unit(raster, affine, array, name)


def read_labelled(array: Any, part: Part) -> Raster:
    """Read a part of an array of xarray, as :func:`terrain_lod.load` does."""
    if part.overview is not None or part.band is not None:
        raise InputError("expected a file with overview= or band=, got it with an array")
    array, raster, affine = labelled(array)
    name = name_of(array)
    rows, columns = part.slices(array.shape, first_and_steps(affine), name)
    require_memory(rows.stop - rows.start, columns.stop - columns.start, array.dtype, name)
    # cut before it is read: of dask's chunks, and of files, no others are
    raster = replace(raster, values=np.asarray(array[rows, columns].values))
    return raster if affine is None else placed(raster, moved(affine, rows, columns), name)


def to_labelled(ground: Heightmap) -> Any:
    """Return ground as an array of xarray; :meth:`Heightmap.to_xarray` tells of it."""
    try:
        import xarray
    except ImportError:
        raise MissingExtraError(f"expected xarray, got no such package: {EXTRA}") from None
    (rows, columns), (dx, dy), (x, y) = ground.shape, ground.spacing, ground.origin
    across, up = ground.units
    heights = ground.elevation if ground.base else ground.elevation.astype(np.float32)
    coordinates: dict[str, Any] = {
        "y": ("y", y - dy * np.arange(rows), {"axis": "Y", "units": across}),
        "x": ("x", x + dx * np.arange(columns), {"axis": "X", "units": across}),
    }
    if ground.crs is not None:
        text = wkt_called(ground.crs)
        corner = f"{x - dx / 2!r} {dx!r} 0.0 {y + dy / 2!r} 0.0 {-dy!r}"
        said = {"crs_wkt": text, "spatial_ref": text, "GeoTransform": corner}
        coordinates[_SYSTEM] = ((), 0, said)
    array = xarray.DataArray(
        heights, coordinates, ("y", "x"), name=ground.name, attrs={"units": up}
    )
    if ground.crs is not None:
        array.encoding["grid_mapping"] = _SYSTEM
    return array


def _runs(array: Any, dimension: Any, axis: str, names: tuple[str, ...]) -> bool:
    """Return whether a dimension says that it runs along x, or along y."""
    said = array.coords[dimension].attrs if dimension in array.coords else {}
    if "axis" in said:
        return bool(said["axis"] == axis)
    standard = str(said.get("standard_name", dimension)).lower()
    return standard in names or standard == f"projection_{axis.lower()}_coordinate"


def _nodata(array: Any, name: str) -> float | None:
    """Return the number that stands for no data; in what xarray has decoded, NaN does."""
    said = [array.attrs[key] for key in ("_FillValue", "missing_value") if key in array.attrs]
    values = sorted({float(number) for value in said for number in np.ravel(value)})
    if len(values) > 1:
        raise InputError(
            f"expected one value for no data in {name}, got {', '.join(map(str, values))}: "
            "set the others to it with where()"
        )
    return values[0] if values else None


def _affine(array: Any, name: str) -> Affine | None:
    """Return where the samples stand, None if nothing says so."""
    down, across = (_first_and_step(array, dimension) for dimension in array.dims)
    if down is not None and across is not None:
        return across[1], 0.0, across[0], 0.0, down[1], down[0]
    turned = [str(key) for key, place in array.coords.items() if place.ndim == 2]
    said = any("GeoTransform" in place.attrs for place in array.coords.values())
    if down is None and across is None and not turned and not said:
        return None
    raise InputError(
        f"expected coordinates along {array.dims[0]} and {array.dims[1]} in {name}, got "
        f"{' and '.join(turned) + ' of two dimensions' if turned else 'none along each'}: "
        "reproject it to a north-up grid, or give it coordinates"
    )


def _first_and_step(array: Any, dimension: Any) -> tuple[float, float] | None:
    """Return the first coordinate along a dimension and the step from it, None if it has none."""
    if dimension not in array.coords:
        return None
    given = np.asarray(array.coords[dimension].values)
    if given.dtype.kind not in "iuf":
        raise InputError(f"expected numbers along {dimension}, got {given.dtype}")
    places = given.astype(np.float64)
    step = float(places[-1] - places[0]) / (len(places) - 1)
    off = np.abs(places - (places[0] + step * np.arange(len(places)))).max()
    rounding = np.finfo(given.dtype).eps * np.abs(places).max() if given.dtype.kind == "f" else 0
    # a rounding of whole steps tells nothing of their evenness
    if not off <= _EVEN * abs(step) + min(rounding, abs(step) / 10) or not step:
        raise InputError(f"expected even steps along {dimension}, got others: resample it")
    return float(places[0]), step


def _in_system(raster: Raster, array: Any, name: str) -> Raster:
    """Return `raster` in the coordinate reference system that its grid mapping names."""
    mapping = array.attrs.get("grid_mapping", array.encoding.get("grid_mapping"))
    said = array.coords[mapping or _SYSTEM].attrs if (mapping or _SYSTEM) in array.coords else None
    code = array.attrs.get("crs")
    text = (said or {}).get("crs_wkt", (said or {}).get("spatial_ref", code))
    if isinstance(text, str):
        return in_system_called(raster, text)
    if mapping or (said or {}).get("grid_mapping_name") or code is not None:
        raise InputError(
            f"expected the CRS of {name} as WKT in its grid mapping, got "
            f"{'none' if said is None else 'another form'} in {mapping or _SYSTEM}: open it with "
            'decode_coords="all", or say array.rio.write_crs("EPSG:...")'
        )
    return raster


def _in_one_unit(raster: Raster, affine: Affine, array: Any, name: str) -> tuple[Raster, Affine]:
    """Return both in the unit of the CRS, or in the coordinates' own if there is no CRS."""
    units = [str(array.coords[dim].attrs.get("units", "")).strip() for dim in array.dims]
    words = {unit for unit in units if unit and unit.lower() not in UNSAID}
    system = raster.system
    if not words:
        return raster, affine
    if all(word.lower() in _DEGREES for word in words):
        if system == System():
            note = f"{name} is in degrees and names no CRS: taken as EPSG:4326"
            system = in_degrees("EPSG:4326")
            return replace(raster, system=system, notes=(*raster.notes, note)), affine
        if system.angle is not None and abs(system.angle.degrees - 1) < 1e-9:
            return raster, affine
    unit = unit_called(words.pop()) if len(set(words)) == 1 else None
    if unit is None or system.angle is not None:
        wanted = "one unit of length" if system.angle is None else system.angle.name + "s"
        raise InputError(
            f"expected coordinates of {name} in {wanted}, got {' and '.join(units)}: "
            "convert them, or set their units"
        )
    if system.unit is None:
        return replace(raster, system=replace(system, unit=unit)), affine
    ratio = unit.metres / system.unit.metres
    a, b, x0, d, e, y0 = (number * ratio for number in affine) if ratio != 1 else affine
    return raster, (a, b, x0, d, e, y0)
