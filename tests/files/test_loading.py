"""Every format, written to a folder and loaded again."""

from __future__ import annotations

import gzip
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from PIL import Image
from rasterio.control import GroundControlPoint
from rasterio.enums import ColorInterp
from rasterio.transform import Affine

from support.rasters import (
    CORNER,
    GRID,
    TILE,
    UTM,
    refusal,
    write_asc,
    write_hgt,
    write_image,
    write_tiff,
)
from terrain_lod.errors import (
    FileError,
    InputError,
    MissingExtraError,
    TerrainError,
)
from terrain_lod.files.rasters import readers_gdal
from terrain_lod.files.rasters.degrees import metres_per_degree
from terrain_lod.files.rasters.formats import FORMATS
from terrain_lod.files.rasters.loading import load


class TestImages:
    def test_16_bit_png_is_taken_as_it_is(self, tmp_path: Path) -> None:
        values = np.array([[0, 1, 256, 9001], [20_000, 32767, 32768, 65535]], np.uint16)
        ground = load(write_image(tmp_path / "peak.v2.PNG", values), spacing=1)
        np.testing.assert_array_equal(ground.elevation, values)
        assert (ground.name, ground.spacing, ground.origin) == ("peak.v2", (1, 1), (0, 0))

    @pytest.mark.parametrize("ending", ["png", "tif", "jpg"])
    def test_8_bits_warn_about_steps(self, tmp_path: Path, ending: str) -> None:
        flat = np.full((8, 8), 7, np.uint8)
        path = tmp_path / f"low.{ending}"
        if ending == "tif":
            write_tiff(path, flat)
        else:
            write_image(path, flat)
        with pytest.warns(UserWarning, match=r"low\.\w+ has 8-bit heights: 256 steps") as caught:
            ground = load(path, spacing=1)
        np.testing.assert_array_equal(ground.elevation, flat)
        assert caught[0].filename == __file__

    def test_height_range_is_that_of_all_16_bits(self, tmp_path: Path) -> None:
        path = write_image(tmp_path / "a.png", np.array([[0, 65535], [13107, 0]], np.uint16))
        ground = load(path, height_range=(-100, 900), spacing=(30, 20))
        np.testing.assert_allclose(ground.elevation, [[-100, 900], [100, -100]], atol=1e-4)
        assert ground.spacing == (30, 20)

    def test_height_range_of_signed_numbers(self, tmp_path: Path) -> None:
        np.save(tmp_path / "a.npy", np.array([[-32768, 32767], [0, 0]], np.int16))
        ground = load(tmp_path / "a.npy", height_range=(0, 65535), spacing=1)
        np.testing.assert_allclose(ground.elevation, [[0, 65535], [32768, 32768]])

    def test_transparent_grey_is_nodata(self, tmp_path: Path) -> None:
        values = np.array([[5, 6], [7, 5]], np.uint16)
        ground = load(write_image(tmp_path / "a.png", values, transparency=5), spacing=1)
        np.testing.assert_array_equal(ground.valid, [[False, True], [True, False]])

    def test_pillows_guard_stays_but_does_not_stop_large_images(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 100)
        path = write_image(tmp_path / "a.png", np.ones((30, 30), np.uint16))
        assert load(path, spacing=1).shape == (30, 30)
        assert Image.MAX_IMAGE_PIXELS == 100


