"""The viewer without a window: settings, the driven camera, what is shown, and the thread."""

from __future__ import annotations

import math
import os
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from threading import Event

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from support.grounds import holed, plane, rough
from terrain_lod import Camera, Heightmap, default_camera
from terrain_lod.cli.app import REFUSED
from terrain_lod.errors import FileError, GraphicsError
from terrain_lod.terrain.lods import LODS
from terrain_lod.viewer.engine import Engine
from terrain_lod.viewer.model import Model
from terrain_lod.viewer.rig import Rig, ground_seen, height_at
from terrain_lod.viewer.scene import Request
from terrain_lod.viewer.stage import frustum
from terrain_lod.viewer.terrain_scene import TerrainScene
from terrain_lod.viewer.terrain_settings import MODES
from terrain_lod.viewer.view import require_display

# the arrays here do not say their spacing, which is then 1
pytestmark = pytest.mark.filterwarnings("ignore:.*how far apart its samples are")

ORIGIN = (500_000.0, 4_000_000.0)


def a_camera(ground, size=(320, 200)):
    return default_camera(ground, size=size)


# the driven camera


def test_rig_stands_where_its_camera_does():
    camera = Camera((10.0, -50.0, 30.0), (0.0, 0.0, 5.0), fov=40.0, size=(64, 48))
    again = Rig.of(camera).camera((64, 48))
    assert again.eye == pytest.approx(camera.eye)
    assert again.target == pytest.approx(camera.target)
    assert again.fov == 40.0


def test_rig_moves_as_its_names_say():
    rig = Rig((0.0, 0.0, 0.0), 10.0, heading=0.0, pitch=-45.0, fov=60.0)  # south, looks north
    x, y, z = rig.eye
    assert (x, y, z) == pytest.approx((0, -(50**0.5), 50**0.5))
    assert rig.orbit(90.0, 0.0).eye == pytest.approx((50**0.5, 0, 50**0.5), abs=1e-9)  # east
    assert rig.orbit(0.0, 44.0).eye[2] > z
    assert rig.orbit(30.0, 10.0).target == rig.target
    assert rig.look(90.0, 0.0).eye == pytest.approx(rig.eye)
    assert rig.look(90.0, 0.0).forward == pytest.approx((0.5**0.5, 0, -(0.5**0.5)), abs=1e-9)
    assert math.dist(rig.zoom(2.0).eye, rig.target) == pytest.approx(5.0)
    assert rig.fly(0.0, 3.0).eye == pytest.approx((3.0, y, z))
    assert rig.pan(0.1, 0.0).target == pytest.approx((1.0, 0.0, 0.0))


numbers = st.floats(allow_nan=True, allow_infinity=True)


@given(st.tuples(numbers, numbers, numbers), numbers, numbers, numbers)
def test_camera_driven_anywhere_stays_above_the_ground_and_near_it(
    target, distance, heading, pitch
):
    ground = SCENE.ground
    rig = Rig(target, distance, heading, pitch, fov=60.0).within(SCENE)
    x, y, z = rig.eye
    assert z > height_at(ground, x, y)
    diagonal = float(np.hypot(*ground.extent))
    assert math.dist(rig.eye, ground.centre) < 4.1 * diagonal + 2000
    rig.camera((0, 0)).axes  # noqa: B018  a camera that is none would raise


GROUND = rough(60, 80, spacing=(30.0, 20.0), origin=ORIGIN, base=2000.0)
SCENE = TerrainScene(GROUND)


def test_height_is_bilinear_clamped_and_lowest_in_holes():
    ground = plane(2.0, -3.0, spacing=(10.0, 5.0), origin=ORIGIN, base=100.0)
    assert height_at(ground, ORIGIN[0] + 25.0, ORIGIN[1] - 7.5) == pytest.approx(100 + 5 - 4.5)
    assert height_at(ground, ORIGIN[0] - 1e9, ORIGIN[1] + 1e9) == pytest.approx(100.0)
    hole = Heightmap([[9.0, np.nan], [9.0, 7.0]])
    assert height_at(hole, 1.0, 0.0) == 7.0


@pytest.mark.parametrize("x", range(5, 320, 45))
@pytest.mark.parametrize("y", range(5, 200, 30))
def test_what_a_pixel_shows_projects_to_it_and_nothing_is_before_it(x, y):
    camera = a_camera(GROUND)
    place = ground_seen(GROUND, camera, x, y)
    if place is None:  # the sky: no sample of the ground is there
        points = samples(GROUND)
        pixels, depth = camera.project(points)
        assert not ((depth > 0) & (np.abs(pixels - [x + 0.5, 199.5 - y]).max(axis=1) < 0.5)).any()
        return
    (pixel,), (depth,) = camera.project([place])
    assert pixel == pytest.approx([x + 0.5, 199.5 - y], abs=1e-3)
    assert place[2] == pytest.approx(height_at(GROUND, place[0], place[1]), abs=3.0)
    for share in np.linspace(0.0, 0.99, 50):
        before = np.add(camera.eye, share * np.subtract(place, camera.eye))
        if abs(before - GROUND.centre)[0] < 0.5 * GROUND.extent[0]:
            assert before[2] > height_at(GROUND, before[0], before[1]) - 3.0 or share > 0.98
    assert depth > 0


