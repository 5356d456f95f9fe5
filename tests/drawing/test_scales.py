"""Colour bars: the colours of the picture, round numbers, and eyes that see few colours."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from terrain_lod.drawing import scales
from terrain_lod.drawing.colours import (
    ERROR_STOPS,
    HEAT_STOPS,
    LOD_STOPS,
    height_stops,
    hypsometric,
    ramp,
)

UP = np.array([[0.0, 0.0, 1.0]], np.float32)

# OKLab's lightness (Ottosson, 2020), and what deuteranopes see of linear light (Machado and
# others, 2009)
_TO_CONES = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
_TO_LIGHTNESS = np.array([0.2104542553, 0.7936177850, -0.0040720468])
_DEUTERANOPE = np.array(
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.01182, 0.04294, 0.968881]]
)


def lightness(stops, positions):
    linear = ramp(stops, np.float32(positions)).astype(float) ** 2.2
    return np.cbrt(linear @ _TO_CONES.T) @ _TO_LIGHTNESS


@pytest.mark.parametrize("stops", [LOD_STOPS, HEAT_STOPS])
def test_more_is_lighter_all_along(stops):
    steps = np.diff(lightness(stops, np.linspace(0, 1, 33)))
    assert (steps > 0).all()


def test_errors_are_lightest_at_none_and_told_apart_by_who_sees_no_green():
    light = lightness(ERROR_STOPS, np.linspace(0, 1, 33))
    assert (np.diff(light[:17]) > 0).all()
    assert (np.diff(light[16:]) < 0).all()
    np.testing.assert_allclose(light, light[::-1], atol=0.02)
    ends = ramp(ERROR_STOPS, np.float32([0.125, 0.875])) ** 2.2 @ _DEUTERANOPE.T
    below, above = np.clip(ends, 0, 1) ** (1 / 2.2)
    assert below[2] - below[0] > 0.3  # blue
    assert above[0] - above[2] > 0.2  # not


def test_a_thousand_metres_are_not_snow_and_five_thousand_are():
    low, high, top = (
        hypsometric(np.float32([h]), UP, (0.0, 5000.0), 1.0)[0] for h in (200.0, 1000.0, 5000.0)
    )
    assert top.min() > 0.9
    assert high.min() < 0.7
    assert low[1] > low[0]  # green
    # in feet as in metres
    feet = hypsometric(np.float32([1000 / 0.3048]), UP, (0.0, 5000 / 0.3048), 0.3048)[0]
    np.testing.assert_allclose(feet, high, atol=1e-3)


@pytest.mark.parametrize("metres", [None, 1.0])
@pytest.mark.parametrize("ends", [(100.0, 900.0), (-60.0, 640.0), (-500.0, -20.0), (0.0, 40.0)])
def test_the_bar_has_the_colours_of_level_ground(ends, metres):
    heights = np.linspace(*ends, 41, dtype=np.float32)[1:-1]
    heights = heights[np.abs(heights) > 8]  # beside the shore
    seen = hypsometric(heights, np.repeat(UP, len(heights), axis=0), ends, metres)
    shown = scales.tints(ends, "m", metres).colours(heights)
    np.testing.assert_allclose(shown, seen, atol=0.02)
    positions = [stop[0] for stop in height_stops(ends, metres)]
    assert positions == sorted(positions)


def test_low_relief_is_told_apart():
    stops = np.array(height_stops((100.0, 110.0), 1.0))
    assert np.abs(stops[0, 1:] - stops[-1, 1:]).max() > 0.15


def test_the_sea_is_known_where_there_is_a_map():
    flat = np.zeros((2, 2))
    feet = ("US survey foot", "US survey foot")
    assert scales.metres_above_sea(tl.Heightmap(flat)) is None
    assert scales.metres_above_sea(tl.Heightmap(flat, crs="EPSG:2231", units=feet)) == (
        pytest.approx(1200 / 3937)
    )


def test_levels_of_detail_spread_over_those_that_are_there():
    mesh = tl.Terrain(tl.sample("volcano")).mesh(lod=tl.MaxErrorLod(5.0))
    scale = scales.segments(mesh.patches)
    lengths = mesh.patches.segment_cells[mesh.patches.drawn]
    assert (scale.low, scale.high) == (lengths.min(), lengths.max())
    first, last = scale.colours([scale.low, scale.high])
    np.testing.assert_allclose(first, LOD_STOPS[-1][1:], atol=1e-6)  # fine is bright
    np.testing.assert_allclose(last, LOD_STOPS[0][1:], atol=1e-6)
    assert scales.sizes(mesh.patches).high == 2.0 ** round(np.log2(scales.sizes(mesh.patches).high))


def test_marks_are_round_and_the_ends_are_said():
    marks = scales.tints((440.4, 2530.6), "m", 1.0).marks()
    assert [text for _, text in marks] == ["440", "1,000", "1,500", "2,000", "2,531"]
    assert scales.factors(np.array([3.0, 3.0])).marks() == ((0.5, "3"),)
    assert scales.nice(3.2) == 5
    assert scales.nice(0.011) == pytest.approx(0.02)
