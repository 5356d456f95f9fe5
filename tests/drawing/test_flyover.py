"""Pictures along a path: where cameras go, what pictures hold, going on after a stop."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from support.grounds import holed, plane, rough
from terrain_lod import (
    Camera,
    CoplanarityLod,
    Heightmap,
    InputError,
    ScreenErrorLod,
    Terrain,
    UniformLod,
    default_camera,
    screen_error,
)
from terrain_lod.camera.path import flyover, load_path, orbit
from terrain_lod.cli.app import REFUSED, run
from terrain_lod.drawing.drape import Drape
from terrain_lod.drawing.flyover import Look, render_path
from terrain_lod.drawing.graphics import graphics_problem
from terrain_lod.drawing.picture import draw
from terrain_lod.errors import FileError
from terrain_lod.viewer.rig import height_at

# the arrays here do not say their spacing, which is then 1
pytestmark = pytest.mark.filterwarnings("ignore:.*how far apart its samples are")

needs_graphics = pytest.mark.skipif(
    graphics_problem() is not None, reason=f"no 3-D pictures tested: {graphics_problem()}"
)
EXAMPLES = Path(__file__).parents[2] / "examples"
SIZE = (160, 80)


# paths


def test_orbit_goes_once_around_at_one_height_and_distance():
    ground = rough(60, 60, spacing=30.0)
    first = default_camera(ground, size=SIZE)
    cameras = orbit(ground, 8, camera=first)
    assert cameras[0].eye == pytest.approx(first.eye)
    away = np.array([np.subtract(camera.eye, camera.target) for camera in cameras])
    assert away[:, 2] == pytest.approx(away[0, 2])
    assert np.hypot(*away[:, :2].T) == pytest.approx(np.hypot(*away[0, :2]))
    turned = np.degrees(np.unwrap(np.arctan2(away[:, 1], away[:, 0])))
    assert np.diff(turned) == pytest.approx([-45.0] * 7)  # clockwise from above


@pytest.mark.parametrize("ground", [rough(150, 90, spacing=30.0), holed(50, 60, base=900.0)])
def test_flight_goes_north_above_the_ground(ground):
    cameras = flyover(ground, 25, size=SIZE)
    norths = [camera.eye[1] for camera in cameras]
    assert norths == sorted(norths)
    for camera in cameras:
        x, y, z = camera.eye
        assert z > height_at(ground, x, y)
    steps = np.linalg.norm(np.diff([camera.eye for camera in cameras], axis=0), axis=1)
    assert steps.max() < 0.12 * np.hypot(*ground.extent)  # no jumps


def test_cameras_of_a_file_are_met_and_joined(tmp_path):
    path = tmp_path / "cameras.json"
    keys = [
        {"eye": [0, 0, 10], "target": [0, 10, 0], "fov": 30, "size": [64, 48]},
        {"eye": [5, 0, 10], "target": [5, 10, 0], "fov": 50},
        {"eye": [10, 0, 20], "target": [10, 10, 0], "fov": 50},
    ]
    path.write_text(json.dumps(keys))
    cameras = load_path(path, 5)
    assert cameras[0].eye == (0, 0, 10)
    assert cameras[2].eye == pytest.approx((5, 0, 10))
    assert cameras[4].eye == pytest.approx((10, 0, 20))
    assert cameras[1].fov == pytest.approx(40.0)
    assert {camera.size for camera in cameras} == {(64, 48)}
    path.write_text(json.dumps(keys[:1]))
    assert len(set(load_path(path, 3, size=(8, 8)))) == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "expected JSON"),
        ("{}", "a list of cameras"),
        ("[]", "a list of cameras"),
        ('[{"eye": [0, 0, 1]}]', "in camera 0"),
        ('[{"eye": [0, 0, 1], "target": [0, 0]}]', r"target as \(x, y, z\)"),
        ("[7]", "in camera 0"),
    ],
)
def test_files_without_cameras_are_refused(tmp_path, text, message):
    path = tmp_path / "cameras.json"
    path.write_text(text)
    with pytest.raises(InputError, match=message):
        load_path(path, 3)
    with pytest.raises(FileError, match="cannot read"):
        load_path(tmp_path / "none.json", 3)


# pictures


@pytest.fixture(scope="module")
def terrain():
    return Terrain(rough(91, 91, spacing=30.0))


@needs_graphics
def test_pictures_go_on_where_they_stopped(terrain, tmp_path):
    cameras = orbit(terrain.ground, 4, camera=default_camera(terrain.ground, size=SIZE))
    told = []

    def stop(done, total):
        told.append((done, total))
        if done == 2:
            raise KeyboardInterrupt

    lods = (CoplanarityLod(),)
    with pytest.raises(KeyboardInterrupt):
        render_path(terrain, cameras, tmp_path, lods=lods, progress=stop)
    assert told == [(1, 4), (2, 4)]
    written = {path.name: path.stat().st_mtime_ns for path in tmp_path.glob("*.png")}
    assert sorted(written) == ["0000.png", "0001.png"]
    paths = render_path(terrain, cameras, tmp_path, lods=lods)
    assert [path.name for path in paths] == [f"000{number}.png" for number in range(4)]
    assert all(path.exists() for path in paths)
    assert all((tmp_path / name).stat().st_mtime_ns == at for name, at in written.items())
    # pictures of something else are not mixed with them
    with pytest.raises(InputError, match="with other lods"):
        render_path(terrain, cameras, tmp_path, lods=(UniformLod(3),))
    with pytest.raises(InputError, match="with other cameras"):
        render_path(terrain, cameras[:3], tmp_path, lods=lods)


@needs_graphics
def test_a_flight_is_replayed_from_its_frames(terrain, tmp_path):
    ground = terrain.ground
    cameras = orbit(ground, 3, camera=default_camera(ground, size=(96, 48)))
    lods = (UniformLod(3), ScreenErrorLod(2.0))
    render_path(terrain, cameras, tmp_path, lods=lods)
    again = load_path(tmp_path / "frames.json", 3)
    for one, other in zip(cameras, again, strict=True):
        assert one.eye == pytest.approx(other.eye)
        assert (one.fov, one.size, one.far) == (other.fov, other.size, other.far)
    drawn = json.loads((tmp_path / "frames.json").read_text())["drawn"]
    assert list(drawn) == ["0000.png", "0001.png", "0002.png"]
    half = replace(cameras[1], size=(47, 48))
    for entry, lod in zip(drawn["0001.png"], lods, strict=True):
        mesh = terrain.mesh(half, lod=lod)
        assert entry["triangles"] == len(mesh.triangles)
        assert entry["pixels"] == screen_error(mesh, ground, half).maximum


@needs_graphics
def test_a_folder_of_another_flight_is_not_gone_on_with(terrain, tmp_path):
    ground = terrain.ground
    cameras = orbit(ground, 2, camera=default_camera(ground, size=(32, 24)))
    lods = (UniformLod(3),)
    render_path(terrain, cameras[:1], tmp_path / "flight", lods=lods)

    def goes_on(other, look=Look()):  # noqa: B008
        try:
            render_path(other, cameras[:1], tmp_path / "flight", lods=lods, look=look)
        except InputError as error:
            return str(error).partition(" with other ")[2].partition(":")[0]
        return True

    def like(heights, mask=None, **options):
        chosen = {"spacing": ground.spacing, "origin": ground.origin, "base": ground.base}
        return Heightmap(heights, mask=mask, **{**chosen, **options})

    heights = np.array(ground.heights)
    assert goes_on(Terrain(like(heights))) is True
    # all of these have the repr of the first
    inner = heights.copy()
    inner[40, 40] = heights[40, 41]
    hole = np.zeros(heights.shape, bool)
    hole[40, 40] = True
    assert "ground" in goes_on(Terrain(like(inner)))
    assert "ground" in goes_on(Terrain(like(heights, origin=(0.25, 0.0))))
    assert "ground" in goes_on(Terrain(like(heights, hole)))
    assert goes_on(Terrain(ground, plane="corners")) == "tiles"
    small = Heightmap(np.eye(4), spacing=np.divide(ground.spacing, 3))
    assert "ground" in goes_on(Terrain(ground, detail=small))
    one, other = (np.full((4, 4, 3), 9, np.uint8) for _ in range(2))
    one[0, 0], other[3, 3] = 90, 90
    drapes = (Look(drape=Drape(picture, ground)) for picture in (one, other))
    render_path(terrain, cameras[:1], tmp_path / "draped", lods=lods, look=next(drapes))
    with pytest.raises(InputError, match="with other look"):
        render_path(terrain, cameras[:1], tmp_path / "draped", lods=lods, look=next(drapes))
    # nothing is known of these pictures
    for text in ("", "[]", None):
        notes = tmp_path / "flight" / "frames.json"
        notes.unlink() if text is None else notes.write_text(text)
        assert "ground" in goes_on(terrain)


@needs_graphics
def test_two_levels_of_detail_stand_side_by_side_with_their_counts(terrain, tmp_path):
    camera = default_camera(terrain.ground, size=(322, 120))
    lods = (UniformLod(1), UniformLod(15))

    def picture(name, **options):
        look = Look(style="wireframe", counts=options.pop("counts"))
        (path,) = render_path(
            terrain, [camera], tmp_path / name, lods=options.pop("lods", lods), look=look
        )
        return np.asarray(Image.open(path)).astype(int)

    plain = picture("plain", counts=False)
    left, gap, right = plain[:, :160], plain[:, 160:162], plain[:, 162:]
    assert (gap == 255).all()
    assert (left.mean(axis=-1) < 150).sum() < 0.7 * (right.mean(axis=-1) < 150).sum()
    half = Camera(camera.eye, camera.target, fov=camera.fov, size=(160, 120))
    mesh = terrain.mesh(half, lod=lods[0])
    height_range = terrain.ground.height_range
    alone = draw(mesh, half, style="wireframe", height_range=height_range)
    assert (left == alone).all()
    counted = picture("counted", counts=True)
    changed = (counted != plain).any(axis=-1)
    assert changed[-20:, :160].sum() > 200
    assert changed[-20:, 162:].sum() > 200
    assert not changed[:100].any()
    with pytest.raises(InputError, match="one or two"):
        picture("three", counts=False, lods=lods * 2)


@needs_graphics
@pytest.mark.parametrize("style", ["lod", "factor"])
def test_what_is_compared_has_one_scale(style, tmp_path):
    ground = plane(0.0, 0.0, size=46, spacing=10.0)
    x, y, z = ground.centre
    above = Camera((x, y, z + 300.0), (x, y, z), up=(0, 1, 0), size=(162, 80))
    (path,) = render_path(
        Terrain(ground), [above], tmp_path / "way", lods=(UniformLod(1), UniformLod(4)),
        look=Look(style=style, counts=False),
    )  # fmt: skip
    picture = np.asarray(Image.open(path)).astype(int)
    coarse, fine = (np.median(picture[20:60, part, 1]) for part in (slice(60), slice(100, None)))
    # level ground, so each has one number all over, which is not the other's
    assert fine > coarse + 30


@needs_graphics
def test_a_drape_lies_where_its_ground_is():
    ground = plane(0.0, 0.0, size=46, spacing=10.0, origin=(500_000.0, 4_000_000.0))
    picture = np.zeros((46, 46, 3), np.uint8)
    picture[:23, :23] = 255, 0, 0  # north-west
    picture[:23, 23:] = 0, 255, 0  # north-east
    picture[23:, :23] = 0, 0, 255  # south-west
    drape = Drape(picture, ground)
    x, y, z = ground.centre
    camera = Camera((x, y, z + 600.0), (x, y, z), up=(0, 1, 0), size=(100, 100))
    mesh = Terrain(ground).mesh(lod=UniformLod(5))
    shown = draw(mesh, camera, drape=drape, sun=(0.0, 90.0)).astype(int)
    for pixel, channel in (((40, 40), 0), ((40, 60), 1), ((60, 40), 2)):
        colour = shown[pixel]
        assert colour[channel] > 150
        assert np.delete(colour, channel).max() < 40
    assert shown[60, 60].max() < 40
    # the middle of the ground is where four pixels meet: sample 22.5
    across = shown[40, 30:70]
    assert abs(int(np.argmax(across[:, 1] > across[:, 0])) + 30 - 50) <= 1


def test_drapes_are_checked(tmp_path):
    ground = rough(20, 20)
    with pytest.raises(InputError, match=r"picture \(H, W, 3\) of bytes"):
        Drape(np.zeros((4, 4)), ground)
    with pytest.raises(FileError, match="cannot read"):
        Drape.load(tmp_path / "none.png", ground)
    (tmp_path / "text.png").write_text("no picture")
    with pytest.raises(FileError, match="no picture that Pillow knows"):
        Drape.load(tmp_path / "text.png", ground)
    assert max(Drape(np.zeros((9000, 10, 3), np.uint8), ground).picture.shape) <= 4096


# the command and the example


@pytest.mark.slow
@needs_graphics
def test_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    np.save("hills.npy", np.array(rough(61, 61).heights))
    Image.new("RGB", (8, 8), (200, 30, 30)).save("red.png")
    small = ["--size", "96x64", "--frames", "2"]
    command = ["render", "hills.npy", "-o", "frames"]
    assert run([*command, "--orbit", "--beside", "screen-error", *small]) == 0
    assert sorted(os.listdir("frames")) == ["0000.png", "0001.png", "frames.json"]
    assert "2 pictures" in capsys.readouterr().out
    assert run(["render", "hills.npy", "-o", "one.png", "--texture", "red.png", *small]) == 0
    red = np.asarray(Image.open("one.png")).astype(int)
    ground = red[22:42, 38:58]  # mid-picture
    assert (ground[..., 0] > 2 * ground[..., 2]).mean() > 0.5
    plain = ["--orbit", "--no-counts", *small]
    assert run(["render", "hills.npy", "-o", "plain", *plain]) == 0
    assert run(["render", "hills.npy", "-o", "lines", "--wireframe", *plain]) == 0
    without, edges = (np.asarray(Image.open(f"{name}/0000.png")) for name in ("plain", "lines"))
    assert edges.mean() < without.mean() - 2
    counted = np.asarray(Image.open("frames/0000.png"))
    texts = counted[-8:, :40].astype(int) - without[-8:, :40]
    assert np.abs(texts).mean() > 10
    for bad, message in (
        (["--orbit", "--flyover"], "one of --path, --orbit and --flyover"),
        (["--beside", "uniform"], "with --beside"),
        (["--orbit", "--frames", "0"], "frames"),
        (["--path", "none.json"], "cannot read none.json"),
    ):
        assert run([*command, *bad]) == REFUSED
        assert message in capsys.readouterr().err


@needs_graphics
@pytest.mark.slow
def test_example(tmp_path):
    child = subprocess.run(
        [
            *(sys.executable, EXAMPLES / "render_flyover.py", tmp_path / "flight"),
            *("--ground", "volcano", "--frames", "2", "--size", "200", "100"),
        ],
        capture_output=True,
        text=True,
    )
    assert child.returncode == 0, child.stderr
    assert len(list((tmp_path / "flight").glob("*.png"))) == 2
