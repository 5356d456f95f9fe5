"""What a viewer can be set to: tables, sliders, and the levels of detail that come of them."""

from __future__ import annotations

import math
from dataclasses import fields, replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from terrain_lod import BudgetLod, ScreenErrorLod, UniformLod, Weighted
from terrain_lod.errors import InputError
from terrain_lod.viewer.mesh_settings import BezierSettings, CurvedSettings
from terrain_lod.viewer.terrain_settings import MODES, TILES, TerrainSettings

SETTINGS = TerrainSettings(diagonal=1000.0)
EVERY = [kind(diagonal=1000.0) for kind in (TerrainSettings, CurvedSettings, BezierSettings)]


def values(settings, *names):
    return [settings.value(name) for name in names]


@pytest.mark.parametrize("settings", EVERY)
def test_every_control_is_a_setting(settings):
    names = {field.name for field in fields(settings)}
    assert {choice.name for choice in settings.choices} <= names
    sliders = [slider.name for slider in settings.numbers]
    assert len(set(sliders)) == len(sliders)
    keys = [choice.key for choice in settings.choices]
    assert len(set(keys)) == len(keys)
    assert not set(keys) & set("wasdgrucvhq")
    for choice in settings.choices:
        assert getattr(settings, choice.name) in choice.values
    for slider in settings.numbers:
        assert slider.nearest(settings.value(slider.name)) == settings.value(slider.name)


@given(st.sampled_from(EVERY), st.floats(allow_nan=False), st.data())
def test_any_slider_anywhere_gives_a_level_of_detail(settings, value, data):
    for choice in settings.choices:
        settings = settings.changed(choice.name, data.draw(st.sampled_from(choice.values)))
    slider = data.draw(st.sampled_from(settings.sliders))
    if math.isinf(value):
        with pytest.raises(InputError, match="finite"):
            settings.changed(slider.name, value)
        return
    settings = settings.changed(slider.name, value)
    assert slider.low <= settings.value(slider.name) <= slider.high
    # raises where near and far, or minimum and maximum, cross
    if isinstance(settings, TerrainSettings):
        settings.detail()
    if isinstance(settings, CurvedSettings):
        settings.formula()


def test_sliders_that_matter_and_their_scale():
    names = [slider.name for slider in SETTINGS.changed("lod", "book-coplanarity").sliders]
    formula = ["minimum", "maximum", "near", "far", "flat_weight"]
    always = ["horizon", "silhouette", "tile", "azimuth", "elevation"]
    assert names == formula + always
    for slider in SETTINGS.numbers:
        assert slider.of_scale(slider.on_scale(slider.high)) == pytest.approx(slider.high)
    assert [slider.name for slider in EVERY[2].sliders] == ["factor", "azimuth", "elevation"]
    assert "crease" in {slider.name for slider in EVERY[1].changed("sharp", "angle").sliders}
    assert "crease" not in {slider.name for slider in EVERY[1].sliders}


def test_the_tile_slider_has_stops():
    for value, stop in ((1, 3), (13, 15), (12, 11), (64, 63), (40, 45)):
        assert SETTINGS.changed("tile", value).tile == stop
    assert all(isinstance(SETTINGS.changed("tile", tile).tile, int) for tile in TILES)
    assert replace(SETTINGS, tile=12).tile == 12  # as the command line may ask
    with pytest.raises(InputError, match="from 1 to 63 for tile"):
        replace(SETTINGS, tile=64)


def test_factors_that_were_all_of_a_tile_stay_so():
    larger = SETTINGS.changed("tile", 31)
    assert values(SETTINGS, "tile", "factor", "maximum") == [4, 4, 4]
    assert values(larger, "tile", "factor", "maximum") == [31, 31, 31]
    chosen = larger.changed("factor", 5.0).changed("minimum", 20.0).changed("tile", 15)
    assert values(chosen, "factor", "minimum", "maximum") == [5, 15, 15]


def test_choices_go_round_and_refuse_what_they_do_not_know():
    settings = SETTINGS
    for _ in MODES:
        settings = settings.next("mode")
    assert settings == SETTINGS
    with pytest.raises(InputError, match="expected one of shaded"):
        SETTINGS.changed("mode", "cubist")
    with pytest.raises(InputError, match="expected one of shaded, wireframe, lod, normals"):
        EVERY[1].changed("mode", "deviation")
    with pytest.raises(InputError, match="unknown setting 'colour': expected one of mode, lod"):
        SETTINGS.changed("colour", "red")


def test_numbers_without_a_slider_beside_others_of_their_name():
    budget = SETTINGS.changed("lod", "budget")
    assert budget.value("pixels") == 0
    assert "pixels" not in [slider.name for slider in budget.sliders]
    for slider in budget.numbers:  # windows have them all, hidden
        slider.on_scale(budget.value(slider.name))
    assert budget.changed("pixels", 3).detail() == BudgetLod(100_000, pixels=3)
    # each level of detail keeps its own
    assert budget.changed("pixels", 3).changed("lod", "screen-error").detail() == ScreenErrorLod(1)
    rough = SETTINGS.changed("lod", "book-coplanarity").changed("full_deviation", 5)
    assert rough.detail().full_deviation == 5
    near = SETTINGS.changed("lod", "distance").changed("near", 10)
    assert near.changed("lod", "book-coplanarity").detail().near == 10


def test_weights_weigh_and_none_do_not():
    assert SETTINGS.detail() == ScreenErrorLod(1.0)
    weighted = SETTINGS.changed("horizon", 3.0).changed("silhouette", 2.0)
    assert weighted.detail() == Weighted(ScreenErrorLod(1.0), horizon=3.0, silhouette=2.0)


def test_edge_rule_and_tessellation_follow_the_level_of_detail():
    assert SETTINGS.usable_edge_rule is None
    assert SETTINGS.changed("lod", "distance").usable_edge_rule == "min"
    assert SETTINGS.changed("lod", "distance").changed("edge_rule", "max").usable_edge_rule == "max"
    flat = SETTINGS.changed("tessellated", False)
    assert flat.detail() == UniformLod(1.0)
    assert flat.usable_edge_rule == "min"
