"""The command line as a user meets it: what it makes, and the one line it says when it cannot."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
import warnings
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from terrain_lod.cli import app as cli
from terrain_lod.cli.app import INTERRUPTED, REFUSED, run
from terrain_lod.device.device import Device
from terrain_lod.drawing.graphics import INSTALL_COMMAND, graphics_problem
from terrain_lod.files.meshes.export import FORMATS

# the arrays here do not say their spacing, which is then 1
pytestmark = pytest.mark.filterwarnings("ignore:.*how far apart its samples are")

needs_graphics = pytest.mark.skipif(
    graphics_problem() is not None, reason=f"no 3-D pictures tested: {graphics_problem()}"
)

SMALL = ["--size", "96x64"]


@pytest.fixture(autouse=True)
def _work_in_an_empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name in [name for name in os.environ if name.startswith("TERRAIN_LOD_")]:
        monkeypatch.delenv(name)
    # the command line shows warnings in its own way
    monkeypatch.setattr(warnings, "showwarning", warnings.showwarning)


@pytest.fixture
def ground():
    """A small file of heights, in a folder of its own."""
    os.mkdir("in")
    x, y = np.meshgrid(np.linspace(0, 6, 76), np.linspace(0, 5, 61))
    np.save("in/hills.npy", (50 * np.sin(x) * np.cos(y)).astype(np.float32))
    return "in/hills.npy"


def files():
    """What was written, beside the input."""
    return sorted(name for name in os.listdir() if name not in {"in", "hills.npy"})


def refused(capsys, *tokens):
    """Run a command that must be refused; return its one line."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert run(tokens) == REFUSED
    out, error = capsys.readouterr()
    assert out == ""
    assert error.count("\n") == 1, error
    assert error.startswith("terrain-lod: ")
    assert "Traceback" not in error
    assert files() == []
    return error


# what it makes


@needs_graphics
@pytest.mark.parametrize("style", ["shaded", "wireframe", "lod"])
def test_render(ground, capsys, style):
    assert run(["render", ground, "-o", "view.png", "--style", style, *SMALL]) == 0
    assert files() == ["view.png"]
    with Image.open("view.png") as picture:
        assert picture.size == (96, 64)
        assert np.ptp(np.asarray(picture)) > 50
    assert capsys.readouterr().out.startswith("view.png: ")


@pytest.mark.parametrize("ending", FORMATS)
def test_mesh(ground, capsys, ending):
    assert run(["mesh", ground, "-o", f"hills{ending}"]) == 0
    assert files() == [f"hills{ending}"]
    out = capsys.readouterr().out
    assert ", 0 of " in out
    assert "RMS" in out
    assert "watertight" in out


def test_mesh_is_culled_where_asked(ground, capsys):
    away = ["--eye", "40,-100,50", "--target", "40,-30,0", "--fov", "10"]
    counts = []
    for cull in (["--cull"], []):
        assert run(["mesh", ground, "-o", "part.ply", *cull, *away]) == 0
        counts.append(int(capsys.readouterr().out.split()[1].replace(",", "")))
    assert 0 < counts[0] < counts[1] / 2


def test_detail_is_laid_over_the_ground(ground, capsys):
    np.save("in/bumps.npy", np.random.default_rng(0).normal(size=(9, 8)))
    options = ["--spacing", "3", "--lod", "max-error", "--metres", "0.5", "--levels", "1"]
    assert run(["mesh", ground, "-o", "hills.glb", *options]) == 0
    assert "0 of 20 patches left out" in capsys.readouterr().out
    assert run(["mesh", ground, "-o", "hills.glb", "--detail", "in/bumps.npy", *options]) == 0
    out = capsys.readouterr().out
    assert "0 of 180 patches left out" in out
    # measured against the sum: hardly a triangle less than all there are
    assert float(out.split("largest error ")[1].split()[0]) <= 0.5
    assert "40906 samples" in out
    assert "watertight" in out


