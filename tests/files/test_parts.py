"""Parts of files: bounds, windows, overviews and bands."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from rasterio.enums import Resampling
from rasterio.transform import Affine
from rasterio.windows import Window, from_bounds

from support.rasters import TILE, refusal, write_asc, write_hgt, write_image, write_tiff
from terrain_lod.errors import InputError
from terrain_lod.files.rasters.loading import load

RAMP = np.add.outer(100.0 * np.arange(20), np.arange(30)).astype(np.float32)
CELLS = Affine(30, 0, 500_000, 0, -20, 4_000_000)


def some(tmp_path: Path) -> Path:
    return write_tiff(tmp_path / "a.tif", RAMP, transform=CELLS)


@pytest.mark.parametrize(
    "window", [(4, 5, 6, 7), Window(4, 5, 6, 7), ((5, 12), (4, 10)), [[5, 12], [4, 10]]]
)
def test_window_in_every_form(tmp_path: Path, route: str, window: Any) -> None:
    ground = load(some(tmp_path), window=window)
    np.testing.assert_array_equal(ground.elevation, RAMP[5:12, 4:10])
    assert ground.origin == (500_000 + 30 * 4.5, 4_000_000 - 20 * 5.5)
    assert (ground.spacing, ground.crs) == ((30, 20), "EPSG:32632")


def test_bounds_are_those_of_rasterio(tmp_path: Path, route: str) -> None:
    path, bounds = some(tmp_path), (500_120, 3_999_760, 500_300, 3_999_900)
    ground = load(path, bounds=bounds)
    with rasterio.open(path) as file:
        window = from_bounds(*bounds, file.transform)
        np.testing.assert_array_equal(ground.elevation, file.read(1, window=window))


def test_samples_on_bounds_are_within(tmp_path: Path) -> None:
    ground = load(some(tmp_path), bounds=(500_015, 3_999_950, 500_045, 3_999_990))
    np.testing.assert_array_equal(ground.elevation, RAMP[:3, :2])


def test_files_of_one_piece(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", RAMP)
    write_image(tmp_path / "a.png", RAMP.astype(np.uint16))
    for name in ("a.npy", "a.png"):
        ground = load(tmp_path / name, window=(4, 5, 6, 7), spacing=2)
        np.testing.assert_array_equal(ground.elevation, RAMP[5:12, 4:10])
        message = refusal(InputError, tmp_path / name, bounds=(0, 0, 1, 1), spacing=2)
        assert "says where it is with bounds=" in message
    path = write_asc(tmp_path / "a.asc", "xllcorner 5e5\nyllcorner 0\ncellsize 10", RAMP)
    ground = load(path, bounds=(500_040, 80, 500_100, 150))
    np.testing.assert_array_equal(ground.elevation, RAMP[5:12, 4:10])
    assert ground.origin == (500_045, 145)
    tile = load(write_hgt(tmp_path / "N46E007.hgt", TILE), bounds=(7.25, 46.5, 7.5, 46.75))
    assert tile.shape == (301, 301)
    np.testing.assert_array_equal(tile.elevation, TILE[300:601, 300:601])


def test_overviews(tmp_path: Path) -> None:
    path = some(tmp_path)
    assert "that a.tif has, none, got 0" in refusal(InputError, path, overview=0)
    with rasterio.open(path, "r+") as file:
        file.build_overviews([2, 5], Resampling.nearest)
    assert load(path, overview=0).shape == (10, 15)
    second = load(path, overview=1)
    assert (second.shape, second.spacing) == ((4, 6), (150, 100))
    assert second.origin == (500_075, 3_999_950)
    assert "0 to 1, got 2" in refusal(InputError, path, overview=2)
    np.save(tmp_path / "a.npy", RAMP)
    assert "which has none" in refusal(InputError, tmp_path / "a.npy", overview=0)


def test_bands(tmp_path: Path) -> None:
    path = write_tiff(tmp_path / "a.tif", np.stack([RAMP, RAMP + 1, RAMP + 2]))
    with rasterio.open(path, "r+") as file:
        file.descriptions = ("slope", "aspect", "dem")
    words = "got 3 in a.tif (slope, aspect, dem): choose with band="
    assert words in refusal(InputError, path)
    np.testing.assert_array_equal(load(path, band=3).elevation, RAMP + 2)
    assert "band from 1 to 3 in a.tif, got 4" in refusal(InputError, path, band=4)
    colours = np.random.default_rng(0).integers(0, 256, (9, 9, 3)).astype(np.uint8)
    write_image(tmp_path / "a.png", colours)
    with pytest.warns(UserWarning, match="8-bit"):
        green = load(tmp_path / "a.png", band=2, spacing=1)
    np.testing.assert_array_equal(green.elevation, colours[..., 1])


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"window": (0, 0, 31, 20)}, "within 30 x 20 samples in a.tif, got columns 0 to 31"),
        ({"window": (0, 0, 1, 20)}, "from 2 to"),
        ({"window": (-1, 0, 9, 9)}, "window's start"),
        ({"window": 3}, "(column, row, width, height), got 3"),
        ({"window": "near"}, "window as"),
        ({"window": (0, 0, 0.5, 9)}, "whole number"),
        ({"bounds": (0, 0, 1, 1)}, "which reaches from (500015, 3999610)"),
        ({"bounds": (1, 0, 0, 1)}, "from west to east"),
        ({"bounds": (0, 0, 1)}, "(west, south, east, north), got (0, 0, 1)"),
        ({"bounds": (0, 0, 1, float("nan"))}, "finite bounds"),
        ({"bounds": (0, 0, 1, 1), "window": (0, 0, 9, 9)}, "got both"),
        ({"overview": -1}, "for overview"),
        ({"band": 0}, "for band"),
        ({"band": "red"}, "number for band"),
    ],
)
def test_refused(tmp_path: Path, options: dict[str, Any], words: str) -> None:
    assert words in refusal(InputError, some(tmp_path), **options)
