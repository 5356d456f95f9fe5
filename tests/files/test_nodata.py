"""Samples that stand for no data: declared to how many digits, and undeclared."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from rasterio.enums import ColorInterp

from support.rasters import GRID, UTM, refusal, write_asc, write_tiff
from terrain_lod.errors import InputError
from terrain_lod.files.rasters.loading import load
from terrain_lod.files.rasters.nodata import is_nodata, undeclared

LEAST = float(np.finfo(np.float32).min)
HILLS = np.linspace(1200.0, 2400.0, 60).reshape(6, 10)


@pytest.mark.parametrize(
    ("nodata", "written"),
    [
        ("-1.70141e+38", "-1.701410009187828e+38"),
        ("-3.4028234663852886e+38", "-3.4028235e+38"),
        ("-3.402823e+38", "-3.4028234663852886e+38"),
        ("-99999.99", "-99999.9921875"),
        ("-9999", "-9999.000000"),
        ("1e+31", "9.9999996e+30"),
    ],
)
def test_text_is_compared_in_its_own_precision(tmp_path: Path, nodata: str, written: str) -> None:
    (tmp_path / "a.asc").write_text(
        "ncols 3\nnrows 2\nxllcorner 5e5\nyllcorner 4e6\ncellsize 10\n"
        f"NODATA_value {nodata}\n1 2 3\n4 {written} 6\n"
    )
    ground = load(tmp_path / "a.asc")
    np.testing.assert_array_equal(ground.valid, [[1, 1, 1], [1, 0, 1]])


def test_what_is_near_is_not_nodata() -> None:
    values = np.array([0.0, 1e-50, -9999.01, -9998.99, 0.4])
    assert not is_nodata(values, -9999).any()
    np.testing.assert_array_equal(is_nodata(values, 0), [1, 0, 0, 0, 0])
    whole = np.array([2**62, 2**62 + 1])
    np.testing.assert_array_equal(is_nodata(whole, 2**62), [1, 0])
    assert not is_nodata(np.array([1, 2], np.uint8), -9999).any()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_limits_of_a_type(dtype: type) -> None:
    least = np.finfo(dtype).min
    values = np.array([least, 0, -least, -9999], dtype)
    np.testing.assert_array_equal(is_nodata(values, float(least)), [1, 0, 0, 0])
    assert not is_nodata(values[1:2], 1.797e308).any()


def test_masked_float64_leaks_no_warning(tmp_path: Path) -> None:
    values = HILLS.copy()
    values[2, 3] = -1.7976931348623157e308
    path = write_tiff(tmp_path / "a.tif", values, nodata=values[2, 3], units=None)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        ground = load(path, z_unit="foot")
    assert np.argwhere(~ground.valid).tolist() == [[2, 3]]
    np.testing.assert_allclose(ground.height_range, (1200 * 0.3048, 2400 * 0.3048))


@pytest.mark.parametrize(
    "value",
    [-32767, -32768, -9999, -99999, LEAST, -LEAST, 9.969209968386869e36, 65535, 1e6, -20_000],
)
def test_undeclared_values_are_named(tmp_path: Path, value: float) -> None:
    values = HILLS.astype(np.float32)
    values[1, 2] = values[4, 5] = value
    path = write_tiff(tmp_path / "a.tif", values)
    with pytest.warns(UserWarning, match=r"in 2 of 60 samples.*nodata=") as caught:
        load(path)
    told = float(str(caught[0].message).split("nodata=")[1].split()[0])
    ground = load(path, nodata=told)
    np.testing.assert_array_equal(ground.valid, values != np.float32(value))


def test_whole_numbers_and_holes_beside(tmp_path: Path) -> None:
    values = HILLS.astype(np.int16)
    values[0, 0], values[5, 5] = -32768, -9999
    with pytest.warns(UserWarning, match=r"holds -9999 in 1 of 60"):
        ground = load(write_tiff(tmp_path / "a.tif", values, nodata=-32768))
    assert ground.height_range[0] == -9999


@pytest.mark.parametrize(
    "values",
    [
        HILLS,
        # the deepest sea floor and the highest summit, with all between
        np.linspace(-10_994, 8849, 60).reshape(6, 10),
        # a ramp through -9999, and numbers that are not metres
        np.arange(-10_020, -9960).reshape(6, 10),
        np.arange(0, 60_000, 1000).reshape(6, 10),
        np.full((4, 4), -9999.0),
        np.array([[0, 10_000, 20_000], [30_000, 40_000, 50_000]]),
    ],
)
def test_ground_itself_is_not_suspected(values: np.ndarray) -> None:
    assert undeclared(values, None, 1.0) == []
    assert undeclared(values.astype(np.float32), np.zeros(values.shape, bool), 1.0) == []


def test_the_limits_are_metres() -> None:
    # the summit of Everest in feet, and in decimetres
    assert undeclared(np.array([[0.0, 29_032.0]]), None, 0.3048) == []
    assert undeclared(np.array([[0.0, 29_032.0]]), None, 1.0) == [(29_032.0, 1)]


@pytest.mark.parametrize("dtype", ["uint8", "uint16", "int16", "int32", "float32", "float64"])
def test_alpha_of_every_type_is_a_mask(tmp_path: Path, dtype: str) -> None:
    alpha = np.ones(GRID.shape)
    alpha[2, 0] = 0
    bands = np.stack([GRID % 200, alpha]).astype(dtype)
    path = write_tiff(tmp_path / "a.tif", bands, ALPHA="YES")
    import rasterio

    with rasterio.open(path, "r+") as file:
        file.colorinterp = [ColorInterp.gray, ColorInterp.alpha]
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=".*8-bit")
        ground = load(path)
    assert np.argwhere(~ground.valid).tolist() == [[2, 0]]


def test_alpha_alone(tmp_path: Path) -> None:
    import rasterio

    path = write_tiff(tmp_path / "a.tif", GRID.astype(np.uint16))
    with rasterio.open(path, "r+") as file:
        file.colorinterp = [ColorInterp.alpha]
    assert "got a band of alpha alone" in refusal(InputError, path)
    np.testing.assert_array_equal(load(path, band=1).elevation, GRID)


def test_a_palette_is_a_picture(tmp_path: Path) -> None:
    import rasterio

    path = write_tiff(tmp_path / "a.tif", (GRID % 200).astype(np.uint8), crs=None, transform=UTM)
    with rasterio.open(path, "r+") as file:
        file.write_colormap(1, {k: (k, 0, 0, 255) for k in range(256)})
    words = "got a picture whose numbers stand for colours of a palette: band=1"
    assert words in refusal(InputError, path)
    with pytest.warns(UserWarning, match="8-bit"):
        np.testing.assert_array_equal(load(path, band=1).elevation, GRID % 200)


def test_asc_without_a_header_entry(tmp_path: Path) -> None:
    values = GRID.astype(float)
    values[0, 0] = -9999
    ground = load(write_asc(tmp_path / "a.asc", "xllcorner 1e3\nyllcorner 0\ncellsize 9", values))
    assert np.argwhere(~ground.valid).tolist() == [[0, 0]]