def samples(ground):
    row, column = np.mgrid[: ground.shape[0], : ground.shape[1]]
    x = ground.origin[0] + ground.spacing[0] * column
    y = ground.origin[1] - ground.spacing[1] * row
    return np.stack([x, y, ground.elevation], axis=-1).reshape(-1, 3)


# what is shown


@pytest.fixture(scope="module")
def scene():
    return TerrainScene(rough(121, 107, spacing=30.0, origin=ORIGIN))


@pytest.mark.parametrize("lod", LODS)
@pytest.mark.parametrize("mode", MODES)
def test_every_mode_paints_every_triangle(scene, mode, lod):
    settings = scene.settings.changed("lod", lod).changed("mode", mode)
    frame = scene.frame(Request(a_camera(scene.ground), settings))
    mesh = frame.mesh
    assert len(frame.paint.colours) in (len(mesh.vertices), len(mesh.triangles))
    assert frame.paint.colours.dtype == np.uint8
    assert (frame.paint.drape is not None) == (mode == "error")
    text = "\n".join(frame.lines())
    assert f"{len(mesh.triangles):,} triangles" in text
    assert f"{mesh.patches.culled_count:,} culled" in text


def test_colours_stand_for_what_their_mode_says(scene):
    camera, settings = a_camera(scene.ground), scene.settings.changed("lod", "uniform")
    settings = settings.changed("factor", 3.0)

    def painted(mode):
        return scene.frame(Request(camera, settings.changed("mode", mode)))

    normals = painted("normals")
    up = normals.mesh.normals[:, 2]
    assert normals.paint.colours[:, 2] == pytest.approx(255 * (0.5 + 0.5 * up), abs=0.51)

    deviation = painted("deviation")
    patches = deviation.mesh.patches
    drawn = np.flatnonzero(patches.drawn)
    brightness = np.zeros(patches.count)
    np.maximum.at(brightness, deviation.mesh.triangle_patches, deviation.paint.colours.sum(axis=1))
    order = drawn[np.argsort(patches.deviation[drawn])]
    assert brightness[order[-1]] > 1.5 * brightness[order[0]]

    error = painted("error").paint.drape.picture.astype(int)
    field = painted("error").measured()
    assert error.shape[:2] == scene.ground.shape
    assert (error[..., 0] > error[..., 2] + 60).any()  # red: above
    assert (error[..., 2] > error[..., 0] + 60).any()  # blue: below
    assert field.error.metres > 0


def test_sun_lights_the_slopes_that_face_it():
    scene = TerrainScene(plane(3.0, 0.0, spacing=5.0))  # rises to the east, so it faces west
    settings, camera = scene.settings.changed("lod", "uniform"), a_camera(scene.ground)
    west, east = (
        scene.frame(Request(camera, settings.changed("azimuth", azimuth))).paint.colours.mean()
        for azimuth in (270.0, 90.0)
    )
    assert west > 1.3 * east


@pytest.mark.parametrize(("samples", "tile"), [(2048, 4), (2049, 8)])
def test_large_ground_has_large_tiles(samples, tile):
    settings = TerrainScene(Heightmap(np.zeros((samples, samples), np.float32))).settings
    assert [settings.value(name) for name in ("tile", "factor", "maximum")] == [tile] * 3


def test_error_is_measured_where_the_mesh_does_not_bring_it(scene):
    camera, settings = a_camera(scene.ground), scene.settings
    promised = scene.frame(Request(camera, settings))
    assert promised.error.pixels <= 1.0
    assert promised.measured() is promised
    frame = scene.frame(Request(camera, settings.changed("lod", "uniform").changed("factor", 2.0)))
    assert frame.error is None
    assert "being measured" in "\n".join(frame.lines())
    measured = frame.measured()
    assert measured.error.metres > 0
    assert f"{measured.error.metres:.3g} m" in "\n".join(measured.lines())


