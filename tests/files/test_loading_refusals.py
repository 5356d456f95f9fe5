"""Files that hold no ground, and arguments that fit none: one line each."""

from __future__ import annotations

import gzip
import zipfile
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from support.rasters import GRID, TILE, refusal, write_hgt, write_image, write_tiff
from terrain_lod.errors import FileError, InputError, MissingExtraError
from terrain_lod.files.rasters import readers_gdal
from terrain_lod.files.rasters.formats import FORMATS
from terrain_lod.files.rasters.loading import load


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (np.ones((1, 1)), "at least 2 x 2 samples, got shape (1, 1)"),
        (np.ones((1, 9)), "at least 2 x 2 samples, got shape (1, 9)"),
        (np.ones((3, 3, 3)), "at least 2 x 2 samples, got shape (3, 3, 3)"),
        (np.full((3, 3), np.nan), "no data at all"),
        (np.array([[1, np.inf], [0, 0]]), "got inf at [0, 1]"),
        (np.array([[1, 0], [-np.inf, 0]]), "got -inf at [1, 0]"),
        (np.array([[1, 2], [3, 4j]]), "heights as real numbers"),
    ],
)
def test_no_ground(tmp_path: Path, values: np.ndarray, words: str) -> None:
    np.save(tmp_path / "a.npy", values)
    assert words in refusal(InputError, tmp_path / "a.npy")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"spacing": 0}, "spacing > 0, got 0"),
        ({"spacing": (30, -1)}, "spacing > 0, got -1"),
        ({"spacing": 1e39}, "spacing from 1e-18 to 1e+18, got 1e+39"),
        ({"spacing": (1, 1e-320)}, "spacing from 1e-18 to 1e+18, got 9.99989e-321"),
        ({"spacing": (1, 2, 3)}, "spacing as (x, y), got (1, 2, 3)"),
        ({"spacing": float("nan")}, "finite spacing"),
        ({"spacing": "wide"}, "spacing"),
        ({"height_range": (9, 3)}, "from low to high, got 9 to 3"),
        ({"height_range": (9,)}, "(low, high), got (9,)"),
        ({"height_range": 9}, "(low, high), got 9"),
        ({"nodata": "none"}, "number for nodata, got 'none'"),
    ],
)
def test_arguments(tmp_path: Path, options: dict[str, Any], words: str) -> None:
    path = write_image(tmp_path / "a.png", GRID.astype(np.uint16))
    assert words in refusal(InputError, path, **options)


def test_height_range_of_heights(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", GRID.astype(np.float32))
    words = "got float32 in a: its numbers are heights already"
    assert words in refusal(InputError, tmp_path / "a.npy", height_range=(0, 1))


def test_missing(tmp_path: Path) -> None:
    assert f"got nothing at {tmp_path}" in refusal(FileError, tmp_path / "a.tif")
    assert "got a folder" in refusal(FileError, tmp_path)


def test_unknown_ending(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.xyz").touch()
    assert "a raster that GDAL reads in a.xyz" in refusal(FileError, tmp_path / "a.xyz")
    monkeypatch.setattr(readers_gdal, "has_rasterio", lambda: False)
    message = refusal(MissingExtraError, tmp_path / "a.xyz")
    for form in FORMATS:
        assert all(ending in message for ending in form.endings)


@pytest.mark.parametrize("share", [0.0, 0.5, 0.95])
@pytest.mark.parametrize(
    "name", ["a.png", "a.jpg", "a.tif", "a.npy", "a.npz", "N46E007.hgt", "N46E007.hgt.gz",
             "N46E007.hgt.zip"],
)  # fmt: skip
def test_truncated(tmp_path: Path, route: str, name: str, share: float) -> None:
    path = tmp_path / name
    values = np.random.default_rng(0).integers(0, 65536, (120, 120)).astype(np.uint16)
    match name.partition(".")[2]:
        case "png" | "jpg":
            write_image(path, values if name == "a.png" else values.astype(np.uint8))
        case "tif":
            write_tiff(path, values, compress="deflate")
        case "npy":
            np.save(path, values)
        case "npz":
            np.savez_compressed(path, heights=values)
        case "hgt":
            write_hgt(path, TILE)
        case "hgt.gz":
            path.write_bytes(gzip.compress(values.tobytes()))
        case "hgt.zip":
            with zipfile.ZipFile(path, "w") as archive:
                archive.writestr("N46E007.hgt", values.tobytes())
    data = path.read_bytes()
    path.write_bytes(data[: int(len(data) * share)])
    # to some versions of Pillow a cut TIFF looks like one of another kind
    without_rasterio = name == "a.tif" and route == "Pillow" and share > 0
    errors = (FileError, MissingExtraError) if without_rasterio else FileError
    assert name in refusal(errors, path)


@pytest.mark.parametrize("dtype", [np.uint16, np.uint8])
@pytest.mark.parametrize("channels", [2, 3, 4])
def test_png_channels(tmp_path: Path, dtype: type, channels: int) -> None:
    values = np.random.default_rng(0).integers(0, 65536, (channels, 9, 9)).astype(dtype)
    path = write_tiff(tmp_path / "a.png", values, driver="PNG", crs=None)
    if channels == 2:
        # grey and alpha
        doubts = pytest.warns(UserWarning, match="8-bit") if dtype == np.uint8 else nullcontext()
        with doubts:
            ground = load(path, spacing=1)
        np.testing.assert_array_equal(ground.valid, values[1] != 0)
    else:
        words = "got 3 in a.png (red, green, blue)"
        assert (words if dtype == np.uint16 else "three channels of colour") in refusal(
            InputError, path
        )


def test_palette(tmp_path: Path) -> None:
    Image.new("P", (8, 8)).save(tmp_path / "a.png")
    assert "got a picture whose numbers stand for colours of a palette in a.png" in refusal(
        InputError, tmp_path / "a.png"
    )
