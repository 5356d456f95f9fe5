"""Ground brought to another map: where it stands, and the error that is stated of it."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import pytest
from rasterio.transform import Affine
from rasterio.warp import transform

from support.rasters import refusal, write_tiff
from terrain_lod.errors import InputError
from terrain_lod.files.rasters.loading import load
from terrain_lod.ground.heightmap import Heightmap

DEGREES = Affine(1 / 1200, 0, 7.0, 0, -1 / 1200, 46.05)
PLACES = {
    "EPSG:4326": DEGREES,
    "EPSG:3857": Affine(100, 0, 779_000, 0, -100, 5_780_000),
    "EPSG:2056": Affine(50, 0, 2_600_000, 0, -50, 1_120_000),
    "EPSG:2263": Affine(90, 0, 980_000, 0, -90, 200_000),
}


def waves(rows: int = 60, columns: int = 70) -> np.ndarray:
    row, column = np.mgrid[:rows, :columns]
    return np.float32(800 + 90 * np.sin(row / 9) + 70 * np.cos(column / 7))


def told(path: Path, **options: object) -> tuple[Heightmap, float]:
    """Return ground, and the distance from its own samples that is stated."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ground = load(path, **options)
    found = re.search(r"within (\S+) .* of its own samples", str(caught[-1].message))
    assert found is not None
    return ground, float(found[1])


@pytest.mark.parametrize("crs", PLACES)
def test_the_stated_error_is_that_of_the_files_own_samples(tmp_path: Path, crs: str) -> None:
    values, affine = waves(), PLACES[crs]
    path = write_tiff(tmp_path / "a.tif", values, crs=crs, transform=affine)
    ground, stated = told(path, crs="utm", z_unit="metre")
    assert ground.crs is not None
    assert ground.crs.startswith("EPSG:326")
    row, column = (part.ravel() for part in np.mgrid[:60, :70])
    x, y = affine.c + affine.a * (column + 0.5), affine.f + affine.e * (row + 0.5)
    x, y = (np.array(part) for part in transform(crs, ground.crs, x, y))
    across = (x - ground.origin[0]) / ground.spacing[0]
    down = (ground.origin[1] - y) / ground.spacing[1]
    left, top = np.floor(across).astype(int), np.floor(down).astype(int)
    inside = (left >= 0) & (top >= 0)
    inside &= (left < ground.shape[1] - 1) & (top < ground.shape[0] - 1)
    assert inside.mean() > 0.9
    left, top, u, v = (part[inside] for part in (left, top, across - left, down - top))
    height = ground.elevation
    seen = (1 - v) * ((1 - u) * height[top, left] + u * height[top, left + 1])
    seen += v * ((1 - u) * height[top + 1, left] + u * height[top + 1, left + 1])
    off = np.nanmax(np.abs(seen - values.ravel()[inside]))
    assert 0 < off < 10
    # three digits are said; samples on the border may be on one side of it here, and not there
    assert 0.99 * off <= stated < 1.5 * off


def test_a_map_of_its_own_is_left_as_it_is(tmp_path: Path) -> None:
    path = write_tiff(tmp_path / "a.tif", waves())
    ground, stated = told(path, crs="EPSG:32632")
    assert stated < 1e-6
    np.testing.assert_allclose(ground.elevation, waves(), atol=1e-3)
    assert ground.spacing == pytest.approx((30, 20))
    assert ground.origin == pytest.approx((500_015, 3_999_990))


def test_spacing_is_that_of_the_new_grid(tmp_path: Path) -> None:
    path = write_tiff(tmp_path / "a.tif", waves(), crs="EPSG:4326", transform=DEGREES)
    ground, _ = told(path, crs="EPSG:32632", spacing=(40.0, 50.0))
    assert ground.spacing == (40.0, 50.0)


def test_holes_and_units_of_heights_are_kept(tmp_path: Path) -> None:
    values = waves()
    values[20:30, 20:30] = -9999
    path = write_tiff(tmp_path / "a.tif", values, nodata=-9999)
    ground, _ = told(path, crs="EPSG:25832")
    assert ground.mask is not None
    assert ground.mask[25, 25]
    assert ground.height_range[0] > 600
    # metres of a map in metres, on a map in feet
    harbour = Affine(30, 0, 583_000, 0, -30, 4_507_000)
    path = write_tiff(tmp_path / "b.tif", waves(), crs="EPSG:32618", transform=harbour)
    feet, _ = told(path, crs="EPSG:2263")
    assert feet.units == ("US survey foot", "US survey foot")
    assert feet.height_range[0] > 600 / 0.3049


def test_zones_of_the_south(tmp_path: Path) -> None:
    south = Affine(0.001, 0, -70.5, 0, -0.001, -33.0)
    path = write_tiff(tmp_path / "a.tif", waves(), crs="EPSG:4326", transform=south)
    assert told(path, crs="utm")[0].crs == "EPSG:32719"


def test_what_cannot_be_is_refused_in_one_line(tmp_path: Path) -> None:
    path = write_tiff(tmp_path / "a.tif", waves())
    assert "projected CRS" in refusal(InputError, path, crs="EPSG:4326")
    assert "that PROJ knows" in refusal(InputError, path, crs="EPSG:99999999")
    assert "height_range or crs" in refusal(InputError, path, crs="utm", height_range=(0.0, 1.0))
    polar = Affine(0.001, 0, 10.0, 0, -0.001, 89.0)
    path = write_tiff(tmp_path / "b.tif", waves(), crs="EPSG:4326", transform=polar)
    assert "80° south and 84° north" in refusal(InputError, path, crs="utm")
    path = write_tiff(tmp_path / "c.tif", waves(), crs=None)
    assert "in which CRS" in refusal(InputError, path, crs="utm")
