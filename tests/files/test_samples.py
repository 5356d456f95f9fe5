"""The grounds that are always there: what they promise, and that their scripts make them."""

from __future__ import annotations

from importlib.resources import files

import numpy as np
import pytest
from PIL import Image
from terrain_lod.heightmaps import erosion, make, noise
from terrain_lod.heightmaps.volcano import SUMMIT

from terrain_lod.errors import InputError
from terrain_lod.files.rasters.samples import sample, sample_names
from terrain_lod.ground.heightmap import Heightmap

BUNDLED = ("ridge", "canyon", "dunes", "volcano", "islands", "city")
FOLDER = files("terrain_lod.heightmaps")


def units(name: str) -> np.ndarray:
    with (FOLDER / f"{name}.png").open("rb") as file:
        return np.asarray(Image.open(file))


def slope(ground: Heightmap) -> tuple[np.ndarray, np.ndarray]:
    """Return the slope to the south and to the east."""
    down, along = np.gradient(ground.elevation, *ground.spacing[::-1])
    return down, along


def test_names() -> None:
    assert sample_names() == (*BUNDLED, "jacksboro", "topobathy")
    assert tuple(make.GROUNDS) == BUNDLED


def test_unknown_name_lists_them() -> None:
    with pytest.raises(InputError, match="unknown sample 'moon': expected one of ridge, canyon"):
        sample("moon")


class TestBundled:
    @pytest.mark.parametrize("name", BUNDLED)
    def test_is_as_the_catalogue_says(self, name: str) -> None:
        ground = sample(name)
        recipe, entry = make.GROUNDS[name], make.catalogue()[name]
        assert ground.name == name
        assert ground.shape == tuple(entry["shape"])
        assert ground.spacing == (recipe.spacing, recipe.spacing)
        assert ground.origin == make.ORIGIN
        np.testing.assert_allclose(ground.height_range, entry["heights"], atol=1e-3)
        low, _ = entry["height_range"]
        expected = low + recipe.step * units(name).astype(np.float64)
        np.testing.assert_allclose(ground.elevation, expected, rtol=0, atol=1e-3)

    @pytest.mark.parametrize("name", BUNDLED)
    def test_has_the_samples_that_were_made(self, name: str) -> None:
        assert units(name).dtype == np.uint16
        assert make.digest(units(name)) == make.catalogue()[name]["sha256"]

    # the others take up to a minute each; these run the same code
    @pytest.mark.parametrize("name", ["city", "islands"])
    @pytest.mark.slow
    def test_is_made_again_bit_for_bit(self, name: str) -> None:
        again, height_range = make.samples(make.GROUNDS[name])
        np.testing.assert_array_equal(again, units(name))
        assert list(height_range) == make.catalogue()[name]["height_range"]

    def test_the_readme_has_the_table(self) -> None:
        assert make.table(make.catalogue()) in (FOLDER / "README.md").read_text(encoding="utf-8")

    def test_two_are_large_and_all_are_small_in_git(self) -> None:
        shapes = [sample(name).shape for name in BUNDLED]
        assert sum(min(shape) >= 1025 for shape in shapes) >= 2
        assert sum(len((FOLDER / f"{name}.png").read_bytes()) for name in BUNDLED) < 8e6

    def test_ridge_drains(self) -> None:
        # rivers reach the border: a drop of water on the ground meets few hollows
        height = sample("ridge").elevation
        receiver = erosion._steepest(height, np.full(height.shape, 0.41))
        inner = np.zeros(height.shape, bool)
        inner[1:-1, 1:-1] = True
        pits = (receiver == np.arange(height.size)) & inner.ravel()
        assert np.count_nonzero(pits) < 0.002 * height.size

    def test_canyon_has_cliffs_benches_and_a_rim(self) -> None:
        ground = sample("canyon")
        steep = np.hypot(*slope(ground))
        assert np.percentile(steep, 98) > 1.2
        assert np.mean(ground.elevation > 2050) > 0.25
        # over the heights of the walls, slope comes in bands: hard layers twice the soft ones
        bands = [
            np.median(steep[(ground.elevation > level - 10) & (ground.elevation < level + 10)])
            for level in (1230, 1375, 1850)
        ]
        bench, red_wall, cliff = bands
        assert min(red_wall, cliff) > 2 * bench

    def test_dunes_lean_with_the_wind(self) -> None:
        _, east = slope(sample("dunes"))
        windward, lee = east[east > 0.05], -east[east < -0.05]
        # slip faces stand at the angle of repose, windward slopes are gentle and longer
        assert 0.5 < np.percentile(lee, 90) < 0.7
        assert np.median(windward) < 0.25
        assert windward.size > 1.2 * lee.size

    def test_volcano_has_a_crater(self) -> None:
        height = sample("volcano").elevation
        row, column = np.array(SUMMIT) - 64
        floor = height[row - 5 : row + 6, column - 5 : column + 6]
        away = np.hypot(*(np.indices(height.shape) - [[[row]], [[column]]]))
        assert np.ptp(floor) < 5
        # a ring of rim all around it
        ring = height[(away > 20) & (away < 30)]
        assert ring.max() == height.max()
        assert np.percentile(ring, 10) > floor.max() + 50

    def test_islands_stand_in_a_flat_sea(self) -> None:
        height = sample("islands").elevation
        assert np.mean(height == 0) > 0.5
        assert height.min() == 0
        assert height.max() > 500

    def test_city_is_made_of_steps(self) -> None:
        height = sample("city").elevation
        east = np.abs(np.diff(height, axis=1))
        assert np.mean(east == 0) > 0.4
        assert np.mean(east > 3) > 0.05