class TestTerrainRgb:
    HEIGHTS = 1200 + 900 * np.sin(np.arange(64) / 9)[:, None] + 25 * np.arange(64.0)

    def mapbox(self) -> np.ndarray:
        code = np.round((self.HEIGHTS + 10000) * 10).astype(int)
        return np.stack([code >> 16, code >> 8 & 255, code & 255], -1).astype(np.uint8)

    def terrarium(self) -> np.ndarray:
        code = np.round((self.HEIGHTS + 32768) * 256).astype(int)
        return np.stack([code >> 16, code >> 8 & 255, code & 255], -1).astype(np.uint8)

    def test_mapbox(self, tmp_path: Path) -> None:
        ground = load(write_image(tmp_path / "tile.png", self.mapbox()), spacing=1)
        np.testing.assert_allclose(ground.elevation, self.HEIGHTS, atol=0.051)

    def test_terrarium(self, tmp_path: Path) -> None:
        ground = load(write_image(tmp_path / "tile.png", self.terrarium()), spacing=1)
        np.testing.assert_allclose(ground.elevation, self.HEIGHTS, atol=0.003)

    def test_tiff(self, tmp_path: Path, route: str) -> None:
        path = tmp_path / "tile.tif"
        write_tiff(path, np.moveaxis(self.mapbox(), 2, 0), photometric="RGB")
        ground = load(path)
        np.testing.assert_allclose(ground.elevation, self.HEIGHTS, atol=0.051)
        assert ground.spacing == (30, 20)

    def test_flat_sea_is_ground(self, tmp_path: Path) -> None:
        sea = np.broadcast_to(np.array([1, 134, 160], np.uint8), (8, 8, 3))
        assert load(write_image(tmp_path / "sea.png", sea), spacing=1).height_range == (0, 0)

    def test_transparent_pixels_are_nodata(self, tmp_path: Path) -> None:
        pixels = np.dstack([self.mapbox(), np.full((64, 64), 255, np.uint8)])
        pixels[5, 6] = 0
        ground = load(write_image(tmp_path / "tile.png", pixels), spacing=1)
        assert ground.mask is not None
        assert np.argwhere(ground.mask).tolist() == [[5, 6]]

    @pytest.mark.parametrize(
        "picture",
        [
            np.random.default_rng(1).integers(0, 256, (64, 64, 3)),
            np.random.default_rng(1).integers(0, 3, (64, 64, 3)),
            np.random.default_rng(1).integers(90, 160, (64, 64, 3)),
            # one red, the rest at random; black, grey, red
            np.random.default_rng(1).integers([1, 0, 0], [2, 256, 256], (64, 64, 3)),
            np.zeros((64, 64, 3)),
            np.full((64, 64, 3), 128),
            np.full((64, 64, 3), [200, 0, 0]),
            # ramps of one colour, of grey, and of a sky
            np.arange(64)[:, None, None] * np.array([4, 0, 0]) + np.zeros((64, 64, 3)),
            np.arange(64)[:, None, None] * np.array([0, 4, 0]) + np.zeros((64, 64, 3)),
            np.arange(64)[:, None, None] * np.array([1, 1, 1]) + np.full((64, 64, 3), 90),
            np.arange(64)[:, None, None] * np.array([1, 2, 1]) + np.full((64, 64, 3), 90),
        ],
    )
    def test_a_picture_is_refused(self, tmp_path: Path, picture: np.ndarray) -> None:
        path = write_image(tmp_path / "photo.png", picture.astype(np.uint8))
        assert "got three channels of colour in photo.png" in refusal(InputError, path)