@pytest.mark.slow
def test_lods_and_their_options_reach_the_mesh(ground, capsys):
    def triangles(*options):
        assert run(["mesh", ground, "-o", "hills.glb", *options]) == 0
        return int(capsys.readouterr().out.split(": ")[1].split()[0].replace(",", ""))

    assert triangles("--lod", "uniform", "--factor", "1") == 2 * 20
    # the factor is a tile's cells, so that every cell is drawn
    assert triangles("--lod", "uniform") == 2 * 60 * 75
    assert triangles("--lod", "uniform", "--tile", "1") == 2 * 60 * 75
    near = triangles("--lod", "distance", "--near", "1e6", "--far", "2e6")
    assert triangles("--lod", "distance", "--near", "1e6", "--far", "2e6", "--maximum", "5") < near
    assert triangles("--lod", "distance", "--far", "1") < near
    flat = ("--lod", "book-coplanarity", "--flat-weight", "1", "--near", "1e6", "--far", "2e6")
    assert triangles(*flat) == near
    coplanarity = ("--lod", "coplanarity", "--pixels", "300", "--edge-rule")
    assert triangles(*coplanarity, "max") > triangles(*coplanarity, "min")
    assert triangles("--pixels", "9") < triangles("--lod", "screen-error")
    assert triangles("--lod", "max-error", "--metres", "9") < triangles(
        "--lod", "max-error", "--metres", "1"
    )
    assert triangles("--lod", "budget", "--triangles", "4000") <= 4000


@pytest.mark.slow
@pytest.mark.parametrize("command", [["report", "in/hills.npy"], ["demo", "in/hills.npy"]])
def test_report_and_demo(ground, capsys, command, monkeypatch):
    monkeypatch.setenv("TERRAIN_LOD_REPORT_SIZE", "96x64")
    assert run([*command, "--output", "out/folder"]) == 0
    out = capsys.readouterr().out
    made = set(os.listdir("out/folder"))
    assert {"report.html", "report.json", "report.csv", "maps.svg"} <= made
    assert "report.html" in out
    assert "triangles than distance LOD" in out
    if command[0] == "demo":
        assert "hills.glb" in made
        assert "watertight" in out
        assert not {name for name in made if not name.startswith("report") and name not in out}


@pytest.mark.slow
@needs_graphics
def test_camera_comes_from_a_report(ground, capsys):
    view = ["--eye", "10,20,300", "--fov", "50", *SMALL]
    assert run(["report", ground, "-o", "out", *view]) == 0
    assert run(["render", ground, "-o", "a.png", "--camera", "out/report.json"]) == 0
    assert run(["render", ground, "-o", "b.png", *view]) == 0
    with Image.open("a.png") as first, Image.open("b.png") as second:
        assert first.size == (96, 64)
        assert (np.asarray(first) == np.asarray(second)).all()
    # an option given beside the file wins
    assert run(["render", ground, "-o", "a.png", "--camera", "out/report.json", "--fov", "20"]) == 0
    with Image.open("a.png") as first, Image.open("b.png") as second:
        assert (np.asarray(first) != np.asarray(second)).any()


@needs_graphics
def test_options_come_from_the_environment_too(ground, capsys, monkeypatch):
    monkeypatch.setenv("TERRAIN_LOD_RENDER_SIZE", "40x30")
    assert run(["render", ground, "-o", "view.png"]) == 0
    with Image.open("view.png") as picture:
        assert picture.size == (40, 30)


def test_spacing_makes_the_ground_wider(ground, capsys):
    assert run(["mesh", ground, "-o", "hills.glb", "--spacing", "30,20", "-v"]) == 0
    assert "spacing=(30, 20)" in capsys.readouterr().err
    assert run(["mesh", ground, "-o", "hills.glb", "--spacing", "7", "-v"]) == 0
    assert "spacing=(7, 7)" in capsys.readouterr().err


def test_quiet_says_nothing_and_verbose_says_more(ground, capsys):
    assert run(["mesh", ground, "-o", "hills.glb", "-q"]) == 0
    assert capsys.readouterr() == ("", "")
    assert run(["mesh", ground, "-o", "hills.glb"]) == 0
    assert capsys.readouterr().err == ""
    assert run(["-v", "mesh", ground, "-o", "hills.glb"]) == 0
    assert "Heightmap(61 x 76" in capsys.readouterr().err