def test_a_pick_tells_tile_factors_plane_and_height(scene):
    ground = scene.ground
    frame = scene.frame(Request(a_camera(ground), scene.settings.changed("lod", "coplanarity")))
    row, column = 100, 50  # of the raster
    x, y = ORIGIN[0] + 30.0 * column, ORIGIN[1] - 30.0 * row
    pick = frame.at(x, y)
    assert pick.tile == (100 // 4, 50 // 4)
    assert pick.point[2] == pytest.approx(float(ground.heights[row, column]) + ground.base)
    index = pick.tile[0] * frame.mesh.patches.shape[1] + pick.tile[1]
    assert pick.edge_factors == pytest.approx(tuple(frame.mesh.patches.edge_factors[index]))
    assert pick.deviation == pytest.approx(float(frame.terrain.analysis.deviation[pick.tile]))
    assert np.linalg.norm(pick.normal) == pytest.approx(1.0, abs=1e-5)
    assert frame.at(*ORIGIN).tile == (0, 0)
    x, y = ORIGIN[0] + ground.extent[0], ORIGIN[1] - ground.extent[1]
    assert frame.at(x, y).tile == tuple(extent - 1 for extent in frame.mesh.patches.shape)


@pytest.mark.slow
def test_holes_and_empty_views_are_frames_too():
    scene = TerrainScene(holed(61, 61))
    settings, camera = scene.settings, a_camera(scene.ground)
    away = replace(camera, target=(camera.eye[0], camera.eye[1] - 10.0, camera.eye[2] + 9.0))
    for mode in MODES:
        scene.frame(Request(camera, settings.changed("mode", mode)))
        empty = scene.frame(Request(away, settings.changed("mode", mode)))
        assert len(empty.mesh.triangles) == 0


def test_frustum_has_the_pictures_corners():
    camera = Camera((0.0, -10.0, 5.0), (0.0, 0.0, 0.0), size=(200, 100))
    eye, *corners = frustum(camera, 7.0)
    assert tuple(eye) == camera.eye
    pixels, depth = camera.project(corners)
    assert depth == pytest.approx([7.0] * 4)
    assert pixels == pytest.approx(
        np.array([[0, 100], [200, 100], [200, 0], [0, 0]], float), abs=1e-9
    )


def test_triangles_are_seen_from_the_front_alone_where_no_eye_gets_below_them(scene):
    x, y, z = scene.centre
    low, high = scene.ground.height_range
    away = x - scene.ground.extent[0]
    assert scene.shows_fronts_alone((x, y, z))
    assert scene.shows_fronts_alone((away, y, high + 1.0))
    assert not scene.shows_fronts_alone((away, y, low + 1.0))
    ground = TerrainScene(holed(61, 61))
    assert not ground.shows_fronts_alone(ground.centre)


# the ground's file


def test_a_file_that_changes_or_goes_is_told_once(tmp_path):
    path = tmp_path / "ground.npy"
    np.save(path, np.arange(64.0).reshape(8, 8))
    model = Model(lambda: TerrainScene(Heightmap(np.load(path))), path=path)
    assert model.news() is None
    np.save(path, np.arange(81.0).reshape(9, 9))
    assert "has changed" in model.news()
    assert model.news() is None
    model.reload()
    assert model.scene.ground.shape == (9, 9)
    path.unlink()
    assert "is gone" in model.news()
    assert model.news() is None


# the thread


def test_only_the_newest_request_is_made_next(scene):
    begun, go_on, made = Event(), Event(), []

    class Slow:
        def frame(self, request):
            made.append(request)
            begun.set()
            assert go_on.wait(30)
            return frame

    frame = scene.frame(Request(a_camera(scene.ground), scene.settings))
    engine = Engine(Model(Slow))
    try:
        requests = [replace(frame.request, number=number) for number in range(5)]
        engine.ask(requests[0])
        assert begun.wait(30)
        assert engine.working
        for request in requests[1:]:
            engine.ask(request)
        assert engine.take() is None
        go_on.set()
        assert engine.wait(30, measured=True)
        assert [request.number for request in made] == [0, 4]
        assert engine.take() is frame
        assert engine.take() is None
        assert not engine.working
    finally:
        engine.close()


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (FileError("cannot read dem.tif:\n gone"), "cannot read dem.tif: gone"),
        (MemoryError(), "MemoryError"),
        (ZeroDivisionError("no"), "ZeroDivisionError: no"),
    ],
)
def test_what_cannot_be_made_is_one_line_and_the_thread_lives_on(scene, error, line):
    frame = scene.frame(Request(a_camera(scene.ground), scene.settings))
    failures = [error]

    class Failing:
        def frame(self, request):
            if failures:
                raise failures.pop()
            return frame

    engine = Engine(Model(Failing))
    try:
        engine.ask(frame.request)
        assert engine.wait(30, measured=True)
        assert engine.problem == line
        engine.ask(frame.request)
        assert engine.wait(30, measured=True)
        assert engine.problem is None
        assert engine.take() is frame
    finally:
        engine.close()


@pytest.mark.parametrize("display", [None, ":4711"])
def test_no_display_names_the_ways_without_one(monkeypatch, display):
    monkeypatch.setattr("sys.platform", "linux")
    if display is None:
        monkeypatch.delenv("DISPLAY", raising=False)
    else:
        monkeypatch.setenv("DISPLAY", display)
    with pytest.raises(GraphicsError, match="use --off-screen or --web"):
        require_display()


@pytest.mark.slow
def test_a_broken_driver_is_one_line():
    child = subprocess.run(
        [sys.executable, "-m", "terrain_lod", "view", "volcano", "--off-screen"],
        capture_output=True,
        text=True,
        env=os.environ | {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent", "DISPLAY": ""},
        timeout=120,
    )
    assert child.returncode == REFUSED
    assert child.stderr.count("\n") == 1, child.stderr


def test_lod_is_monotonic_in_its_slider(scene):
    camera = a_camera(scene.ground)
    counts = [
        len(scene.frame(Request(camera, scene.settings.changed("pixels", pixels))).mesh.triangles)
        for pixels in (0.5, 2.0, 8.0)
    ]
    assert all(more > fewer for more, fewer in pairwise(counts))
