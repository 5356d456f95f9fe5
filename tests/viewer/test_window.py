"""The viewer's window, off screen: what it draws, and what mouse, keys and sliders do to it."""

from __future__ import annotations

import gc
import math
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from support.grounds import rough
from support.viewer_hands import benchmark, drag, press
from terrain_lod import default_camera
from terrain_lod.cli.app import REFUSED, run
from terrain_lod.drawing.graphics import graphics_problem
from terrain_lod.errors import FileError, GraphicsError, InputError
from terrain_lod.terrain.lod_promises import BudgetLod
from terrain_lod.terrain.lods import LODS
from terrain_lod.viewer.controls import Controls
from terrain_lod.viewer.model import Model
from terrain_lod.viewer.terrain_scene import TerrainScene
from terrain_lod.viewer.terrain_settings import MODES
from terrain_lod.viewer.view import look
from terrain_lod.viewer.window import Window

pytestmark = pytest.mark.skipif(
    graphics_problem() is not None, reason=f"no viewer window tested: {graphics_problem()}"
)
SIZE = (320, 240)


@pytest.fixture(scope="module")
def model():
    scene = TerrainScene(rough(121, 121, spacing=30.0, origin=(500_000.0, 4_000_000.0)))
    return Model(lambda: scene)


@pytest.fixture
def window(model):
    window = Window(model, default_camera(model.scene.ground, size=SIZE), off_screen=True)
    window.settle()
    yield window
    window.close()


@pytest.fixture
def controls(window, tmp_path):
    return Controls(window, pictures=tmp_path)


def bare(window):
    """The picture without texts."""
    window.texts_shown, window.note = False, ""
    return window.picture().astype(int)


# what it draws


def test_the_ground_is_where_its_camera_projects_it(window):
    bare(window)
    window.change("mode", "normals")
    window.settle()
    picture = bare(window)
    frame = window.frame
    mesh = frame.mesh
    pixels, depth = window.camera.project(mesh.vertices + mesh.origin)
    assert (depth > 0).any()
    # the vertex of the picture's lowest row is in front of everything: its colour is seen
    inside = (depth > 0) & (np.abs(pixels - np.array(SIZE) / 2) < np.array(SIZE) / 2 - 4).all(1)
    nearest = np.flatnonzero(inside)[np.argsort(depth[inside])[:30]]
    seen = picture[pixels[nearest, 1].astype(int), pixels[nearest, 0].astype(int)]
    away = np.abs(seen - frame.paint.colours[nearest]).max(axis=1)
    assert np.median(away) < 12


@pytest.mark.slow
def test_every_mode_shows_something_of_its_own(window):
    pictures = {}
    for mode in MODES:
        window.change("mode", mode)
        window.settle()
        pictures[mode] = bare(window)
        assert pictures[mode].std() > 10
    for mode, picture in pictures.items():
        for other, another in pictures.items():
            assert mode == other or np.abs(picture - another).mean() > 3, (mode, other)
    # coming back to a mode gives its picture again, the texture of the error gone
    window.change("mode", "shaded")
    window.settle()
    assert (bare(window) == pictures["shaded"]).all()
    # lines on paper: most pixels are grey
    wire = pictures["wireframe"][-40:]
    assert np.ptp(wire, axis=-1).mean() < 20
    assert (wire.min(axis=-1) < 120).any()


@pytest.mark.slow
def test_frozen_detail_stays_and_its_frustum_is_drawn(controls):
    window = controls.window
    count = len(window.frame.mesh.triangles)
    press(controls, "f")
    frame = window.settle()
    assert "FROZEN" in frame.lines()[0]
    assert len(frame.mesh.triangles) == count
    window.drive(window.rig.orbit(60.0, 25.0).zoom(0.4))
    controls.pump()
    assert window.settle() is frame  # no other mesh was asked for
    picture = bare(window)
    yellow = (picture[..., 0] > 200) & (picture[..., 1] > 160) & (picture[..., 2] < 60)
    assert yellow.sum() > 50
    press(controls, "f")
    assert window.settle() is not frame
    picture = bare(window)
    assert not ((picture[..., 0] > 200) & (picture[..., 2] < 60)).any()


def test_the_last_good_mesh_stays_when_the_next_cannot_be_made(window):
    frame = window.frame
    window.change("lod", "budget")
    formulas = {**window.settings.formulas, "budget": BudgetLod(1)}
    window.settings = replace(window.settings, lod="budget", formulas=formulas)
    window.ask()
    with pytest.raises(InputError, match="budget of at least"):
        window.settle()
    assert window.frame is not None
    assert len(window.frame.mesh.triangles)
    assert "budget of at least" in window.note
    window.change("lod", "uniform")
    assert window.settle() is not frame
    assert window.note == ""  # what is shown has no problem


