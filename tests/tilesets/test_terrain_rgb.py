"""Terrain-RGB, read back by its published formulas."""

from __future__ import annotations

import json

import numpy as np
import pytest
from PIL import Image

import terrain_lod as tl
from support.tilesets import degrees, jacksboro

DECODE = {
    "terrarium": lambda red, green, blue: red * 256 + green + blue / 256 - 32768,
    "mapbox": lambda red, green, blue: -10000 + (red * 65536 + green * 256 + blue) * 0.1,
}


@pytest.fixture(scope="module")
def ground():
    return jacksboro()


@pytest.mark.slow
@pytest.mark.parametrize("encoding", DECODE)
def test_pictures_are_as_far_from_samples_as_they_say(encoding, ground, tmp_path):
    report = tl.write_tiles(ground, tmp_path, format=encoding)
    layer = json.loads((tmp_path / "tiles.json").read_text())
    low, high = ground.height_range
    assert (layer["lowest"], layer["highest"]) == pytest.approx((low, high), abs=1e-9)
    lon, lat, height = degrees(ground).T
    for z in range(layer["maxzoom"] + 1):
        records = [record for record in report.records if record.z == z]
        stated = max(record.error for record in records)
        assert min(record.low for record in records) == pytest.approx(low)
        assert max(record.high for record in records) == pytest.approx(high)
        shown = _shown(tmp_path, z, lon, lat, DECODE[encoding])
        known = np.isfinite(shown)
        error = abs(shown - height)[known].max()
        assert error <= stated + 1e-9
        if known.all():
            assert stated <= error * 1.0001


def _shown(folder, z, lon, lat, decode):
    """Return heights bilinear between the middles of pixels; NaN where tiles are missing."""
    x = (lon + 180) / 360 * 2**z * 256 - 0.5
    y = (1 - np.arcsinh(np.tan(np.radians(lat))) / np.pi) / 2 * 2**z * 256 - 0.5

    def pixel(column, row):
        heights = np.full(len(column), np.nan)
        tiles = {(a, b) for a, b in zip(column // 256, row // 256, strict=True)}
        for a, b in tiles:
            path = folder / f"{z}/{a}/{b}.png"
            if path.exists():
                colours = np.asarray(Image.open(path)).astype(float)
                here = (column // 256 == a) & (row // 256 == b)
                heights[here] = decode(*colours[row[here] % 256, column[here] % 256].T)
        return heights

    column, row = np.floor(x).astype(int), np.floor(y).astype(int)
    across, down = x - column, y - row
    north = pixel(column, row) * (1 - across) + pixel(column + 1, row) * across
    south = pixel(column, row + 1) * (1 - across) + pixel(column + 1, row + 1) * across
    return north * (1 - down) + south * down