def test_warnings_are_one_line(capsys):
    Image.fromarray(np.arange(64, dtype=np.uint8).reshape(8, 8)).save("steps.png")
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        assert run(["mesh", "steps.png", "-o", "steps.glb", "--spacing", "1"]) == 0
    error = capsys.readouterr().err
    assert error.startswith("terrain-lod: warning: ")
    assert error.count("\n") == 1


def test_samples_are_listed(capsys):
    assert run(["samples"]) == 0
    out = capsys.readouterr().out
    assert "ridge" in out
    assert "1,025 × 1,025" in out


@pytest.mark.parametrize("command", ["demo", "render", "mesh", "report", "samples", "doctor"])
def test_help_names_every_command(capsys, command):
    assert run(["--help"]) == 0
    assert f" {command} " in capsys.readouterr().out
    assert run([command, "--help"]) == 0
    assert f"Usage: terrain-lod {command}" in capsys.readouterr().out


def test_doctors_verdict_is_the_exit_code(monkeypatch):
    monkeypatch.setattr("terrain_lod.cli.doctor.run_doctor", lambda: 1)
    assert run(["doctor"]) == 1


# what it refuses


def save_raster(kind):
    rng = np.random.default_rng(1)
    heights = np.ones((20, 20), np.float32)
    if kind == "missing.png":
        return
    if kind == "truncated.png":
        noise = rng.integers(0, 2**16, (200, 200), dtype=np.uint16)
        Image.fromarray(noise).save("in/whole.png")
        with open("in/whole.png", "rb") as whole, open("in/truncated.png", "wb") as part:
            part.write(whole.read()[:20_000])
    elif kind == "rgb.png":
        Image.fromarray(rng.integers(0, 255, (20, 20, 3), dtype=np.uint8)).save("in/rgb.png")
    elif kind == "empty.png":
        open("in/empty.png", "wb").close()
    elif kind == "one.npy":
        np.save("in/one.npy", heights[:1, :1])
    elif kind == "row.npy":
        np.save("in/row.npy", heights[:1])
    elif kind == "nan.npy":
        np.save("in/nan.npy", heights * np.nan)
    elif kind in ("inf.npy", "minus_inf.npy"):
        heights[3, 4] = np.inf if kind == "inf.npy" else -np.inf
        np.save(f"in/{kind}", heights)


COMMANDS = {
    "render": ["-o", "view.png"],
    "mesh": ["-o", "view.glb"],
    "report": ["-o", "folder"],
}


@needs_graphics
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("missing.png", "missing.png"),
        ("truncated.png", "truncated.png"),
        ("empty.png", "empty.png"),
        ("rgb.png", "terrain-RGB"),
        ("one.npy", "(1, 1)"),
        ("row.npy", "(1, 20)"),
        ("nan.npy", "no data"),
        ("inf.npy", "finite"),
        ("minus_inf.npy", "finite"),
        ("nowhere", "ridge"),
    ],
)
def test_bad_ground(ground, capsys, command, name, message):
    save_raster(name)
    path = f"in/{name}" if "." in name else name
    assert message in refused(capsys, command, path, *COMMANDS[command])


