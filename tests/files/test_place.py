"""Units brought to one, maps true to scale, and what a file does not say."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from rasterio.rpc import RPC
from rasterio.transform import Affine

from support.rasters import GRID, refusal, write_asc, write_image, write_tiff
from terrain_lod.errors import FileError, InputError, MissingExtraError
from terrain_lod.files.rasters.degrees import metres_per_degree, told_apart
from terrain_lod.files.rasters.loading import load

FLOAT = GRID.astype(np.float32)
FOOT = 1200 / 3937
STATE_PLANE = {"crs": "EPSG:2263", "transform": Affine(25, 0, 980_000, 0, -25, 200_000)}
DEGREES = {"crs": "EPSG:4326", "transform": Affine(1e-3, 0, 7, 0, -1e-3, 46)}


def with_unit(path: Path, unit: str | None, **options: Any) -> Path:
    write_tiff(path, FLOAT, **options)
    if unit is not None:
        with rasterio.open(path, "r+") as file:
            file.units = (unit,)
    return path


class TestUnits:
    @pytest.mark.parametrize(
        ("unit", "options", "units", "factor"),
        [
            ("US survey foot", DEGREES, "metre", FOOT),
            ("ft", {}, "metre", 0.3048),
            ("Feet", {}, "metre", 0.3048),
            ("cm", {}, "metre", 0.01),
            ("m", {}, "metre", 1),
            ("metre", STATE_PLANE, "US survey foot", 1 / FOOT),
            ("US survey foot", STATE_PLANE, "US survey foot", 1),
            ("foot", STATE_PLANE, "US survey foot", 0.3048 / FOOT),
            (None, STATE_PLANE | {"crs": "EPSG:2263+5703"}, "US survey foot", 1 / FOOT),
            (None, STATE_PLANE | {"crs": "EPSG:2263+6360"}, "US survey foot", 1),
            (None, {"crs": "EPSG:32632+8228"}, "metre", 0.3048),
        ],
    )
    def test_both_are_read_and_brought_to_one(
        self, tmp_path: Path, route: str, unit: str, options: dict[str, Any], units: str,
        factor: float,
    ) -> None:  # fmt: skip
        path = with_unit(tmp_path / "a.tif", unit, **options)
        if route == "Pillow" and "2263+" in options.get("crs", ""):
            assert "to name its unit" in refusal(MissingExtraError, path)
            return
        ground = load(path)
        assert ground.units == (units, units)
        np.testing.assert_allclose(ground.elevation, GRID * factor, rtol=1e-6)
        assert f" {ground.unit_symbols[1]})" in repr(ground)

    def test_feet_that_do_not_say_so(self, tmp_path: Path) -> None:
        path = with_unit(tmp_path / "a.tif", None, **STATE_PLANE)
        with pytest.warns(UserWarning, match=r"does not say .* taken as US survey foot.* z_unit="):
            ground = load(path)
        assert ground.units == ("US survey foot", "US survey foot")
        np.testing.assert_array_equal(ground.elevation, GRID)
        np.testing.assert_allclose(load(path, z_unit="metre").elevation, GRID / FOOT, rtol=1e-6)

    def test_unknown_unit(self, tmp_path: Path) -> None:
        path = with_unit(tmp_path / "a.tif", "smoot")
        with pytest.warns(
            UserWarning, match=r"heights in 'smoot', an unknown unit: taken as metre"
        ):
            assert load(path).units == ("metre", "metre")

    def test_overridden(self, tmp_path: Path) -> None:
        path = with_unit(tmp_path / "a.tif", "ft")
        np.testing.assert_allclose(load(path, z_unit="m").elevation, GRID)
        np.testing.assert_allclose(load(path, z_scale=2).elevation, GRID * 2)
        both = load(path, z_unit="centimetre", z_scale=10)
        np.testing.assert_allclose(both.elevation, GRID / 10, rtol=1e-6)
        assert "expected one of metre, foot" in refusal(InputError, path, z_unit="smoot")
        assert "finite z_scale" in refusal(InputError, path, z_scale=float("nan"))
        assert "z_scale other than 0" in refusal(InputError, path, z_scale=0)

    def test_packed_feet(self, tmp_path: Path) -> None:
        path = write_tiff(tmp_path / "a.tif", GRID.astype(np.int16), nodata=120)
        with rasterio.open(path, "r+") as file:
            file.scales, file.offsets, file.units = (0.5,), (10.0,), ("ft",)
        ground = load(path)
        np.testing.assert_allclose(ground.elevation[1], (GRID[1] / 2 + 10) * 0.3048)
        assert not ground.valid[0, 0]

    def test_grads(self, tmp_path: Path, route: str) -> None:
        grads = {"crs": "EPSG:4807", "transform": Affine(1e-3, 0, 5, 0, -1e-3, 51)}
        ground = load(with_unit(tmp_path / "a.tif", None, **grads))
        east, north = metres_per_degree(0.9 * (51 - 1.5e-3))
        np.testing.assert_allclose(ground.spacing, (9e-4 * east, 9e-4 * north), rtol=1e-4)
        assert ground.crs is not None
        assert "grads of EPSG:4807" in ground.crs

    def test_another_planet(self, tmp_path: Path) -> None:
        mars = {
            "crs": "+proj=longlat +R=3396190",
            "transform": Affine(1e-3, 0, 7, 0, -1e-3, 0.0015),
        }
        ground = load(with_unit(tmp_path / "a.tif", None, **mars))
        np.testing.assert_allclose(ground.spacing, np.radians(1e-3) * 3_396_190, rtol=1e-6)

    def test_prj_of_an_asc(self, tmp_path: Path) -> None:
        path = write_asc(tmp_path / "a.asc", "xllcorner 980000\nyllcorner 200000\ncellsize 25")
        wkt = rasterio.CRS.from_epsg(2263).to_wkt(version="WKT1_ESRI")
        (tmp_path / "a.prj").write_text(wkt)
        with pytest.warns(UserWarning, match="US survey foot"):
            ground = load(path)
        assert ground.units == ("US survey foot", "US survey foot")
        (tmp_path / "a.prj").write_text("Projection  UTM\nZone  11\nUnits  METERS\nZunits  FEET\n")
        np.testing.assert_allclose(load(path).elevation, GRID * 0.3048)


class TestStretch:
    @pytest.mark.parametrize("latitude", [0.0, 10.0, 46.0, 60.0, -75.0])
    def test_map_of_the_web(
        self, tmp_path: Path, route: str, latitude: float, caplog: pytest.LogCaptureFixture
    ) -> None:
        (x,), (y,) = rasterio.warp.transform("EPSG:4326", "EPSG:3857", [11.0], [latitude])
        place = Affine(30, 0, x - 60, 0, -20, y + 30)
        path = write_tiff(tmp_path / "a.tif", FLOAT, crs="EPSG:3857", transform=place)
        with caplog.at_level("INFO", "terrain_lod"):
            ground = load(path)
        # on the ellipsoid a parallel is shorter by cos(latitude) / W, a meridian by the same / W^2
        flat = np.cos(np.radians(latitude))
        w = np.sqrt(1 - 0.00669437999014 * np.sin(np.radians(latitude)) ** 2)
        true = 30 * flat / w, 20 * flat * (1 - 0.00669437999014) / w**3
        np.testing.assert_allclose(ground.spacing, true, rtol=1e-5)
        scale = np.array(ground.spacing) / (30, 20)
        np.testing.assert_allclose(np.array(ground.origin) / scale, (x - 45, y + 20), atol=1e-3)
        assert "made true to scale" in caplog.text
        assert ground.crs is not None
        assert ground.crs.startswith('LOCAL_CS["EPSG:3857 times')
        as_it_is = load(path, spacing="map")
        assert (as_it_is.spacing, as_it_is.crs) == ((30, 20), "EPSG:3857")
        np.testing.assert_allclose(as_it_is.origin, (x - 45, y + 20))
        assert load(path, spacing=30).spacing == (30, 30)

    def test_any_map_that_is_far_off(self, tmp_path: Path) -> None:
        place = Affine(30, 0, 100_000, 0, -30, 6_679_169)
        path = write_tiff(tmp_path / "a.tif", FLOAT, crs="EPSG:4087", transform=place)
        np.testing.assert_allclose(load(path).spacing, (15.05, 30), rtol=3e-3)

    def test_a_map_that_is_nearly_true_stays(self, tmp_path: Path) -> None:
        for crs, place in (("EPSG:32632", Affine(30, 0, 3e5, 0, -30, 5e6)),
                           ("EPSG:3413", Affine(30, 0, 1e5, 0, -30, -1e6)),
                           ("EPSG:3035", Affine(30, 0, 4e6, 0, -30, 3e6))):  # fmt: skip
            ground = load(write_tiff(tmp_path / "a.tif", FLOAT, crs=crs, transform=place))
            assert (ground.spacing, ground.crs) == ((30, 30), crs)

    def test_too_tall(self, tmp_path: Path, route: str) -> None:
        place = Affine(1e5, 0, 0, 0, -2e6, 8e6)
        path = write_tiff(tmp_path / "a.tif", FLOAT, crs="EPSG:3857", transform=place)
        assert 'spacing="map"' in refusal(InputError, path)
        assert load(path, spacing="map").spacing == (1e5, 2e6)

    def test_degrees_have_no_map(self, tmp_path: Path) -> None:
        path = write_tiff(tmp_path / "a.tif", FLOAT, **DEGREES)
        assert "projected CRS" in refusal(InputError, path, spacing="map")
        assert '"map" for spacing' in refusal(InputError, path, spacing="maps")

    def test_digits_that_matter(self, tmp_path: Path) -> None:
        assert told_apart(0.05, 0.0504) == ("5.00%", "5.04%")
        assert told_apart(0.05, 0.3) == ("5%", "30%")
        half = 2.714  # degrees of latitude: 5.0004 % off
        tall = Affine(0.01, 0, 7, 0, -2 * half / 3, 46 + half * 4 / 3)
        values = np.zeros((4, 4), np.float32)
        message = refusal(
            InputError, write_tiff(tmp_path / "a.tif", values, crs="EPSG:4326", transform=tall)
        )
        limit, got = (word for word in message.replace(",", "").split() if word.endswith("%"))
        assert limit != got


class TestUnsaid:
    @pytest.mark.parametrize("name", ["a.png", "a.npy", "a.tif"])
    def test_spacing_is_asked_for_once(self, tmp_path: Path, name: str) -> None:
        if name == "a.npy":
            np.save(tmp_path / name, GRID)
        else:
            write_image(tmp_path / name, GRID.astype(np.uint16))
        with pytest.warns(UserWarning, match=r"how far apart .* give spacing=") as caught:
            assert load(tmp_path / name).spacing == (1, 1)
        assert len(caught) == 1
        assert caught[0].filename == __file__
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            load(tmp_path / name, spacing=3)

    def test_world_file(self, tmp_path: Path, route: str) -> None:
        path = write_image(tmp_path / "a.png", GRID.astype(np.uint16))
        (tmp_path / "a.pgw").write_text("30\n0\n0\n-20\n500015\n3999990\n")
        ground = load(path)
        assert (ground.spacing, ground.origin) == ((30, 20), (500_015, 3_999_990))
        part = load(path, window=(1, 1, 2, 2))
        assert part.origin == (500_045, 3_999_970)
        if route == "Pillow":
            (tmp_path / "a.pgw").write_text("30\nwide")
            assert "six numbers in a.pgw" in refusal(FileError, path)

    def test_polynomials_of_a_camera_are_refused(self, tmp_path: Path, route: str) -> None:
        path = write_image(tmp_path / "a.tif", GRID.astype(np.uint16))
        terms = [1.0, *[0.0] * 19]
        rpc = RPC(
            err_bias=0.0, err_rand=0.0, height_off=0.0, height_scale=1.0, lat_off=46.0,
            lat_scale=1.0, line_den_coeff=terms, line_num_coeff=terms, line_off=0.0,
            line_scale=1.0, long_off=7.0, long_scale=1.0, samp_den_coeff=terms,
            samp_num_coeff=terms, samp_off=0.0, samp_scale=1.0,
        )  # fmt: skip
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with rasterio.open(path, "r+") as file:
                file.rpcs = rpc
        assert "a camera's polynomials (RPC)" in refusal(InputError, path)