# mouse, keys, sliders


@pytest.mark.slow
def test_drag_orbits_wheel_zooms_and_shift_pans(controls):
    window = controls.window
    before = window.rig
    drag(controls, (100, 100), (180, 100))
    assert window.rig.target == pytest.approx(before.target)
    assert window.rig.heading == pytest.approx((before.heading + 45.0) % 360)
    drag(controls, (180, 100), (100, 100))
    controls.window.plotter.iren.interactor.InvokeEvent("MouseWheelForwardEvent")
    assert window.rig.distance < before.distance
    heading = window.rig.heading
    drag(controls, (100, 100), (140, 90), shift=True)
    assert window.rig.heading == heading
    assert window.rig.target != before.target
    press(controls, "r")
    assert window.rig == window.home
    drag(controls, (100, 100), (100, 160), button="Right")
    assert window.rig.distance < before.distance


@pytest.mark.slow
def test_flying_looks_around_and_moves_along_the_view(controls):
    window = controls.window
    press(controls, "g")
    eye = window.rig.eye
    drag(controls, (100, 100), (160, 100))
    assert window.rig.eye == pytest.approx(eye)
    forward, eye = np.array(window.rig.forward), np.array(window.rig.eye)
    press(controls, "Up")
    moved = np.array(window.rig.eye) - eye
    assert moved @ forward == pytest.approx(float(np.linalg.norm(moved)))
    for _ in range(400):
        press(controls, "w")  # into the ground, and out at the other side
    assert window.rig.eye[2] > window.model.scene.ground.height_range[0]
    assert math.dist(window.rig.eye, window.model.scene.centre) < 1e5
    window.drive(window.rig.fly(1e9))
    assert window.note == "the camera stays above the ground and near it"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "name"),
    [("m", "mode"), ("l", "lod"), ("p", "partitioning"), ("e", "edge_rule")],
)
def test_keys_go_to_the_next_choice_and_its_mesh_is_shown(controls, key, name):
    window = controls.window
    before = window.settings
    press(controls, key)
    assert window.settings == before.next(name)
    assert window.settle().request.settings == window.settings


def test_numbers_choose_modes_and_vtk_does_not_hear_them(controls):
    window = controls.window
    for number, mode in enumerate(MODES, 1):
        press(controls, str(number))
        assert window.settings.mode == mode
    press(controls, "w")
    assert not window.plotter.render_window.GetStereoRender()
    assert window.stage.surface.prop.style == "Surface"


@pytest.mark.slow
def test_a_click_tells_what_is_there(controls):
    window = controls.window
    window.picture()
    drag(controls, (160, 60), (160, 60))
    assert window.note.startswith("tile ")
    assert "deviation" in window.note
    # what it found projects to where the click was
    mark = np.array(window.stage.mark.mapper.GetInput().GetPoint(0)) + window.stage.origin
    (pixel,), _ = window.camera.project([mark])
    assert pixel == pytest.approx([160.5, SIZE[1] - 60.5], abs=0.1)
    window.drive(window.rig.look(0.0, 60.0))
    window.settle()
    window.draw()
    drag(controls, (160, SIZE[1] - 2), (160, SIZE[1] - 2))
    assert window.note == "nothing there"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "value"), [("pixels", 24.0), ("lod", "uniform"), ("tile", 8), ("mode", "lod")]
)
def test_a_pick_tells_of_the_mesh_that_is_shown(controls, name, value):
    window = controls.window
    drag(controls, (160, 60), (160, 60))
    camera, before = window.camera, window.note
    window.change(name, value)
    assert window.note == before  # as long as the old mesh is shown
    window.drive(window.rig.orbit(10.0, 0.0))
    frame = window.settle()
    known = frame.pick(camera, 160, 60)
    assert window.note == "\n".join(known.lines())
    assert (window.note == before) == (name == "mode")  # which changes colours alone
    mark = np.array(window.stage.mark.mapper.GetInput().GetPoint(0)) + window.stage.origin
    assert mark == pytest.approx(known.point, abs=1e-2)


@pytest.mark.slow
def test_a_pick_does_not_come_back_over_another_note(controls):
    window = controls.window
    drag(controls, (160, 60), (160, 60))
    window.note = "wrote it"
    window.change("pixels", 24.0)
    window.settle()
    assert window.note == "wrote it"


