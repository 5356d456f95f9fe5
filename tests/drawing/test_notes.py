"""What pictures say of themselves: a wrong bar, a lost note or a missing shade is seen."""

from __future__ import annotations

import numpy as np
import pytest
from skimage.metrics import structural_similarity

import terrain_lod as tl
from support.grounds import rough
from terrain_lod.drawing.graphics import graphics_problem
from terrain_lod.drawing.notes import bar, compass, foot, said_of
from terrain_lod.drawing.scales import segments, tints

CAMERA = tl.Camera((0.0, -100.0, 50.0), (0.0, 0.0, 0.0), size=(960, 540))
INK = np.array([20, 26, 36])


def dark(strip):
    return (np.abs(strip[..., :3].astype(int) - INK).max(axis=-1) < 60).sum()


def test_what_the_camera_and_the_sun_are_is_said_in_words():
    assert said_of(CAMERA, (315.0, 40.0), 2.5) == (
        "looking north (0°), 27° down; field of view 45°; sun from 315°, 40° up; heights × 2.5"
    )
    east = tl.Camera((0, 0, 0), (5, 0, 0), height=9.0)
    assert said_of(east, None) == "looking east (90°), level; parallel"


def test_a_bar_shows_its_colours_in_order():
    scale = tints((0.0, 4000.0), "m", 1.0)
    strip = bar(scale, 12, 300)
    row = strip[strip.shape[0] // 2 - 4, 12:-12, :3].astype(float) / 255
    expected = scale.colours(np.linspace(0, 4000, len(row)))
    assert np.abs(row - expected)[8:-8].max() < 0.03


def test_the_arrow_points_north_and_the_bar_is_as_long_as_it_says():
    north = compass(CAMERA, "m", 12, 200)
    east = compass(tl.Camera((-100, 0, 50), (0, 0, 0), size=(960, 540)), "m", 12, 200)
    # the arrow's tip is the farthest of its ink from the middle
    for strip, across, up in ((north, 0, 1), (east, -1, 0)):
        ink = np.abs(strip[:22, 60:110, :3].astype(int) - INK).max(axis=-1) < 60
        y, x = np.nonzero(ink)
        spread = np.ptp(x), np.ptp(y)
        assert (spread[1] > spread[0]) == bool(up), (across, spread)
    pixels = CAMERA.focal / np.linalg.norm(np.subtract(CAMERA.eye, CAMERA.target))
    lengths = [np.flatnonzero(row) for row in np.abs(north[..., :3].astype(int) - INK).max(-1) < 60]
    longest = max(np.ptp(found) for found in lengths if len(found))
    assert longest / pixels == pytest.approx(20.0, rel=0.05)


def test_words_are_wrapped_and_a_strip_is_as_wide_as_the_picture():
    strip = foot(CAMERA, ["word " * 200], scale=tints((0, 1), "m", None), unit="m")
    assert strip.shape[1] == 960
    assert dark(strip) > 3 * dark(foot(CAMERA, ["word"]))
    assert foot(tl.Camera((0, -9, 9), (0, 0, 0), size=(9, 9)), ["a"], unit="m").shape[1] == 9


@pytest.mark.skipif(graphics_problem() is not None, reason=f"no pictures: {graphics_problem()}")
def test_a_wrong_bar_lost_notes_or_missing_light_are_less_like_the_picture_than_it_is():
    # valleys that see little of the sky
    row, column = np.mgrid[:61, :61]
    heights = 200 * np.cos(column / 4) + 150 * np.cos(row / 5)
    ground = tl.Heightmap(heights, spacing=30.0)
    camera = tl.default_camera(ground, size=(640, 360))

    def picture(**options):
        return tl.render(ground, camera=camera, lod=tl.UniformLod(2), **options)

    whole = picture()
    assert whole.shape == (360, 640, 3)
    assert (picture() == whole).all()
    for other in (
        picture(notes=False),
        picture(sky_light=False),
        picture(height_range=(-500.0, 500.0)),
        picture(exaggeration=1.3),
    ):
        alike = structural_similarity(whole, other, channel_axis=-1)
        assert alike < 0.997, alike


def test_small_pictures_have_no_room_for_notes():
    ground = rough(21, 21)
    camera = tl.default_camera(ground, size=(120, 60))
    if graphics_problem() is None:
        with_notes, without = (
            tl.render(ground, camera=camera, lod=tl.UniformLod(2), notes=notes)
            for notes in (True, False)
        )
        assert (with_notes == without).all()


def test_a_level_of_detail_has_a_bar_in_cells():
    mesh = tl.Terrain(rough(41, 41)).mesh(lod=tl.UniformLod(2))
    assert segments(mesh.patches).said() == "a triangle's side, 2 to 2 cells"