class TestTiff:
    @pytest.mark.parametrize("dtype", ["uint16", "int16", "int32", "uint32", "float32"])
    def test_values_spacing_origin_crs(self, tmp_path: Path, route: str, dtype: str) -> None:
        ground = load(write_tiff(tmp_path / "dem.tif", GRID.astype(dtype)))
        np.testing.assert_array_equal(ground.elevation, GRID)
        # a cell's sample stands in its middle
        assert ground.origin == (500_015, 3_999_990)
        assert (ground.spacing, ground.crs, ground.name) == ((30, 20), "EPSG:32632", "dem")
        assert ground.mask is None

    @pytest.mark.parametrize("dtype", ["int16", "uint32", "int8"])
    def test_integers_keep_their_kind(self, tmp_path: Path, route: str, dtype: str) -> None:
        info = np.iinfo(dtype)
        values = np.array([[info.min, info.max], [0, 1]], dtype)
        path = write_tiff(tmp_path / "dem.tif", values)
        if dtype == "int8":
            with pytest.warns(UserWarning, match="8-bit"):
                ground = load(path, height_range=(0, 10))
        else:
            ground = load(path, height_range=(0, 10))
        np.testing.assert_allclose(ground.elevation[0], [0, 10], atol=1e-5)

    def test_float64_loses_nothing(self, tmp_path: Path) -> None:
        values = 4_000_000 + GRID / 1024
        ground = load(write_tiff(tmp_path / "dem.tif", values))
        np.testing.assert_array_equal(ground.elevation, values)

    def test_samples_on_points_are_not_shifted(self, tmp_path: Path, route: str) -> None:
        path = tmp_path / "dem.tif"
        write_tiff(path, GRID.astype(np.int16), tags={"AREA_OR_POINT": "Point"})
        # rasterio was given the corner of the cell, and so wrote a point half a cell off it
        assert load(path).origin == (500_015, 3_999_990)
        with Image.open(path) as image:
            assert image.tag_v2[33922][3:5] == (500_015, 3_999_990)

    @pytest.mark.parametrize("nodata", [-9999, -3.4028234663852886e38])
    def test_nodata(self, tmp_path: Path, route: str, nodata: float) -> None:
        values = GRID.astype(np.float32)
        values[1, 2] = nodata
        ground = load(write_tiff(tmp_path / "dem.tif", values, nodata=nodata))
        assert ground.mask is not None
        assert np.argwhere(ground.mask).tolist() == [[1, 2]]

    def test_nodata_is_overridden(self, tmp_path: Path, route: str) -> None:
        path = write_tiff(tmp_path / "dem.tif", GRID.astype(np.float32), nodata=120)
        ground = load(path, nodata=350)
        assert ground.mask is not None
        assert np.argwhere(ground.mask).tolist() == [[2, 3]]

    def test_nan_is_nodata(self, tmp_path: Path, route: str) -> None:
        values = GRID.astype(np.float32)
        values[0, 1] = np.nan
        ground = load(write_tiff(tmp_path / "dem.tif", values, nodata=np.nan))
        assert ground.mask is not None
        assert np.argwhere(ground.mask).tolist() == [[0, 1]]

    def test_rows_from_the_south_are_turned(self, tmp_path: Path, route: str) -> None:
        path = tmp_path / "dem.tif"
        write_tiff(path, GRID[::-1].astype(np.int16), transform=Affine(30, 0, 0, 0, 20, 100))
        ground = load(path)
        np.testing.assert_array_equal(ground.elevation, GRID)
        assert (ground.origin, ground.spacing) == ((15, 150), (30, 20))

    def test_spacing_given_wins(self, tmp_path: Path, route: str) -> None:
        ground = load(write_tiff(tmp_path / "dem.tif", GRID.astype(np.int16)), spacing=5)
        assert (ground.spacing, ground.origin) == ((5, 5), (500_015, 3_999_990))

    def test_plain_tiff_has_no_place(self, tmp_path: Path, route: str) -> None:
        ground = load(write_image(tmp_path / "dem.tif", GRID.astype(np.uint16)), spacing=1)
        np.testing.assert_array_equal(ground.elevation, GRID)
        assert (ground.spacing, ground.origin, ground.crs) == ((1, 1), (0, 0), None)

    def test_alpha_is_a_mask(self, tmp_path: Path) -> None:
        alpha = np.full(GRID.shape, 65535)
        alpha[2, 0] = 0
        path = tmp_path / "dem.tif"
        bands = np.stack([GRID, alpha]).astype(np.uint16)
        with rasterio.open(
            path, "w", driver="GTiff", count=2, height=3, width=4, dtype="uint16", transform=UTM,
            crs="EPSG:32632", alpha="yes",
        ) as file:  # fmt: skip
            file.write(bands)
            file.colorinterp = (ColorInterp.gray, ColorInterp.alpha)
        ground = load(path)
        assert ground.mask is not None
        assert np.argwhere(ground.mask).tolist() == [[2, 0]]

    def test_packed_numbers_are_unpacked(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        path = write_tiff(tmp_path / "dem.tif", GRID.astype(np.int16), nodata=120)
        with rasterio.open(path, "r+") as file:
            file.scales, file.offsets = (0.5,), (1000.0,)
        ground = load(path)
        np.testing.assert_array_equal(ground.elevation[1], 1000 + GRID[1] / 2)
        assert not ground.valid[0, 0]
        monkeypatch.setattr(readers_gdal, "has_rasterio", lambda: False)
        assert "got packed ones" in refusal(MissingExtraError, path)

    @pytest.mark.parametrize(("ending", "driver"), [("img", "HFA"), ("bil", "EHdr")])
    def test_what_else_gdal_reads(self, tmp_path: Path, ending: str, driver: str) -> None:
        path = tmp_path / f"dem.{ending}"
        ground = load(write_tiff(path, GRID.astype(np.int16), driver=driver))
        np.testing.assert_array_equal(ground.elevation, GRID)
        assert ground.origin == (500_015, 3_999_990)

    @pytest.mark.parametrize(
        ("transform", "bands", "words"),
        [
            (Affine(-30, 0, 0, 0, -30, 0), 1, "rotated or mirrored"),
            (UTM, 2, "got 2 in dem.tif (gray, undefined): choose with band="),
            (UTM, 3, "got 3 in dem.tif (gray, undefined, undefined): choose with band="),
        ],
    )
    def test_refused_with_rasterio(
        self, tmp_path: Path, transform: Affine, bands: int, words: str
    ) -> None:
        values = np.stack([GRID] * bands).astype(np.float32)
        path = write_tiff(tmp_path / "dem.tif", values, transform=transform)
        assert words in refusal(InputError, path)

    def test_rotated(self, tmp_path: Path, route: str) -> None:
        turned = Affine(30, 5, 0, 5, -30, 0)
        path = write_tiff(tmp_path / "dem.tif", GRID.astype(np.int16), transform=turned)
        assert "rotated or mirrored" in refusal(InputError, path)

    def test_control_points_are_refused(self, tmp_path: Path) -> None:
        points = [GroundControlPoint(r, c, 7 + c, 46 - r) for r, c in ((0, 0), (0, 3), (2, 0))]
        path = tmp_path / "dem.tif"
        write_tiff(path, GRID.astype(np.int16), transform=None, gcps=points)
        assert "ground control points" in refusal(InputError, path)

    @pytest.mark.parametrize("options", [{"dtype": np.float64}, {"compress": "lerc"}])
    def test_what_pillow_cannot_read_names_the_extra(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: dict[str, Any]
    ) -> None:
        monkeypatch.setattr(readers_gdal, "has_rasterio", lambda: False)
        values = GRID.astype(options.pop("dtype", np.float32))
        path = write_tiff(tmp_path / "dem.tif", values, **options)
        words = 'pip install "terrain_lod[geo]"'
        assert words in refusal(MissingExtraError, path)
        path = write_tiff(tmp_path / "dem.img", values, driver="HFA")
        assert words in refusal(MissingExtraError, path)


class TestArrays:
    @pytest.mark.parametrize("dtype", ["<f8", ">f4", ">i2", "<i8", "u1", "f2"])
    def test_npy(self, tmp_path: Path, dtype: str) -> None:
        values = (GRID % 200).astype(dtype)
        np.save(tmp_path / "a.npy", values)
        if dtype == "u1":
            with pytest.warns(UserWarning, match="8-bit"):
                ground = load(tmp_path / "a.npy", spacing=2)
        else:
            ground = load(tmp_path / "a.npy", spacing=2)
        np.testing.assert_array_equal(ground.elevation, values)

    @pytest.mark.parametrize(
        "arrays",
        [
            {"anything": GRID, "x": np.arange(4), "spacing": 3.0},
            {"heights": GRID, "normals": GRID + 1},
            {"slope": GRID + 1, "elevation": GRID},
        ],
    )
    def test_npz(self, tmp_path: Path, arrays: dict[str, Any]) -> None:
        np.savez(tmp_path / "a.npz", **arrays)
        np.testing.assert_array_equal(load(tmp_path / "a.npz", spacing=1).elevation, GRID)

    @pytest.mark.parametrize(
        ("arrays", "words"),
        [
            ({"a": GRID, "b": GRID}, "got a (3, 4), b (3, 4)"),
            ({"a": np.arange(3)}, "got a (3,)"),
            ({}, "got nothing"),
        ],
    )
    def test_npz_without_a_clear_array(
        self, tmp_path: Path, arrays: dict[str, Any], words: str
    ) -> None:
        np.savez(tmp_path / "a.npz", **arrays)
        assert words in refusal(InputError, tmp_path / "a.npz")


class TestHgt:
    @pytest.mark.parametrize("ending", [".hgt", ".HGT", ".hgt.gz", ".hgt.zip"])
    def test_a_tile(self, tmp_path: Path, ending: str) -> None:
        values = TILE.copy()
        values[3, 4] = -32768
        path = write_hgt(tmp_path / f"N46E007.SRTM{ending}", values)
        data = path.read_bytes()
        if ending == ".hgt.gz":
            path.write_bytes(gzip.compress(data, 1))
        if ending == ".hgt.zip":
            with zipfile.ZipFile(path, "w") as archive:
                archive.writestr("N46E007.hgt", data)
        ground = load(path)
        np.testing.assert_array_equal(ground.elevation[ground.valid], values[values != -32768])
        assert np.argwhere(ground.mask).tolist() == [[3, 4]]
        assert ground.name == "N46E007.SRTM"
        # 7 east, 47 north, at 46.5 degrees
        east, north = metres_per_degree(46.5)
        np.testing.assert_allclose(ground.spacing, (east / 1200, north / 1200))
        np.testing.assert_allclose(ground.origin, (7 * east, 47 * north))

    @pytest.mark.parametrize(
        ("name", "west", "north"), [("S03W061", -61, -2), ("n00e000", 0, 1), ("S01E179", 179, 0)]
    )
    def test_quarters_of_the_globe(self, tmp_path: Path, name: str, west: int, north: int) -> None:
        ground = load(write_hgt(tmp_path / f"{name}.hgt", TILE))
        per_degree = 1200 * np.array(ground.spacing)
        np.testing.assert_allclose(np.array(ground.origin) / per_degree, (west, north))

    @pytest.mark.parametrize("shape", [(3601, 3601), (3601, 1801)])
    def test_one_arc_second(self, tmp_path: Path, shape: tuple[int, int]) -> None:
        ground = load(write_hgt(tmp_path / "N60E007.hgt", np.zeros(shape)))
        assert ground.shape == shape
        east, north = metres_per_degree(60.5)
        expected = east / (shape[1] - 1), north / (shape[0] - 1)
        np.testing.assert_allclose(ground.spacing, expected)

    def test_a_name_without_a_place_needs_spacing(self, tmp_path: Path) -> None:
        path = write_hgt(tmp_path / "alps.hgt", TILE)
        assert "give spacing= in metres" in refusal(InputError, path)
        ground = load(path, spacing=(64, 93))
        assert (ground.spacing, ground.origin) == ((64, 93), (0, 0))

    def test_a_zip_of_two(self, tmp_path: Path) -> None:
        with zipfile.ZipFile(tmp_path / "N46E007.hgt.zip", "w") as archive:
            archive.writestr("a.hgt", b"")
            archive.writestr("b.hgt", b"")
        assert "got a.hgt, b.hgt" in refusal(InputError, tmp_path / "N46E007.hgt.zip")


class TestAsc:
    def test_corner(self, tmp_path: Path) -> None:
        values = GRID.astype(float)
        values[0, 3] = -32768
        header = "XLLCORNER 1000\nYLLCORNER 2000\nCELLSIZE 30\nNODATA_value -32768"
        ground = load(write_asc(tmp_path / "a.asc", header, values))
        assert (ground.spacing, ground.origin) == ((30, 30), (1015, 2075))
        assert np.argwhere(ground.mask).tolist() == [[0, 3]]
        np.testing.assert_array_equal(ground.elevation[1:], GRID[1:])

    def test_centre_and_oblong_cells(self, tmp_path: Path) -> None:
        header = "xllcenter 1000\nyllcenter 2000\ndx 30\ndy 20"
        ground = load(write_asc(tmp_path / "a.asc", header))
        assert (ground.spacing, ground.origin) == ((30, 20), (1000, 2040))
        assert ground.crs is None

    def test_lines_may_break_anywhere(self, tmp_path: Path) -> None:
        path = tmp_path / "a.asc"
        path.write_text("ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 9\n1.5\n2 3\n-9999")
        ground = load(path)
        np.testing.assert_array_equal(ground.elevation, [[1.5, 2], [3, np.nan]])

    def test_prj(self, tmp_path: Path) -> None:
        crs = rasterio.CRS.from_epsg(32632).to_wkt(version="WKT1_ESRI")
        (tmp_path / "a.prj").write_text(crs)
        path = write_asc(tmp_path / "a.asc", "xllcorner 0.001\nyllcorner 0\ncellsize 0.01")
        ground = load(path)
        assert (ground.spacing, ground.crs) == ((0.01, 0.01), crs)

    @pytest.mark.parametrize(
        ("text", "error", "words"),
        [
            (f"{CORNER} 1 2 3 4", InputError, "dx or cellsize"),
            (f"{CORNER} cellsize 1 1 2 3", FileError, "2 x 2 = 4 heights in a.asc, got 3"),
            (f"{CORNER} cellsize 1 1 2,5 3 4", InputError, "got '2,5'"),
            (f"{CORNER} cellsize 0 1 2 3 4", InputError, "spacing > 0"),
            (f"{CORNER} cellsize x 1 2 3 4", FileError, "'x'"),
        ],
    )
    def test_refused(
        self, tmp_path: Path, text: str, error: type[TerrainError], words: str
    ) -> None:
        (tmp_path / "a.asc").write_text(text)
        assert words in refusal(error, tmp_path / "a.asc")


class TestDegrees:
    def test_a_degree_in_metres(self) -> None:
        # National Geospatial-Intelligence Agency, "Length of a degree of latitude and longitude"
        np.testing.assert_allclose(metres_per_degree(0), (111_319.49, 110_574.28), atol=0.01)
        np.testing.assert_allclose(metres_per_degree(45), (78_846.81, 111_131.75), atol=0.1)
        np.testing.assert_allclose(metres_per_degree(-60), (55_800.0, 111_412.24), atol=0.1)

    @pytest.mark.slow
    def test_three_formats_agree(
        self, tmp_path: Path, route: str, caplog: pytest.LogCaptureFixture
    ) -> None:
        values, step = TILE, 1 / 1200
        corner = Affine(step, 0, 7 - step / 2, 0, -step, 47 + step / 2)
        write_hgt(tmp_path / "N46E007.hgt", values)
        write_tiff(tmp_path / "a.tif", values, crs="EPSG:4326", transform=corner)
        header = f"xllcenter 7\nyllcenter 46\ncellsize {step!r}"
        write_asc(tmp_path / "a.asc", header, values)
        (tmp_path / "a.prj").write_text(rasterio.CRS.from_epsg(4326).to_wkt(version="WKT1_ESRI"))
        with caplog.at_level("INFO", "terrain_lod"):
            grounds = [load(tmp_path / name) for name in ("N46E007.hgt", "a.tif", "a.asc")]
        assert caplog.text.count("made local metres at latitude 46.5000") == 3
        for ground in grounds:
            np.testing.assert_allclose(ground.spacing, grounds[0].spacing)
            np.testing.assert_allclose(ground.origin, grounds[0].origin)
            np.testing.assert_array_equal(ground.elevation, values)
        # the way back to degrees is recorded, in words that GDAL parses
        for ground in grounds[:2]:
            assert ground.crs is not None
            assert "EPSG:4326" in ground.crs
            rasterio.CRS.from_wkt(ground.crs)
            east, north = (float(word) for word in ground.crs.split() if word[0].isdigit())
            np.testing.assert_allclose(np.array(ground.origin) / (east, north), (7, 47))

    def test_spacing_given_decides(self, tmp_path: Path) -> None:
        ground = load(write_hgt(tmp_path / "N46E007.hgt", TILE), spacing=(60, 90))
        np.testing.assert_allclose(ground.spacing, (60, 90))
        np.testing.assert_allclose(ground.origin, (7 * 60 * 1200, 47 * 90 * 1200))

    def test_too_tall_for_a_flat_grid(self, tmp_path: Path) -> None:
        world = Affine(30, 0, -180, 0, -30, 60)
        values = GRID.astype(np.int16)
        path = write_tiff(tmp_path / "a.tif", values, crs="EPSG:4326", transform=world)
        assert "reproject it, or give spacing=" in refusal(InputError, path)
        assert load(path, spacing=3e6).spacing == (3e6, 3e6)

    def test_degrees_or_metres(self, tmp_path: Path) -> None:
        path = write_asc(tmp_path / "a.asc", "xllcenter 7\nyllcenter 46\ncellsize 0.01")
        assert "could be degrees or metres" in refusal(InputError, path)
        ground = load(path, spacing=0.01)
        np.testing.assert_allclose(ground.origin, (7, 46.02))


def test_every_ending_is_in_the_manual() -> None:
    assert load.__doc__ is not None
    for form in FORMATS:
        for ending in form.endings:
            assert ending in load.__doc__ or ending in (".jpeg", ".tiff")