@needs_graphics
@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--spacing", "0"], "spacing > 0, got 0"),
        (["--spacing", "-5"], "spacing > 0, got -5"),
        (["--spacing", "nan"], "spacing"),
        (["--spacing", "1,2,3"], "expected DX[,DY]|map, got '1,2,3'"),
        (["--tile", "0"], "whole number from 1 to 63 for tile, got 0"),
        (["--tile", "64"], "whole number from 1 to 63 for tile, got 64"),
        (["--tile", "many"], '"many"'),
        (["--eye", "1,2,3", "--target", "1,2,3"], "away from its target"),
        (["--eye", "0,0,9", "--target", "0,0,0"], "parallel"),
        (["--eye", "0,9,0", "--target", "0,0,0", "--up", "0,1,0"], "parallel"),
        (["--eye", "1,2"], "expected X,Y,Z, got '1,2'"),
        (["--eye", "nan,2,3"], "finite eye"),
        (["--eye", "1e300,0,0"], "expected eye within 1e+30 of the origin, got (1e+300, 0.0, 0.0)"),
        (["--fov", "0"], "fov between 0 and 180"),
        (["--size", "0x10"], "size"),
        (["--near", "100", "--far", "100"], "far > near, got far 100 and near 100"),
        (["--near", "100", "--far", "50"], "far > near, got far 50 and near 100"),
        (["--maximum", "nan"], "maximum"),
        (["--edge-rule", "mean"], '"mean"'),
        (["--plane", "mean"], '"mean"'),
        (["--device", "abacus"], "unknown device 'abacus'"),
        (["--bogus"], "--bogus"),
        (["--camera", "none.json"], "none.json"),
        (["--camera", "in/hills.npy"], "hills.npy"),
    ],
)
def test_bad_option(ground, capsys, command, options, message):
    if "--far" in options and command != "report":
        options = ["--lod", "distance", *options]
    assert message in refused(capsys, command, ground, *COMMANDS[command], *options)


@needs_graphics
@pytest.mark.parametrize("command", ["render", "mesh"])
@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--lod", "uniform", "--factor", "nan"], "finite factor, got nan"),
        (["--lod", "uniform", "--factor", "0"], "factor from 1 to 63, got 0"),
        (["--lod", "uniform", "--tile", "64"], "for tile, got 64"),
        (["--lod", "uniform", "--near", "3"], "expected --lod"),
        (["--factor", "3"], "expected --lod uniform with --factor, got screen-error"),
        (["--falloff", "2"], "expected --lod distance with --falloff, got screen-error"),
        (["--lod", "max-error"], "expected --metres with --lod max-error, got none"),
        (["--lod", "max-error", "--metres", "0"], "metres > 0, got 0"),
        (["--pixels", "nan"], "finite pixels, got nan"),
        (["--lod", "budget", "--triangles", "1"], "budget of at least 2 triangles"),
        (["--lod", "magic"], "unknown level of detail 'magic': expected one of screen-error"),
    ],
)
def test_bad_detail(ground, capsys, command, options, message):
    assert message in refused(capsys, command, ground, *COMMANDS[command], *options)


@needs_graphics
@pytest.mark.parametrize(
    ("tokens", "message"),
    [
        (["render", "in/hills.npy", "-o", "view.jpg"], "ends in .png"),
        (["render", "in/hills.npy", "-o", "no/view.png"], "expected a folder"),
        (["render", "in/hills.npy", "-o", "in"], ".png"),
        (["render", "in/hills.npy", "-o", "view.png", "--style", "cubist"], '"cubist"'),
        (["render", "in/hills.npy", "-o", "view.png", "--size", "9000x10"], "at most 8192"),
        (["render", "in/hills.npy"], "--output"),
        (["render"], "GROUND"),
        (["mesh", "in/hills.npy", "-o", "view.doc"], ".glb"),
        (["mesh", "in/hills.npy", "-o", "no/view.glb"], "expected a folder"),
        (["report", "in/hills.npy", "-o", "in/hills.npy"], "cannot make the folder"),
        (["rendr", "in/hills.npy"], '"rendr"'),
        (["render", "ridge", "-o", "view.png", "--spacing", "3"], "the sample 'ridge'"),
    ],
)
def test_bad_output_and_bad_words(ground, capsys, tokens, message):
    assert message in refused(capsys, *tokens)


@needs_graphics
@pytest.mark.parametrize("command", ["render", "mesh"])
@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("in/none.npy", [], "in/none.npy"),
        ("in/bumps.npy", ["--spacing", "2.5"], "spacing divides the ground's, 2.5 x 2.5"),
        ("in/holed.npy", [], "expected detail with data everywhere, got 1 of 4 samples without"),
    ],
)
def test_bad_detail_map(ground, capsys, command, name, options, message):
    np.save("in/bumps.npy", np.ones((5, 5)))
    np.save("in/holed.npy", [[1, 2], [3, np.nan]])
    line = refused(capsys, command, ground, *COMMANDS[command], "--detail", name, *options)
    assert message in line


