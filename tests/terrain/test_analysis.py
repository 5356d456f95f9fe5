"""The analysis: exact on planes, finite at the ends of float32; what tiles cover."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import plane, rough


def test_heights_near_the_end_of_float32_give_finite_results() -> None:
    noise = np.random.default_rng(3).normal(size=(46, 46))
    ends = np.where(noise > 0, 1.6e38, -1.6e38).astype(np.float32)
    found = tl.analyse(tl.Heightmap(ends))
    assert np.isfinite(found.deviation).all()
    np.testing.assert_allclose(np.linalg.norm(found.normal, axis=-1), 1, rtol=1e-6)


@pytest.mark.parametrize("fit", ["least_squares", "corners"])
@pytest.mark.parametrize("height", [1e-44, 1e-40, 1e24, 1e37])
@pytest.mark.parametrize("spacing", [1e-18, 1.0, 1e18, (1e-3, 1e6)])
def test_no_height_and_no_spacing_leaves_a_tile_without_a_plane(
    fit: str, height: float, spacing: float | tuple[float, float]
) -> None:
    noise = np.random.default_rng(3).normal(size=(46, 46))
    terrain = tl.Terrain(tl.Heightmap(height * noise, spacing=spacing), plane=fit)
    assert np.isfinite(terrain.analysis.deviation).all()
    np.testing.assert_allclose(np.linalg.norm(terrain.analysis.normal, axis=-1), 1, rtol=1e-6)
    assert np.isfinite(terrain.scene.rough_deviation)


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