class TestReal:
    def test_jacksboro(self) -> None:
        ground = sample("jacksboro")
        assert ground.shape == (344, 403)
        assert ground.height_range == (236, 1076)
        # 3 arc-seconds at 36.59 degrees north
        np.testing.assert_allclose(ground.spacing, (74.573, 92.475), atol=1e-3)
        per_degree = 1200 * np.array(ground.spacing)
        north_west = np.array(ground.origin) / per_degree
        np.testing.assert_allclose(north_west, (-84.413333, 36.7325), atol=1e-6)

    def test_topobathy_is_turned_north_up(self) -> None:
        ground = sample("topobathy")
        assert ground.shape == (91, 120)
        # the first row of the file, deep sea, is the southernmost
        assert ground.elevation[-1, 0] == -1405
        assert ground.elevation[0, -1] == 1015
        np.testing.assert_allclose(ground.spacing, (2439.07, 2431.55), atol=0.01)


class TestNoise:
    def test_random_numbers_never_change(self) -> None:
        expected = [0.5118216247002567, 0.9504636963259353, 0.14415961271963373]
        assert noise.Random(1).uniform(3).tolist() == expected

    def test_doubling_keeps_the_samples_and_every_cubic_between_them(self) -> None:
        x = np.arange(8.0)
        field = np.add.outer(x**3, x**2)
        finer = noise.doubled(field)
        np.testing.assert_array_equal(finer[::2, ::2], field)
        x = np.arange(15) / 2
        exact = np.add.outer(x**3, x**2)
        np.testing.assert_allclose(finer[2:-2, 2:-2], exact[2:-2, 2:-2])

    def test_lookup_is_bilinear_and_clamped(self) -> None:
        field = np.array([[0.0, 2], [4, 6]])
        rows, columns = np.array([[0.5, -3, 9]]), np.array([[0.5, 0, 9]])
        assert noise.looked_up(field, rows, columns).tolist() == [[3, 0, 6]]


class TestErosion:
    JITTER = 0.41

    def flow(self, height: np.ndarray, outlets: list[tuple[int, int]]) -> erosion.Flow:
        outlet = np.zeros(height.shape, bool)
        outlet[tuple(zip(*outlets, strict=True))] = True
        return erosion.route(height, outlet, np.full(height.shape, self.JITTER))

    def test_a_valley_gathers_its_sides(self) -> None:
        #  9 5 9      both sides drain to the middle column,
        #  8 4 8      and that runs down to the outlet
        #  7 3 7
        height = np.array([[9.0, 5, 9], [8, 4, 8], [7, 3, 7]])
        flow = self.flow(height, [(2, 1)])
        area = erosion.drainage(flow, np.ones(height.shape))
        assert area.tolist() == [[1, 3, 1], [1, 6, 1], [1, 9, 1]]
        assert [level.size for level in flow.levels] == [1, 3, 3, 2]

    def test_a_hollow_spills_over_its_lowest_pass(self) -> None:
        #  0 6 1 5 2 9      outlet at the left; the pits 1 and 2 spill over 6 and 5
        height = np.array([[0.0, 6, 1, 5, 2, 9]] * 2)
        flow = self.flow(height, [(0, 0), (1, 0)])
        area = erosion.drainage(flow, np.ones(height.shape))
        assert area[:, 0].sum() == height.size

    def test_every_drop_reaches_an_outlet(self) -> None:
        height = noise.Random(5).uniform(40, 50)
        outlets = [(0, 0), (39, 20)]
        area = erosion.drainage(self.flow(height, outlets), np.ones(height.shape))
        assert sum(area[place] for place in outlets) == height.size

    def test_the_implicit_step_solves_its_equation(self) -> None:
        height = np.array([[0.0, 10, 20]] * 2)
        flow = self.flow(height, [(0, 0), (1, 0)])
        cut = erosion.incised(height, flow, np.full(height.shape, 1.0))
        # h1 = (10 + 0) / 2, h2 = (20 + h1) / 2
        assert cut[0].tolist() == [0, 5, 12.5]

    def test_a_cliff_falls_to_its_slope(self) -> None:
        height = np.zeros((9, 9))
        height[:, 5:] = 100
        fallen = erosion.fallen(height, 10.0, 20)
        assert fallen[4].tolist() == [0, 0, 0, 0, 0, 10, 20, 30, 40]

    def test_creep_moves_earth_and_loses_none(self) -> None:
        height = np.pad([[8.0]], 4)
        crept = erosion.crept(height, 0.25, 2)
        assert crept.sum() == 8
        assert crept[4, 4] == 2