@needs_graphics
@pytest.mark.parametrize("command", COMMANDS)
def test_ground_larger_than_the_device(ground, capsys, command, monkeypatch):
    device = Device.open()
    info = replace(device.info, memory=device.allocated + 5_000, largest_buffer=5_000)
    monkeypatch.setattr(device, "info", info)
    message = refused(capsys, command, ground, *COMMANDS[command])
    assert "(18544 bytes)" in message or "(18545 bytes)" in message
    assert "5000 bytes" in message


@pytest.mark.parametrize(
    "content", ["[1, 2]", '{"eye": [0, 0, 9]}', '{"eye": 3, "target": [0, 0, 0]}', "{"]
)
def test_bad_camera_file(ground, capsys, content):
    with open("in/camera.json", "w") as file:
        file.write(content)
    refused(capsys, "mesh", ground, "-o", "view.glb", "--camera", "in/camera.json")


def test_no_graphics_is_refused_before_the_work(ground, capsys, monkeypatch):
    monkeypatch.setattr(
        "terrain_lod.drawing.graphics.graphics_problem", lambda: f"run {INSTALL_COMMAND}"
    )
    assert INSTALL_COMMAND in refused(capsys, "render", ground, "-o", "view.png")


def test_interrupt(capsys, monkeypatch):
    def interrupt():
        raise KeyboardInterrupt

    monkeypatch.setattr("terrain_lod.cli.doctor.run_doctor", interrupt)
    assert run(["doctor"]) == INTERRUPTED
    assert capsys.readouterr().err == "terrain-lod: interrupted\n"


# the program itself


def terrain_lod(*tokens, **environment):
    return subprocess.run(
        [sys.executable, "-m", "terrain_lod", *tokens],
        capture_output=True,
        text=True,
        env=os.environ | environment,
        timeout=120,
    )


def test_program_answers_and_refuses():
    version = terrain_lod("--version")
    assert version.returncode == 0
    assert version.stdout.count(".") == 2
    wrong = terrain_lod("mesh", "nowhere.png", "-o", "view.glb")
    assert wrong.returncode == REFUSED
    assert wrong.stdout == ""
    assert wrong.stderr.count("\n") == 1
    assert files() == []


def test_help_loads_nothing_heavy():
    """What takes long to import, and help does not need."""
    code = "import sys; from terrain_lod.cli.app import run; run(['render', '--help']); "
    heavy = ("pyvista", "vtkmodules", "matplotlib", "scipy", "skimage", "rasterio")
    child = subprocess.run(
        [sys.executable, "-c", f"{code} print([name for name in {heavy} if name in sys.modules])"],
        capture_output=True,
        text=True,
    )
    assert child.stdout.splitlines()[-1] == "[]"


@pytest.mark.skipif(sys.platform != "linux", reason="breaks the driver as glvnd lets one")
@pytest.mark.slow
def test_program_without_opengl_does_all_but_pictures(ground):
    broken = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent", "DISPLAY": ""}
    picture = terrain_lod("render", ground, "-o", "view.png", **broken)
    assert picture.returncode == REFUSED
    assert INSTALL_COMMAND in picture.stderr
    assert files() == []
    demo = terrain_lod("demo", ground, "-o", "demo", **broken)
    assert demo.returncode == 0, demo.stderr
    assert INSTALL_COMMAND in demo.stderr
    assert {"hills.glb", "maps.svg", "report.html", "report.json", "report.csv"} == set(
        os.listdir("demo")
    )
    with open("demo/report.json") as file:
        assert json.load(file)["difference"] is None


def test_reader_that_leaves_early_is_no_error():
    command = f"{shlex.quote(sys.executable)} -m terrain_lod samples | head -n 1"
    child = subprocess.run(command, shell=True, capture_output=True, text=True, timeout=120)
    assert child.stderr == ""


def test_every_command_is_in_the_modules_docstring():
    for name in [
        "demo",
        "render",
        "mesh",
        "report",
        "view",
        "smooth",
        "pattern",
        "samples",
        "doctor",
    ]:
        assert name in (cli.__doc__ or "").split("Exit codes")[0]
