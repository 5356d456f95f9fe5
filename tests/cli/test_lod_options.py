"""Levels of detail on the command line: weights, partitionings, and classes of the user's own."""

from __future__ import annotations

import json
import os
from inspect import signature
from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.own_formulas import SLOPE, write_formulas
from terrain_lod.cli.app import REFUSED, run
from terrain_lod.cli.lod_options import LodOptions
from terrain_lod.drawing.graphics import graphics_problem
from terrain_lod.terrain.lods import LODS

needs_graphics = pytest.mark.skipif(
    graphics_problem() is not None, reason=f"no 3-D pictures tested: {graphics_problem()}"
)
pytestmark = pytest.mark.filterwarnings("ignore:.*how far apart its samples are")
SMALL = ["--size", "96x64"]


@pytest.fixture(autouse=True)
def _work_in_a_folder_with_ground_and_formulas(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    x, y = np.meshgrid(np.linspace(0, 6, 76), np.linspace(0, 5, 61))
    np.save("hills.npy", (50 * np.sin(x) * np.cos(y)).astype(np.float32))
    write_formulas(tmp_path / "in")


def made(capsys: pytest.CaptureFixture[str], *options: str) -> int:
    """Run ``mesh`` and return how many triangles it made."""
    assert run(["mesh", "hills.npy", "-o", "hills.ply", *options]) == 0
    return int(capsys.readouterr().out.split(": ")[1].split()[0].replace(",", ""))


def test_every_level_of_detail_and_every_partitioning(capsys) -> None:
    needed = {"max-error": ["--metres", "1"], "budget": ["--triangles", "4000"]}
    for name in LODS:
        assert made(capsys, "--lod", name, *needed.get(name, [])) > 0
    counts = [
        made(capsys, "--lod", "uniform", "--factor", "5.5", "--partitioning", each)
        for each in ("fractional_odd", "fractional_even", "integer", "pow2")
    ]
    assert len(set(counts)) >= 3
    assert made(capsys, "--lod", "area", "--pixels", "99") < made(capsys, "--lod", "area")


def test_fitted_heights(capsys) -> None:
    promise = ["--lod", "max-error", "--metres", "1", "--tile", "4"]
    assert made(capsys, *promise, "--heights", "fitted") < 0.8 * made(capsys, *promise)
    wanted = ["mesh", "hills.npy", "-o", "none.ply", "--heights", "fitted"]
    for options, what in (
        (["--lod", "uniform", "--partitioning", "integer"], "UniformLod"),
        (["--lod", "screen-error", "--partitioning", "pow2"], "pow2"),
    ):
        assert run([*wanted, *options]) == REFUSED
        assert what in capsys.readouterr().err
    assert not Path("none.ply").exists()


def test_weights_weigh_what_was_asked_for(capsys) -> None:
    terrain = tl.Terrain(tl.load("hills.npy"), levels=1)
    camera = tl.default_camera(terrain.ground)
    lod = tl.Weighted(tl.DistanceLod(), horizon=1.0, silhouette=6.0)
    expected = len(terrain.mesh(camera, lod=lod, cull=False).triangles)
    assert made(capsys, "--lod", "distance", "--silhouette", "6") == expected
    assert made(capsys, "--lod", "distance") < expected


def test_own_class_in_mesh(capsys) -> None:
    few = made(capsys, "--lod", "in/mine.py:SlopeLod", "--segments", "2")
    assert few < made(capsys, "--lod=in/mine.py:SlopeLod")
    assert made(capsys, "--lod", "in/mine.py:SlopeLod", "--horizon", "3", "--segments", "2") > few
    # it is forgotten afterwards
    assert not [name for name in LODS if ":" in name]
    assert "segments" not in signature(LodOptions).parameters


def test_own_options_stand_in_the_help(capsys, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "300")
    assert run(["mesh", "--lod", "in/mine.py:SlopeLod", "--help"]) == 0
    out = " ".join(capsys.readouterr().out.replace("│", "").split())
    assert "--segments FLOAT" in out
    assert "in/mine.py:SlopeLod: the steeper, the more." in out
    assert run(["mesh", "--help"]) == 0
    assert "--segments" not in capsys.readouterr().out


def test_own_class_from_the_environment(capsys, monkeypatch) -> None:
    monkeypatch.setenv("TERRAIN_LOD_MESH_LOD", "in/mine.py:SlopeLod")
    named = made(capsys)
    monkeypatch.delenv("TERRAIN_LOD_MESH_LOD")
    assert named == made(capsys, "--lod", "in/mine.py:SlopeLod")


@needs_graphics
def test_own_class_in_render_and_beside_another(capsys) -> None:
    own = "in/mine.py:SlopeLod"
    assert run(["render", "hills.npy", "-o", "a.png", "--lod", own, "--segments", "3", *SMALL]) == 0
    path = ["--orbit", "--frames", "1", "--beside", own, "--segments", "3", "--falloff", "2"]
    assert run(["render", "hills.npy", "-o", "way", "--lod", "distance", *path, *SMALL]) == 0
    notes = next(path for path in Path("way").iterdir() if path.suffix == ".json")
    lods = json.loads(notes.read_text())["lods"]
    assert "falloff=2.0" in lods[0]
    assert lods[1] == "SlopeLod(segments=3.0)"


@pytest.mark.slow
def test_own_class_in_report(capsys) -> None:
    own = ["--lod", "in/mine.py:SlopeLod", "--segments", "3", "--falloff", "2"]
    options = ["--partitioning", "integer", *SMALL]
    assert run(["report", "hills.npy", "-o", "out", *own, *options]) == 0
    content = json.loads(Path("out/report.json").read_text())
    assert content["as_asked_for"] == ["distance", "Slope", "screen-error"]
    assert content["trials"]["Slope"]["parameters"] == {"segments": 3.0}
    assert content["trials"]["distance"]["parameters"]["falloff"] == 2.0
    assert content["partitioning"] == "integer"
    assert "Slope LOD" in capsys.readouterr().out


def test_a_promise_and_weights_in_report(capsys) -> None:
    options = ["--lod", "screen-error", "--pixels", "2", "--horizon", "3", *SMALL]
    assert run(["report", "hills.npy", "-o", "out", *options]) == 0
    content = json.loads(Path("out/report.json").read_text())
    trial = content["trials"]["weighted-screen-error"]
    assert trial["parameters"] == {"pixels": 2.0, "horizon": 3.0, "silhouette": 1.0}
    assert "weighted-screen-error LOD draws" in capsys.readouterr().out


def test_own_class_in_the_comparison(monkeypatch) -> None:
    tried: list[str] = []

    def stop(course, contenders, step):
        tried.extend(each.family for each in contenders)
        raise tl.InputError("seen enough")

    monkeypatch.setattr("terrain_lod.reports.compare.compare.run", stop)
    own = ["--compare", "--lod", "in/mine.py:SlopeLod"]
    assert run(["report", "hills.npy", "-o", "out", *own]) == REFUSED
    assert "SlopeLod" in tried


@needs_graphics
@pytest.mark.parametrize(
    "options",
    [
        ["--lod", "in/mine.py:SlopeLod", "--segments", "3"],
        ["--lod", "area", "--pixels", "4", "--partitioning", "pow2", "--horizon", "2"],
        ["--lod", "book-coplanarity", "--full-deviation", "3"],  # which has no slider
    ],
    ids=["own", "area", "book"],
)
def test_view_begins_with_what_was_asked_for(capsys, options) -> None:
    command = ["view", "hills.npy", "--off-screen", "-o", "view.png", *SMALL, *options]
    assert run(command) == 0
    out = capsys.readouterr().out
    assert out.startswith(options[1])
    assert ("pow2" if "pow2" in options else "integer") in out


def test_own_formula_for_edges_in_smooth(capsys) -> None:
    run(["mesh", "hills.npy", "-o", "hills.ply", "--lod", "uniform", "--factor", "2"])
    capsys.readouterr()
    counts = []
    for most in ("2", "12"):
        own = ["--lod", "in/mine.py:TiltFactor", "--most", most]
        assert run(["smooth", "hills.ply", "-o", "smooth.ply", *own]) == 0
        counts.append(int(capsys.readouterr().out.split(": ")[1].split()[0].replace(",", "")))
    assert counts[0] < counts[1]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--lod", "in/none.py:SlopeLod"], "expected a Python file in in/none.py:SlopeLod"),
        (["--lod", "in/mine.py:Nothing"], "(SlopeLod, TiltFactor), got 'Nothing'"),
        (["--lod", "in/mine.py:SlopeLo"], "(SlopeLod, TiltFactor), got 'SlopeLo'"),
        (["--lod", "in/mine.py:TiltFactor"], "unknown level of detail 'in/mine.py:TiltFactor'"),
        (["--lod", "in/mine.py:SlopeLod", "--segments", "63"], "segments from 1 to 62, got 63"),
        (["--lod", "in/mine.py:SlopeLod", "--metres", "3"], "expected --lod max-error or budget"),
        (["--lod", "distance", "--segments", "3"], "--segments"),
        (["--lod", "in/broken.py:SlopeLod"], "SyntaxError"),
        (["--lod", "in/raises.py:SlopeLod"], "ZeroDivisionError: division by zero"),
        (["--lod", "in/plain.py:PlainLod"], "expected @dataclass(frozen=True) above class Plain"),
        (["--lod", "in/lost.py:LostLod"], "expected a header at"),
        (["--lod", "in/taken.py:TakenLod"], "a number of another name, tile is taken"),
    ],
)
def test_bad_classes_are_refused_in_one_line(capsys, options, message) -> None:
    Path("in/broken.py").write_text("class SlopeLod(\n")
    Path("in/raises.py").write_text("1 / 0\n")
    Path("in/plain.py").write_text("import terrain_lod as tl\nclass PlainLod(tl.Lod): pass\n")
    Path("in/lost.py").write_text(
        "from dataclasses import dataclass\nfrom pathlib import Path\nimport terrain_lod as tl\n"
        "@dataclass(frozen=True)\nclass LostLod(tl.Lod):\n    header = Path('in/lost.h')\n"
    )
    Path("in/taken.py").write_text(
        "from dataclasses import dataclass\nimport terrain_lod as tl\n"
        "@dataclass(frozen=True)\nclass TakenLod(tl.Lod):\n    tile: float = 3.0\n"
    )
    assert run(["mesh", "hills.npy", "-o", "hills.ply", *options]) == REFUSED
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1
    assert not os.path.exists("hills.ply")


def test_an_error_of_the_compiler_names_the_users_line(capsys) -> None:
    Path("in/slope.h").write_text(SLOPE.replace("fmin(", "fmn("))
    assert run(["mesh", "hills.npy", "-o", "hills.ply", "--lod", "in/mine.py:SlopeLod"]) == REFUSED
    assert f"{Path('in/slope.h').resolve().as_posix()}:9:" in capsys.readouterr().err
