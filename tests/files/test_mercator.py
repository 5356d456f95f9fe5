"""Tiles of the web's map in their place."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio.warp

from support.rasters import GRID, refusal, write_image, write_tiff
from terrain_lod.errors import InputError
from terrain_lod.files.rasters import mercator
from terrain_lod.files.rasters.loading import load

HEIGHTS = 1200 + 9 * np.sin(np.arange(64) / 9)[:, None] + 2.5 * np.arange(64.0)
AROUND = 2 * np.pi * 6_378_137


def terrarium(path: Path) -> Path:
    code = np.round((HEIGHTS + 32768) * 256).astype(int)
    path.parent.mkdir(parents=True, exist_ok=True)
    return write_image(
        path, np.stack([code >> 16, code >> 8 & 255, code & 255], -1).astype(np.uint8)
    )


@pytest.mark.parametrize("latitude", [0.0, 46.0, -60.0, 85.0])
def test_longitude_and_latitude_are_those_of_proj(latitude: float) -> None:
    (x,), (y,) = rasterio.warp.transform("EPSG:4326", "EPSG:3857", [11.0], [latitude])
    np.testing.assert_allclose(mercator.geographic(x, y), (11, latitude), atol=1e-9)


@pytest.mark.parametrize("told", ["argument", "path", "path of two pixels a point"])
def test_a_tile_in_its_place(tmp_path: Path, told: str) -> None:
    z, x, y = 12, 2138, 1450
    name = {"argument": "a.png", "path": f"{z}/{x}/{y}.png"}.get(told, f"{z}/{x}/{y}@2x.png")
    path = terrarium(tmp_path / name)
    ground = load(path, **({"tile": (z, x, y)} if told == "argument" else {}))
    north, south = (np.degrees(np.arctan(np.sinh(np.pi * (1 - 2 * row / 2**z))))
                    for row in (y, y + 1))  # fmt: skip
    middle = np.radians((north + south) / 2)
    true = AROUND / 2**z / 64 * np.cos(middle)
    # the figure of the earth is 0.3 % longer here than a sphere's
    np.testing.assert_allclose(ground.spacing, true, rtol=4e-3)
    on_map = load(path, tile=(z, x, y), spacing="map")
    assert on_map.crs == "EPSG:3857"
    side = AROUND / 2**z
    corner = x * side - AROUND / 2 + side / 128, AROUND / 2 - y * side - side / 128
    np.testing.assert_allclose(on_map.origin, corner)
    np.testing.assert_allclose(on_map.spacing, side / 64)
    assert ground.crs is not None
    assert "EPSG:3857" in ground.crs
    np.testing.assert_allclose(ground.elevation, HEIGHTS, atol=0.003)


def test_neighbours_meet(tmp_path: Path) -> None:
    west, east = (terrarium(tmp_path / f"9/{x}/181.png") for x in (267, 268))
    one, other = load(west), load(east)
    np.testing.assert_allclose(one.origin[0] + 64 * one.spacing[0], other.origin[0])


def test_a_path_of_something_else_has_no_tile(tmp_path: Path) -> None:
    for name in ("3/9/1.png", "31/1/1.png", "12/1450.png"):
        with pytest.warns(UserWarning, match="give spacing="):
            assert load(terrarium(tmp_path / "x" / name)).spacing == (1, 1)
    grey = tmp_path / "12/2138/1451.png"
    grey.parent.mkdir(parents=True)
    write_image(grey, GRID.astype(np.uint16))
    with pytest.warns(UserWarning, match="give spacing="):
        load(grey)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"tile": (2, 4, 0)}, "whole number from 0 to 3 for x of a tile at z = 2, got 4"),
        ({"tile": (2, 0, -1)}, "for y of a tile at z = 2"),
        ({"tile": (31, 0, 0)}, "for z of the tile"),
        ({"tile": (1, 2)}, "tile as (z, x, y), got (1, 2)"),
        ({"tile": 3}, "tile as (z, x, y), got 3"),
        ({"tile": (9, 1, 1), "window": (0, 0, 9, 9)}, "a whole tile"),
        # the whole world is no flat grid
        ({"tile": (0, 0, 0)}, 'spacing="map"'),
    ],
)
def test_refused(tmp_path: Path, options: dict[str, Any], words: str) -> None:
    assert words in refusal(InputError, terrarium(tmp_path / "a.png"), **options)


def test_a_raster_with_a_place_is_no_tile(tmp_path: Path) -> None:
    path = write_tiff(tmp_path / "a.tif", GRID.astype(np.uint16))
    assert "without a place of its own" in refusal(InputError, path, tile=(9, 1, 1))