@pytest.mark.slow
def test_every_text_and_slider_belongs_to_the_mesh_that_is_shown(controls):
    window = controls.window
    for lod in LODS:
        window.change("lod", lod)
        frame = window.settle()
        controls.pump()
        lines = window.lines()
        assert lines[0] == str(window.settings)
        assert lines[1] == f"{len(frame.mesh.triangles):,} triangles"
        for slider in window.settings.sliders:
            title = controls.widgets[slider.name].GetRepresentation().GetTitleText()
            said = slider.said(frame.request.settings.value(slider.name))
            assert title == f"{slider.label}: {said}"


def test_sliders_change_settings_and_follow_them(controls):
    window = controls.window
    counts = [len(window.frame.mesh.triangles)]
    benchmark().slide(controls, "pixels", 1.0)
    assert window.settings.value("pixels") == pytest.approx(32.0)
    counts.append(len(window.settle().mesh.triangles))
    assert counts[1] < counts[0]
    window.change("pixels", 2.0)
    controls.pump()
    shape = controls.widgets["pixels"].GetRepresentation()
    assert shape.GetValue() == pytest.approx(math.log10(2.0))
    assert shape.GetTitleText() == "pixels: 2"


@pytest.mark.slow
def test_only_the_sliders_of_the_level_of_detail_are_there(controls):
    for lod in LODS:
        controls.window.change("lod", lod)
        controls.pump()
        shown = {name for name, widget in controls.widgets.items() if widget.GetEnabled()}
        assert shown == {slider.name for slider in controls.window.settings.sliders}
    press(controls, "h")
    controls.pump()
    assert not any(widget.GetEnabled() for widget in controls.widgets.values())


@pytest.mark.slow
def test_windows_of_any_size_even_none(controls):
    window = controls.window
    for size in ((1, 1), (301, 77), (77, 301)):
        window.plotter.render_window.SetSize(*size)
        controls.pump()
        window.settle()
        assert window.frame.request.camera.size == size
        assert window.picture().shape == (size[1], size[0], 3)
    window.drive(window.rig)
    type(window).size, kept = property(lambda _: (0, 0)), type(window).size
    try:
        assert not window.pump()
        with pytest.raises(InputError, match="window with pixels"):
            window.picture()
    finally:
        type(window).size = kept


# files


@pytest.mark.slow
def test_picture_and_recording(controls, tmp_path):
    window = controls.window
    press(controls, "c")
    press(controls, "c")
    with Image.open(tmp_path / "terrain-lod-002.png") as image:
        assert image.size == SIZE
    press(controls, "v")
    for _ in range(3):
        window.drive(window.rig.orbit(20.0, 0.0))
        window.settle()
        window.redraw()
        controls.pump()
    press(controls, "v")
    assert window.note.startswith("wrote ")
    with Image.open(tmp_path / "terrain-lod-001.gif") as movie:
        assert movie.n_frames == 3
        assert movie.size == SIZE


@pytest.mark.slow
def test_a_picture_that_cannot_be_written_is_a_note(controls):
    controls._pictures = Path("/nonexistent")
    press(controls, "c")
    assert "expected a folder" in controls.window.note


@pytest.mark.slow
def test_ground_is_read_again_and_a_lost_file_leaves_the_last_good_mesh(tmp_path):
    from terrain_lod import Heightmap

    path = tmp_path / "ground.npy"
    np.save(path, np.array(rough(61, 61).heights))

    def load():
        try:
            return TerrainScene(Heightmap(np.load(path)))
        except OSError as error:
            raise FileError(f"cannot read {path.name}: {error.strerror}") from None

    model = Model(load, path=path)
    window = Window(model, default_camera(model.scene.ground, size=SIZE), off_screen=True)
    try:
        controls = Controls(window)
        window.settle()
        np.save(path, np.array(rough(91, 91, seed=1).heights))
        press(controls, "u")
        assert window.settle().scene.ground.shape == (91, 91)
        assert window.settings.diagonal == pytest.approx(90 * 2**0.5)
        path.unlink()
        press(controls, "u")
        with pytest.raises(InputError, match=r"cannot read ground\.npy"):
            window.settle()
        assert window.note.startswith("cannot read ground.npy")
        assert window.frame.scene.ground.shape == (91, 91)
        assert window.picture().std() > 10
    finally:
        window.close()


