"""Arrays of xarray: ground is that of the same file, and what cannot be honoured is refused."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import terrain_lod as tl
from terrain_lod.sources.opening import source_of

rasterio = pytest.importorskip("rasterio")
xarray = pytest.importorskip("xarray")

ROWS, COLUMNS = 30, 20


def heights(dtype: str = "float32") -> Any:
    values = np.random.default_rng(3).integers(100, 2000, (ROWS, COLUMNS)).astype(dtype)
    values[4:7, 5:9] = -9999
    return values


def file(path: Path, values: Any, crs: str = "EPSG:25832", step: float = 30.0) -> Path:
    corner = (500_000, 5_400_000) if step > 1 else (10.0, 47.0)
    place = rasterio.Affine(step, 0, corner[0], 0, -step, corner[1])
    profile = {"count": 1, "dtype": values.dtype, "crs": crs, "transform": place, "nodata": -9999}
    with rasterio.open(path, "w", "GTiff", COLUMNS, ROWS, **profile) as out:
        out.write(values, 1)
    return path


def plain(**attributes: Any) -> Any:
    """Return an array in metres without a CRS, from north to south."""
    place = {"y": 900.0 - 30 * np.arange(ROWS), "x": 30.0 * np.arange(COLUMNS)}
    return xarray.DataArray(heights(), place, ("y", "x"), attrs={"_FillValue": -9999, **attributes})


def require_same(found: tl.Heightmap, wanted: tl.Heightmap) -> None:
    np.testing.assert_array_equal(found.elevation, wanted.elevation)
    np.testing.assert_allclose(found.spacing, wanted.spacing, rtol=1e-9)
    np.testing.assert_allclose(found.origin, wanted.origin, rtol=1e-9)
    assert (found.crs, found.units) == (wanted.crs, wanted.units)


@pytest.mark.parametrize(
    ("crs", "step"), [("EPSG:25832", 30.0), ("EPSG:2263", 30.0), ("EPSG:3857", 30.0),
                      ("EPSG:4326", 0.001)]
)  # fmt: skip
@pytest.mark.parametrize("masked", [False, True])
def test_ground_is_that_of_the_file(tmp_path: Path, crs: str, step: float, masked: bool) -> None:
    rioxarray = pytest.importorskip("rioxarray")
    path = file(tmp_path / "a.tif", heights(), crs, step)
    with warnings.catch_warnings():
        # feet of heights are a guess, said of both
        warnings.simplefilter("ignore")
        array = rioxarray.open_rasterio(path, masked=masked).load()
        wanted = tl.load(path)
        turned = array.isel(y=slice(None, None, -1)).squeeze(drop=True).transpose("x", "y")
        for one in (array, turned):
            require_same(tl.load(one), wanted)
        part = tl.load(array, window=(3, 2, 10, 12))
        require_same(part, tl.load(path, window=(3, 2, 10, 12)))
        require_same(tl.Heightmap.from_xarray(array), wanted)


@pytest.mark.parametrize(("crs", "step"), [("EPSG:25832", 30.0), ("EPSG:4326", 0.001)])
def test_there_and_back(tmp_path: Path, crs: str, step: float) -> None:
    ground = tl.load(file(tmp_path / "a.tif", heights(), crs, step))
    array = ground.to_xarray()
    assert array.dtype == np.float32
    assert np.isnan(array.values[4, 5])
    require_same(tl.load(array), ground)
    if crs == "EPSG:25832":
        pytest.importorskip("rioxarray")
        assert array.rio.crs.to_epsg() == 25832
        # as the attribute has it, which GDAL reads from a netCDF
        corner = [float(number) for number in array.spatial_ref.attrs["GeoTransform"].split()]
        assert corner == [500_000, 30, 0, 5_400_000, 0, -30]
        assert array.rio.bounds() == (500_000, 5_399_100, 500_600, 5_400_000)


def test_packed_numbers_are_unpacked_in_memory_and_in_windows() -> None:
    array = plain(scale_factor=0.5, add_offset=100.0).astype("int16", keep_attrs=True)
    ground = tl.load(array)
    assert ground.elevation[0, 0] == heights()[0, 0] * 0.5 + 100
    assert np.isnan(ground.elevation[4, 5])
    found = source_of(array).read(slice(0, ROWS), slice(0, COLUMNS))
    np.testing.assert_array_equal(found, ground.elevation)


def test_units_of_coordinates_and_heights() -> None:
    array = plain(units="km")
    array["x"].attrs["units"] = array["y"].attrs["units"] = "km"
    assert tl.load(array).units == ("kilometre", "kilometre")
    array = array.assign_coords(spatial_ref=0)
    array["spatial_ref"].attrs["crs_wkt"] = rasterio.CRS.from_epsg(25832).to_wkt()
    ground = tl.load(array)
    assert (ground.units, ground.spacing) == (("metre", "metre"), (30_000, 30_000))
    assert ground.elevation[0, 0] == heights()[0, 0] * 1000


def test_only_the_chunks_of_the_part_are_computed() -> None:
    dask = pytest.importorskip("dask.array")
    computed = []

    def block(values: Any, block_info: Any = None) -> Any:
        computed.append(block_info[0]["chunk-location"])
        return values

    values = dask.from_array(heights(), chunks=(10, 10))
    lazy = plain().copy(data=values.map_blocks(block, dtype="float32", meta=np.empty((0, 0), "f4")))
    computed.clear()
    tl.load(lazy, window=(0, 0, 8, 8))
    assert computed == [(0, 0)]


def rotated() -> Any:
    y, x = np.mgrid[:ROWS, :COLUMNS]
    return plain().drop_vars(["x", "y"]).assign_coords(xc=(("y", "x"), x + 0.2 * y))


def in_degrees_on_a_map() -> Any:
    array = plain().assign_coords(spatial_ref=0)
    array["spatial_ref"].attrs["crs_wkt"] = rasterio.CRS.from_epsg(25832).to_wkt()
    array["x"].attrs["units"], array["y"].attrs["units"] = "degrees_east", "degrees_north"
    return array


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (rotated, "xc of two dimensions"),
        (lambda: plain().assign_coords(x=plain().x ** 2), "even steps along x"),
        (lambda: plain().isel(x=slice(None, None, -1)), "rotated or mirrored"),
        (lambda: plain().expand_dims(time=2), "two dimensions, y and x, got time, y, x"),
        (lambda: plain().to_dataset(name="dem"), "a Dataset of dem"),
        (lambda: plain(missing_value=-1), "one value for no data"),
        (lambda: plain(grid_mapping="crs"), "got none in crs"),
        (lambda: plain().drop_vars("x"), "expected coordinates along y and x"),
        (in_degrees_on_a_map, "degrees_north and degrees_east"),
    ],
)
def test_what_cannot_be_honoured_is_one_line(array: Any, message: str) -> None:
    for read in (tl.load, source_of):
        with pytest.raises(tl.InputError, match=message) as raised:
            read(array())
        assert "\n" not in str(raised.value)


def test_options_of_files_are_refused() -> None:
    for option in ({"band": 1}, {"overview": 0}, {"tile": (0, 0, 0)}):
        with pytest.raises(tl.InputError, match="with an array"):
            tl.load(plain(), **option)


def test_degrees_without_a_crs_are_said() -> None:
    array = plain().assign_coords(x=10 + 0.001 * np.arange(COLUMNS), y=47 - 0.001 * np.arange(ROWS))
    array["x"].attrs["units"], array["y"].attrs["units"] = "degrees_east", "degrees_north"
    with pytest.warns(UserWarning, match="taken as EPSG:4326"):
        ground = tl.load(array)
    assert ground.spacing == pytest.approx((76.1, 111.2), abs=0.2)


@pytest.mark.slow
def test_the_accessor_meshes() -> None:
    import terrain_lod.xarray  # noqa: F401

    array = plain()
    mesh = array.terrain_lod.mesh(lod=tl.MaxErrorLod(20.0))
    error = tl.vertical_error(mesh, array.terrain_lod.heightmap())
    assert error.samples == array.size - 12
    assert error.maximum <= 20.0
