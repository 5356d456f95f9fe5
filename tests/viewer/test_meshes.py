"""Curved meshes and Bézier patches in the viewer: what is made, picked, drawn and set."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import terrain_lod as tl
from support.curved_meshes import cone, cube, torus
from support.viewer_hands import benchmark, drag, press
from terrain_lod.cli.app import REFUSED, run
from terrain_lod.curved.patch_factors import EDGE_FACTORS
from terrain_lod.drawing.graphics import graphics_problem
from terrain_lod.errors import InputError
from terrain_lod.viewer.controls import Controls
from terrain_lod.viewer.mesh_scene import BezierScene, CurvedScene
from terrain_lod.viewer.mesh_settings import MODES
from terrain_lod.viewer.model import Model
from terrain_lod.viewer.rig import Rig, triangle_seen
from terrain_lod.viewer.scene import Request
from terrain_lod.viewer.view import scene_of
from terrain_lod.viewer.window import Window

SIZE = (320, 240)
POT = Path(__file__).parents[2] / "examples" / "data" / "pot.bpt"
drawn = pytest.mark.skipif(
    graphics_problem() is not None, reason=f"no viewer window tested: {graphics_problem()}"
)


@pytest.fixture(scope="module")
def ring():
    return CurvedScene(replace(torus(), origin=np.array([500_000.0, 4_000_000.0, 30.0])))


@pytest.fixture(scope="module")
def pot():
    return BezierScene(tl.curved.load_bpt(POT))


def a_request(scene, **settings):
    wanted = scene.settings
    for name, value in settings.items():
        wanted = wanted.changed(name, value)
    return Request(replace(scene.camera(), size=SIZE), wanted)


# what is made


@pytest.mark.parametrize(
    ("settings", "options"),
    [
        ({}, {"factor": 5.0}),
        ({"factor": 7.3, "partitioning": "fractional_even"}, {"factor": 7.3}),
        ({"partitioning": "semi_uniform"}, {"factor": 5.0}),
        ({"sharp": "never"}, {"factor": 5.0, "sharp": False}),
        ({"sharp": "angle", "crease": 40.0}, {"factor": 5.0, "sharp": 40.0}),
        ({"normals": "linear"}, {"factor": 5.0, "normals": "linear"}),
        ({"tessellated": False}, {"factor": 1.0}),
        ({"back_faces": False}, {"factor": 5.0, "back_faces": 0.0}),
        ({"lod": "length"}, {"lod": tl.curved.LengthFactor(8.0)}),
        ({"lod": "silhouette", "cosine": 0.5}, {"lod": tl.curved.SilhouetteFactor(0.5, 1.0, 15.0)}),
    ],
)
def test_the_mesh_is_that_of_pn_triangles(settings, options):
    scene = CurvedScene(cone())
    request = a_request(scene, **settings)
    frame = scene.frame(request)
    partitioning = request.settings.partitioning
    mesh = tl.pn_triangles(cone(), camera=request.camera, partitioning=partitioning, **options)
    assert (frame.mesh.vertices == mesh.vertices).all()
    assert (frame.mesh.triangles == mesh.triangles).all()


def test_the_patches_are_those_of_bezier(pot):
    frame = pot.frame(a_request(pot, factor=9.0))
    mesh = tl.curved.bezier(POT, factor=9.0)
    assert (frame.mesh.vertices == mesh.vertices).all()
    assert len(pot.frame(a_request(pot, tessellated=False)).mesh.triangles) == 2 * len(pot.nets)


@pytest.mark.parametrize("lod", EDGE_FACTORS)
@pytest.mark.parametrize("mode", MODES)
def test_every_mode_paints_every_triangle_of_every_formula(ring, mode, lod):
    frame = ring.frame(a_request(ring, mode=mode, lod=lod))
    mesh = frame.mesh
    assert len(frame.paint.colours) in (len(mesh.vertices), len(mesh.triangles))
    assert frame.triangle_offsets[-1] == len(mesh.triangles)
    text = "\n".join(frame.lines())
    assert f"{len(mesh.triangles):,} triangles" in text
    assert text.startswith(lod)
    assert "error" not in text


def test_triangles_know_their_patch(ring):
    frame = ring.frame(a_request(ring, lod="distance"))
    corners = ring.mesh.vertices[ring.mesh.triangles]
    middles = corners.mean(axis=1)
    counts = np.diff(frame.triangle_offsets)
    owner = np.repeat(np.arange(len(counts)), counts)
    centres = frame.mesh.vertices[frame.mesh.triangles].mean(axis=1)
    away = np.linalg.norm(centres - middles[owner], axis=1)
    reach = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    assert (away < 1.5 * reach[owner]).all()
    # more triangles where the factor is higher
    assert np.corrcoef(frame.edge_factors.mean(axis=1), counts)[0, 1] > 0.9


def test_patches_out_of_view_and_turned_away_are_culled(ring):
    request = a_request(ring)
    everything = ring.frame(request)
    assert everything.drawn_count == len(ring.mesh.triangles)
    fronts = ring.frame(replace(request, settings=request.settings.changed("back_faces", False)))
    assert 0.3 < fronts.drawn_count / everything.drawn_count < 0.8
    near = replace(request, camera=Rig.of(request.camera).zoom(6.0).camera(SIZE))
    assert ring.frame(near).drawn_count < everything.drawn_count
    assert f"{ring.frame(near).drawn_count} patches drawn" in ring.frame(near).lines()[2]


def test_a_mesh_whose_y_points_up_is_turned():
    mesh = cone()
    turned = CurvedScene(mesh, y_up=True).mesh
    x, y, z = mesh.vertices.T
    assert ([x, -z, y] == turned.vertices.T).all()
    x, y, z = mesh.normals.T
    assert ([x, -z, y] == turned.normals.T).all()
    nets = tl.curved.load_bpt(POT)
    assert (BezierScene(nets, y_up=True).nets[..., 2] == nets[..., 1]).all()


# what is picked


@pytest.mark.slow
def test_what_a_pixel_shows_is_what_a_ray_meets(ring):
    frame = ring.frame(a_request(ring))
    camera = frame.request.camera
    across, up = camera.half_extents
    right, upward, forward = camera.axes
    pixels = np.random.default_rng(1).uniform((0, 0), np.array(SIZE) - 1, (300, 2)).round()
    shares = (2 * pixels + 1) / SIZE - 1
    rays = forward + shares[:, :1] * across * right + shares[:, 1:] * up * upward
    hits = tl.MeshQueries(frame.mesh).cast(camera.eye, rays)
    found = 0
    for pixel, hit, triangle, position in zip(
        pixels, hits.hit, hits.triangle, hits.position, strict=True
    ):
        seen = triangle_seen(frame.mesh, camera, *pixel)
        assert (seen is not None) == hit
        if seen is not None:
            found += 1
            assert seen[0] == triangle
            assert seen[1] == pytest.approx(position, abs=1e-6)
    assert 30 < found < 270


@pytest.mark.slow
def test_a_pick_tells_patch_factors_and_normal(ring):
    frame = ring.frame(a_request(ring, lod="distance"))
    pixels = product(range(0, SIZE[0], 8), range(0, SIZE[1], 8))
    picks = [frame.pick(frame.request.camera, x, y) for x, y in pixels]
    assert None in picks
    for pick in filter(None, picks):
        assert pick.edge_factors == tuple(frame.edge_factors[pick.patch])
        assert np.linalg.norm(pick.normal) == pytest.approx(1.0)
        assert pick.lines()[0].startswith(f"patch {pick.patch} ")


# in a window


@pytest.fixture(params=["ring", "pot"])
def controls(request, tmp_path):
    scene = request.getfixturevalue(request.param)
    model = Model(lambda: scene)
    window = Window(model, replace(scene.camera(), size=SIZE), off_screen=True)
    window.settle()
    yield Controls(window, pictures=tmp_path)
    window.close()


def picture(controls):
    window = controls.window
    window.settle()
    window.texts_shown, window.note = False, ""
    controls.pump()
    return window.picture().astype(int)


@pytest.mark.slow
@drawn
def test_every_mode_shows_something_of_its_own(controls):
    pictures = []
    for number, mode in enumerate(MODES, 1):
        press(controls, str(number))
        assert controls.window.settings.mode == mode
        pictures.append(picture(controls))
    for one, other in product(range(len(MODES)), repeat=2):
        assert one == other or np.abs(pictures[one] - pictures[other]).mean() > 0.5
    press(controls, "5")  # no such mode here
    assert controls.window.settings.mode == MODES[-1]


@pytest.mark.slow
@drawn
def test_the_factor_slider_changes_the_triangles(controls):
    window = controls.window
    counts = []
    for share in (0.0, 0.5, 1.0):
        benchmark().slide(controls, "factor", share)
        counts.append(len(window.settle().mesh.triangles))
    assert counts[0] < counts[1] < counts[2]
    assert window.settings.value("factor") == pytest.approx(64.0)
    patches = len(window.frame.edge_factors)
    assert counts[0] in (patches, 2 * patches)


@pytest.mark.slow
@drawn
def test_frozen_detail_a_click_and_a_look_from_below(controls):
    window = controls.window
    press(controls, "f")
    frame = window.settle()
    window.drive(window.rig.orbit(70.0, -60.0))
    assert window.rig.eye[2] < window.model.scene.centre[2]  # there is no ground here
    controls.pump()
    assert window.settle() is frame
    controls.pump()
    spots = [(x, y) for x in range(20, SIZE[0], 20) for y in range(20, SIZE[1], 20)]
    notes = []
    for spot in spots:
        drag(controls, spot, spot)
        notes.append(window.note)
    assert "nothing there" in notes
    assert any(note.startswith("patch ") for note in notes)


@pytest.mark.slow
@drawn
def test_any_events_in_any_order(controls):
    rng = np.random.default_rng(11)
    for number in range(60):
        benchmark().event(controls, rng)
        if number % 20 == 19:
            controls.window.settle()
    controls.window.apply(controls.window.model.scene.settings)
    controls.window.plotter.render_window.SetSize(*SIZE)
    controls.window.drive(controls.window.home)
    assert picture(controls).std() > 10


# what is refused, and the command line


@pytest.mark.parametrize(
    ("what", "message"),
    [
        (np.zeros((0, 4, 4, 3)), "expected patches to look at"),
        (np.zeros((3, 5)), "expected patches"),
        (tl.Mesh(*(np.zeros((0, 3), kind) for kind in "ffi")), "empty mesh"),
    ],
)
def test_what_cannot_be_looked_at(what, message):
    with pytest.raises(InputError, match=message):
        scene_of(what)


@pytest.mark.slow
@drawn
def test_command_opens_meshes_and_patches(capsys, tmp_path):
    path, made = tmp_path / "view.png", tmp_path / "cube.ply"
    cube().save(made)
    for file, triangles in ((made, 12 * 13), (POT, 24 * 18)):
        options = ["--off-screen", "-o", str(path), "--size", "160x120"]
        assert run(["view", str(file), "--factor", "3", "--mode", "lod", *options]) == 0
        assert f"{triangles} triangles" in capsys.readouterr().out
        with Image.open(path) as image:
            assert image.size == (160, 120)
            assert np.asarray(image).std() > 10


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--mode", "deviation"], "expected one of shaded, wireframe, lod, normals"),
        (["--lod", "budget"], "expected one of uniform, distance"),
        (["--spacing", "3"], "expected a raster with --spacing"),
        (["--tile", "7"], "expected a raster with --tile"),
        (["--factor", "99"], "expected factor in its range, got 99: nearest is 64"),
    ],
)
def test_what_is_no_matter_of_meshes_is_one_line(capsys, tmp_path, options, message):
    path = tmp_path / "cube.ply"
    cube().save(path)
    assert run(["view", str(path), "--off-screen", *options]) == REFUSED
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


@pytest.mark.slow
@pytest.mark.parametrize("name", ["none.ply", "none.bpt", "cut.ply", "cut.bpt", "what.xyz"])
def test_files_that_are_no_meshes_are_one_line(capsys, tmp_path, name):
    if name.startswith("cut"):
        cube().save(tmp_path / "cube.ply")
        whole = POT if name.endswith("bpt") else tmp_path / "cube.ply"
        (tmp_path / name).write_bytes(whole.read_bytes()[:200])
    if name.startswith("what"):
        (tmp_path / name).write_text("hello")
    assert run(["view", str(tmp_path / name), "--off-screen"]) == REFUSED
    assert capsys.readouterr().err.count("\n") == 1


@drawn
def test_a_mesh_is_read_again_and_a_lost_file_leaves_the_last_good_one(capsys, tmp_path):
    path = tmp_path / "mesh.ply"
    cube().save(path)
    model = Model(lambda: CurvedScene(tl.load_mesh(path)), path=path)
    window = Window(model, replace(model.scene.camera(), size=SIZE), off_screen=True)
    try:
        window.settle()
        torus().save(path)
        assert "has changed" in model.news()
        window.reload()
        assert len(window.settle().edge_factors) == len(torus().triangles)
        assert window.settings.diagonal == pytest.approx(model.scene.diagonal)
        path.unlink()
        assert "is gone" in model.news()
        window.reload()
        assert window.note.startswith("expected a mesh file")
        window.drive(window.rig.orbit(10.0, 0.0))
        window.settle()
        assert len(window.frame.edge_factors) == len(torus().triangles)
    finally:
        window.close()
