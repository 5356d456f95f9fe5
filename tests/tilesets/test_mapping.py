"""Ground that is read window by window becomes the tiles that it becomes in memory."""

from __future__ import annotations

import os
import struct
from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.tilesets import contents, jacksboro, measured, read_glb
from terrain_lod.tilesets import mapping

BOXES = {"format": "3dtiles", "error": 40.0, "zoom": 1}


@pytest.fixture
def raster(tmp_path):
    """Real ground as a file, and the same ground loaded."""
    rasterio = pytest.importorskip("rasterio")
    ground = jacksboro()
    heights = ground.elevation.astype(np.float32)
    step = 1 / 1200
    transform = rasterio.Affine(step, 0, -84.3, 0, -step, 36.65)
    path = tmp_path / "ground.tif"
    rows, columns = heights.shape
    with rasterio.open(path, "w", "GTiff", columns, rows, 1, "EPSG:4326", transform,
                       "float32") as file:  # fmt: skip
        file.write(heights, 1)
    return path


@pytest.mark.parametrize("format", ["3dtiles", "terrarium"])
def test_a_file_read_by_windows_becomes_the_same_tiles(raster, tmp_path, format, monkeypatch):
    options = {"format": format, "zoom": 1}
    # in windows of a few rows
    monkeypatch.setattr(mapping, "_TOGETHER", 1000)
    tl.write_tiles(tl.load(raster), tmp_path / "loaded", **options)
    tl.write_tiles(raster, tmp_path / "mapped", **options)
    assert contents(tmp_path / "loaded") == contents(tmp_path / "mapped")
    # what was mapped is gone
    assert set(os.listdir(tmp_path)) == {"ground.tif", "loaded", "mapped"}


def test_processes_map_the_same_file_and_work_goes_on(raster, tmp_path):
    tl.write_tiles(raster, tmp_path / "here", **BOXES)
    tl.write_tiles(raster, tmp_path / "there", workers=2, **BOXES)
    assert contents(tmp_path / "here") == contents(tmp_path / "there")
    assert tl.write_tiles(raster, tmp_path / "here", **BOXES).made == 0


def test_holes_in_what_is_mapped_are_refused(tmp_path):
    heights = np.ones((50, 60), np.float32)
    heights[7, 9] = np.nan
    with pytest.raises(tl.InputError, match=r"without holes.*no data at \[7, 9\]"):
        tl.write_tiles(heights, tmp_path / "tiles", crs="EPSG:4326")
    assert os.listdir(tmp_path) == []


def grid_file(path, west, south, step, heights):
    """Write a geoid's grid in the format GTX: big-endian, rows from the south."""
    header = struct.pack(">4d2i", south, west, step, step, *heights.shape)
    path.write_bytes(header + heights[::-1].astype(">f4").tobytes())
    return path


@pytest.mark.parametrize("mapped", [False, True])
def test_heights_above_a_geoid_become_those_above_the_ellipsoid(tmp_path, mapped, raster):
    # a geoid that rises evenly eastwards: bilinear grids have it as it is
    west, south, step = -86.0, 35.0, 0.5
    rise = np.broadcast_to(-30.0 + 2.0 * np.arange(9) * step, (7, 9))
    grid = grid_file(tmp_path / "drawn.gtx", west, south, step, rise)
    folder = tmp_path / "tiles"
    ground = raster if mapped else tl.load(raster)
    report = tl.write_tiles(ground, folder, geoid=str(grid), format="3dtiles", error=8.0, zoom=0,
                            borders="none")  # fmt: skip
    (record,) = report.records
    loaded = tl.load(raster)
    samples = on_map(loaded)
    samples[:, 2] += -30.0 + 2.0 * (samples[:, 0] - west)
    low, high = samples[:, :2].min(axis=0), samples[:, :2].max(axis=0)
    tile = read_glb(folder / record.path, (*low, *high))
    error, count = measured(tile, samples)
    assert count > 9000
    assert error <= record.error <= 8.0
    samples[:, 2] += 20.0
    assert measured(tile, samples)[0] > record.error


def on_map(ground):
    """Return longitude, latitude and height of the raster's samples; (S, 3)."""
    row, column = np.indices(ground.shape)
    lon, lat = -84.3 + (column + 0.5) / 1200, 36.65 - (row + 0.5) / 1200
    return np.stack([lon, lat, ground.elevation], axis=-1).reshape(-1, 3)


def test_a_grid_that_ends_before_the_ground_is_refused(tmp_path, raster):
    grid = grid_file(tmp_path / "drawn.gtx", 10.0, 40.0, 0.5, np.ones((3, 3)))
    with pytest.raises(tl.InputError, match=r"covers all of the ground, got .*drawn"):
        tl.write_tiles(raster, tmp_path / "tiles", geoid=str(grid))


def test_a_grid_that_proj_has_not_is_said(tmp_path):
    pyproj = pytest.importorskip("pyproj")
    folders = pyproj.datadir.get_data_dir(), pyproj.datadir.get_user_data_dir()
    if any(Path(folder, "us_nga_egm96_15.tif").exists() for folder in folders):
        pytest.skip("PROJ has the grid")
    with pytest.raises(tl.InputError, match=r"pyproj sync --file us_nga_egm96_15\.tif"):
        tl.write_tiles(jacksboro(), tmp_path / "tiles", geoid="egm96")