@pytest.mark.slow
def test_a_recording_that_cannot_be_written_is_over(window, tmp_path):
    folder = tmp_path / "pictures"
    controls = Controls(window, pictures=folder)

    def record(pictures):
        folder.mkdir()
        press(controls, "v")
        assert controls.movie is not None
        for number in range(pictures):
            window.note = f"{number}"
            window.redraw()
            controls.pump()

    record(pictures=3)
    shutil.rmtree(folder)
    press(controls, "v")
    assert "cannot write" in window.note
    assert controls.movie is None
    # it ends by itself where a picture cannot be written
    record(pictures=0)
    shutil.rmtree(folder)
    window.redraw()
    controls.pump()
    assert "the recording ends" in window.note
    assert controls.movie is None
    record(pictures=3)
    press(controls, "v")
    with Image.open(folder / "terrain-lod-001.gif") as movie:
        assert movie.n_frames == 3


@pytest.mark.slow
def test_off_screen_writes_a_picture_and_a_flight(model, tmp_path):
    lines = look(
        model,
        default_camera(model.scene.ground, size=SIZE),
        picture=tmp_path / "view.png",
        record=tmp_path / "fly.gif",
        frames=3,
    )
    assert any("triangles" in line for line in lines)
    with Image.open(tmp_path / "view.png") as image, Image.open(tmp_path / "fly.gif") as movie:
        assert image.size == movie.size == SIZE
        assert movie.n_frames == 3


@pytest.mark.slow
def test_from_python_without_a_display(tmp_path, monkeypatch):
    import terrain_lod as tl

    ground = rough(40, 40)
    lines = look(ground, settings={"mode": "lod", "pixels": 3.0}, picture=tmp_path / "view.png")
    assert lines[0].startswith("screen-error")
    assert (tmp_path / "view.png").exists()
    with pytest.raises(InputError, match="unknown setting 'colour'"):
        look(ground, settings={"colour": "red"})
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    with pytest.raises(GraphicsError, match="expected a display"):
        tl.view(ground)


@pytest.mark.slow
def test_command_without_a_display(capsys, tmp_path, monkeypatch):
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    assert run(["view", "volcano"]) == REFUSED
    assert capsys.readouterr().err.count("\n") == 1
    path = tmp_path / "view.png"
    assert run(["view", "volcano", "-o", str(path)]) == REFUSED
    assert "--off-screen" in capsys.readouterr().err
    assert run(["view", "volcano", "--off-screen", "-o", str(path), "--size", "160x120"]) == 0
    assert "triangles" in capsys.readouterr().out
    assert path.exists()


def test_vtk_is_tidied_up_on_its_own_thread(model):
    assert gc.isenabled()
    window = Window(model, default_camera(model.scene.ground, size=SIZE), off_screen=True)
    assert not gc.isenabled()
    window.close()
    assert gc.isenabled()


@pytest.mark.slow
def test_the_collector_waits_for_the_last_of_two_windows(model):
    camera = default_camera(model.scene.ground, size=SIZE)
    first, second = (Window(model, camera, off_screen=True) for _ in range(2))
    first.close()
    first.close()
    assert not gc.isenabled()
    second.close()
    assert gc.isenabled()
    gc.disable()
    try:
        Window(model, camera, off_screen=True).close()
        assert not gc.isenabled()  # as it was
    finally:
        gc.enable()


def test_a_window_that_does_not_open_leaves_the_collector_on(model):
    with pytest.raises(AttributeError):
        Window(model, object(), off_screen=True)
    with pytest.raises(AttributeError):
        Window(object(), default_camera(model.scene.ground, size=SIZE), off_screen=True)
    assert gc.isenabled()


@pytest.mark.slow
def test_a_light_panel_stands_under_the_sliders(controls):
    window = controls.window
    window.plotter.render_window.SetSize(900, 700)  # beside the read-out
    window.change("mode", "lod")
    window.settle()
    controls.pump()
    with_panel = window.picture().astype(int)
    press(controls, "h")
    controls.pump()
    without = window.picture().astype(int)
    strip = np.s_[60:330, 720:880]
    assert with_panel[strip].mean() > without[strip].mean() + 20


# wear


@pytest.mark.slow
def test_any_events_in_any_order(controls):
    rng, event = np.random.default_rng(7), benchmark().event
    for number in range(60):
        event(controls, rng)
        if number % 20 == 19:
            controls.window.settle()
    controls.window.apply(controls.window.model.scene.settings)
    controls.window.plotter.render_window.SetSize(*SIZE)
    controls.window.drive(controls.window.home)
    controls.pump()
    controls.window.settle()
    assert bare(controls.window).std() > 10
