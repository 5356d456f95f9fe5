"""The analysis kernel against its float64 reference, on ordinary ground and on hard cases."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import holed, plane, rough
from terrain_lod.reference.terrain import analysis as reference


def compare(ground: tl.Heightmap, tile: int = 15, fit: str = "least_squares") -> None:
    """Assert that kernel and reference agree to 1e-5, or to 4 ulp of the tile's height range."""
    found = tl.analyse(ground, tile=tile, plane=fit)
    tiles = reference.analyse(ground, tile=tile, plane=fit)
    expected = {
        name: np.array([getattr(one, name) for one in tiles]).reshape(found.deviation.shape)
        for name in ("height", "deviation", "minimum", "maximum", "nodata")
    }
    # heights are stored exactly, so their extremes are exact
    for name in ("minimum", "maximum", "nodata"):
        np.testing.assert_array_equal(getattr(found, name), expected[name], name)
    height_range = expected["maximum"] - expected["minimum"]
    four_ulp = 4 * np.spacing(np.minimum(height_range, 3.4e38).astype(np.float32)).astype(float)
    for name in ("deviation", "height"):
        # a plane's height carries the rounding of the heights themselves as well
        largest = np.abs(expected[name]) if name == "deviation" else np.abs(expected["maximum"])
        error = np.abs(getattr(found, name) - expected[name])
        ok = np.isnan(expected[name]) | (error <= np.maximum(four_ulp, 1e-5 * largest))
        assert ok.all(), f"{name}: {error[~ok].max()}"
    normals = np.array([one.normal for one in tiles]).reshape(found.normal.shape)
    assert np.abs(found.normal - normals).max() < 1e-5


@pytest.mark.parametrize("tile", [1, 2, 6, 7, 10, 15, 16, 31, 63])
@pytest.mark.parametrize("fit", ["least_squares", "corners"])
def test_agrees_with_the_reference_for_every_kind_of_tile(tile: int, fit: str) -> None:
    compare(rough(spacing=(30, 10)), tile, fit)


@pytest.mark.parametrize("tile", [3, 15])
@pytest.mark.parametrize("fit", ["least_squares", "corners"])
def test_holes_do_not_count(tile: int, fit: str) -> None:
    compare(holed(), tile, fit)


row, column = np.mgrid[:46, :46].astype(float)
noise = np.random.default_rng(3).normal(size=row.shape)
HARD = {
    "constant": np.full((46, 46), 8848.0),
    "slope 0.001": 0.001 * column + 0.0003 * row,
    "slope 1000": 1000 * column + 300 * row,
    "millimetres on a slope at 8,848 m": 8848 + 0.5 * column + 1e-3 * noise,
    "millimetres on a slope at 1,000 km": 1e6 + 0.5 * column + 1e-3 * noise,
    "one spike": np.where((row == 20) & (column == 21), 1e4, 0.0),
    "a cliff of one cell": np.where(column > 22, 500.0, 0.0),
    "checkerboard": np.where((row + column) % 2, 1.0, -1.0),
    "denormals": (1e-42 * row * column).astype(np.float32),
    "int16": np.where(noise > 0, 32767, -32768).astype(np.int16),
    "all but one sample missing": np.where((row == 7) & (column == 8), 5.0, np.nan),
    "samples on one line": np.where(row == column, column, np.nan),
}


@pytest.mark.parametrize("name", HARD)
@pytest.mark.parametrize("spacing", [1.0, (1.0, 1000.0)])
def test_hard_case(name: str, spacing: float | tuple[float, float]) -> None:
    compare(tl.Heightmap(HARD[name], spacing=spacing))


def test_heights_near_the_end_of_float32_give_finite_results() -> None:
    ends = np.where(noise > 0, 3e38, -3e38).astype(np.float32)
    found = tl.analyse(tl.Heightmap(ends))
    assert np.isfinite(found.deviation).all()
    np.testing.assert_allclose(np.linalg.norm(found.normal, axis=-1), 1, rtol=1e-6)


def test_an_exact_plane_has_no_deviation_however_the_spacing_differs() -> None:
    # listings 9.12 and 9.15 scale corners and samples differently and report 0.57 for this
    for fit in ("least_squares", "corners"):
        found = tl.analyse(plane(0.5, 0.25, spacing=(30, 10)), plane=fit)
        assert found.deviation.max() == 0
        expected = np.array([-0.5 / 30, 0.25 / 10, 1]) / np.hypot(np.hypot(0.5 / 30, 0.25 / 10), 1)
        np.testing.assert_allclose(found.normal[1, 1], expected, rtol=1e-6)


def test_a_flat_tile_has_no_deviation_at_any_height() -> None:
    # listing 9.15 subtracts the plane's constant where it must add it, and reports 2 x the height
    assert tl.analyse(tl.Heightmap(np.full((16, 16), 0.5))).deviation.max() == 0


def test_the_border_between_tiles_belongs_to_both() -> None:
    heights = np.zeros((31, 31))
    heights[:, 15] = 1
    assert (tl.analyse(tl.Heightmap(heights)).maximum == 1).all()


def test_a_tile_without_data_says_so() -> None:
    heights = np.zeros((31, 31))
    heights[:16, :16] = np.nan
    found = tl.analyse(tl.Heightmap(heights))
    assert np.isnan(found.deviation[0, 0])
    assert found.nodata[0, 0] == 256
    assert np.isfinite(found.deviation[1, 1])


def test_any_raster_is_covered_by_tiles_of_odd_cells() -> None:
    from terrain_lod.ground.grid import TileGrid

    for samples in range(2, 80):
        grid = TileGrid(samples, samples, 15, (1.0, 1.0))
        cells = np.diff(grid.corner_rows)
        assert cells.sum() == samples - 1
        assert (cells % 2 == 1).all()
        assert cells.max() <= 15
        assert len(cells) == grid.shape[0]


@pytest.mark.parametrize("tile", [0, 64, -1, 1.5, float("nan")])
def test_wrong_tile(tile: float) -> None:
    with pytest.raises(tl.InputError, match="tile"):
        tl.analyse(rough(), tile=tile)


def test_wrong_plane() -> None:
    with pytest.raises(tl.InputError, match="least_squares, corners"):
        tl.analyse(rough(), plane="best")
