"""Speed against error: peers in our world, numbers that are true, files that diff cleanly."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import holed, rough
from terrain_lod.cli.app import run
from terrain_lod.reports.compare.compare import compare
from terrain_lod.reports.compare.peers import PEERS, Peer, uniform_grid
from terrain_lod.reports.compare.sweep import (
    Contender,
    contenders,
    installed,
    tolerances,
)
from terrain_lod.reports.compare.trials import Course, Result
from terrain_lod.reports.compare.verdict import findings

# the arrays here do not say their spacing, which is then 1
pytestmark = pytest.mark.filterwarnings("ignore:.*how far apart its samples are")

COMPARE = "terrain_lod.reports.compare.compare"
GROUND = rough(60, 50, spacing=(30.0, 20.0), origin=(500_000, 4_000_000))
MIDDLE = {"m": 20.0, "samples": 4.0, "share": 0.3}


@pytest.fixture(scope="module")
def course() -> Course:
    return Course(GROUND, 2, tl.Device.open())


@pytest.fixture(scope="module")
def promised(course: Course) -> Result:
    return course.measure(Contender("MaxErrorLod", 5.0, "m", tl.MaxErrorLod(5.0), tile=4))


@pytest.mark.parametrize("peer", PEERS, ids=lambda peer: peer.name)
def test_a_peer_lies_on_the_ground(peer: Peer) -> None:
    if not peer.is_installed:
        pytest.skip(f"{peer.name} is not installed")
    mesh = peer.mesh(GROUND, MIDDLE[peer.asks])
    found = tl.vertical_error(mesh, GROUND)
    low, high = GROUND.height_range
    # a flipped axis would be off by as much as the ground is high
    assert found.maximum < 0.5 * (high - low)
    assert found.rms < 0.1 * (high - low)
    assert found.uncovered < 0.1 * GROUND.heights.size
    assert len(mesh.triangles) < 2 * 59 * 49
    if peer.name == "pydelatin":
        assert found.maximum <= MIDDLE["m"] * (1 + 1e-6)


def test_a_peer_is_given_ground_without_holes() -> None:
    ground = holed(60, 50)
    mesh = PEERS[0].mesh(ground, 1)
    assert np.isfinite(mesh.vertices).all()
    assert tl.vertical_error(mesh, ground).maximum == 0


def test_uniform_grid_of_every_sample_is_exact() -> None:
    points, triangles = uniform_grid(GROUND.heights, 1)
    assert len(points) == GROUND.heights.size
    assert len(triangles) == 2 * 59 * 49
    points, triangles = uniform_grid(np.zeros((4, 5), np.float32), 3)
    assert points[:, :2].tolist() == [[0, 0], [3, 0], [4, 0], [0, 3], [3, 3], [4, 3]]
    assert triangles.tolist() == [[0, 3, 1], [1, 3, 4], [1, 4, 2], [2, 4, 5]]


def test_tolerances_have_one_digit_and_follow_the_relief() -> None:
    assert tolerances(tl.Heightmap(np.array([[0, 1000], [0, 0.0]]))) == (0.5, 2.0, 8.0, 30.0)
    assert tolerances(tl.Heightmap(np.zeros((2, 2)))) == (0.001,)


def test_every_rule_and_every_lod_is_tried() -> None:
    tried = contenders(GROUND, 15)
    ours = {each.family for each in tried if each.peer is None}
    assert ours == {
        *("UniformLod", "DistanceLod", "CoplanarityLod", "ScreenAreaLod"),
        "BookCoplanarityLod",
        *("MaxErrorLod", "ScreenErrorLod", "BudgetLod", "Weighted"),
    }
    promises = [each for each in tried if each.family == "ScreenErrorLod"]
    assert {each.edge_rule for each in promises} == {""}
    formulas = [each for each in tried if each.family == "DistanceLod"]
    assert {each.edge_rule for each in formulas} == {"min", "max"}
    assert {each.family for each in tried} - ours == {peer.name for peer in installed()[0]}


def test_numbers_are_those_of_the_public_measures(course: Course, promised: Result) -> None:
    mesh = tl.Terrain(GROUND).mesh(lod=tl.MaxErrorLod(5.0))
    found = tl.vertical_error(mesh, GROUND)
    assert promised.triangles == len(mesh.triangles)
    assert promised.metres == found.maximum
    assert promised.metres_rms == pytest.approx(found.rms)
    seen = [tl.screen_error(mesh, GROUND, camera) for camera in course.cameras]
    assert promised.pixels == max(each.maximum for each in seen)
    assert promised.pop == 0
    assert promised.broken is None
    assert promised.times.whole_low <= promised.times.whole <= promised.times.whole_high


def test_pops_are_those_of_the_public_measure(course: Course) -> None:
    lod = tl.DistanceLod()
    made = course.measure(
        Contender("DistanceLod", 15.0, "segments", lod, None, "min", "integer", 15)
    )
    terrain = tl.Terrain(GROUND, levels=1)
    pops = [
        tl.pop_metric(
            [terrain.mesh(camera, lod=lod, partitioning="integer") for camera in pair], GROUND, pair
        ).maximum
        for pair in course.pairs
    ]
    assert made.pop == max(pops)
    assert made.pop > 0


def test_a_broken_promise_is_told(promised: Result) -> None:
    assert "in every case tried: Max error" in " ".join(findings([promised], [], []))
    assert replace(promised, metres=5.000001).broken  # nothing is forgiven
    broken = replace(promised, metres=7.0)
    assert broken.broken == pytest.approx(1.4)
    text = " ".join(findings([broken], [], []))
    assert "Max error broke its own target in 1 of 1 cases: asked for 5 m, it is off by 7" in text


def test_a_better_peer_is_not_hidden(promised: Result) -> None:
    peer = next(peer for peer in PEERS if peer.name == "pydelatin")
    assert promised.metres <= 5.0
    theirs = replace(
        promised,
        contender=Contender("pydelatin", 5.0, "m", peer=peer),
        triangles=promised.triangles // 4,
        pixels=0.5,
    )
    assert replace(theirs, metres=5.0001).broken is None  # rounding
    assert replace(theirs, metres=5.1).broken
    text = " ".join(findings([promised, theirs], [], []))
    times = promised.triangles / theirs.triangles
    assert f"{promised.triangles:,} against {theirs.triangles:,}, {times:.3g} times" in text
    assert "it is the better choice" in text


@pytest.mark.slow
def test_report_is_the_same_every_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # fewer settings: each is as good as another here
    sweep = [each for each in contenders(GROUND, 15) if each.parameter in (1.0, 2.0, 15.0)]
    monkeypatch.setattr(f"{COMPARE}.contenders", lambda ground, tile: sweep)
    monkeypatch.setattr(f"{COMPARE}.graphics_problem", lambda: "no pictures here")
    steps: list[tuple[int, int]] = []
    first, second = (
        compare(
            GROUND, tmp_path / name, views=2, progress=lambda done, all_: steps.append((done, all_))
        )
        for name in ("first", "second")
    )
    for key in ("csv", "json", "triangles"):
        assert first.files[key].read_bytes() == second.files[key].read_bytes()
    assert steps[-1][0] == steps[-1][1]
    with first.files["csv"].open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert len(lines) == len(first.results)
    assert [float(line["metres"]) for line in lines] == [each.metres for each in first.results]
    content = json.loads(first.files["json"].read_text("utf-8"))
    assert len(content["sweep"]) == len(sweep)
    assert content["findings"] == first.findings
    page = first.files["html"].read_text("utf-8")
    assert page.count("data:image/svg+xml") == 2
    assert "http" not in page.replace("http://www.w3.org", "")
    for sentence in first.findings:
        assert sentence.split(":")[0] in page


@pytest.mark.parametrize("views", [0, 1.5, 101])
def test_wrong_views(tmp_path: Path, views: float) -> None:
    with pytest.raises(tl.InputError, match="views"):
        compare(GROUND, tmp_path, views=views)


@pytest.mark.parametrize(
    ("tokens", "message"),
    [
        (["ridge", "--compare", "--stability"], "expected --compare or --stability, got both"),
        ([], "expected GROUND"),
        (["ridge", "--compare", "--views", "0"], "views"),
    ],
)
def test_command_refuses(
    tokens: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["report", *tokens, "-o", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


@pytest.mark.slow
def test_command_compares(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    sweep = [each for each in contenders(GROUND, 15) if each.parameter == 1.0]
    monkeypatch.setattr(f"{COMPARE}.contenders", lambda ground, tile: sweep)
    np.save(tmp_path / "hills.npy", GROUND.heights)
    out = tmp_path / "out"
    tokens = ["report", str(tmp_path / "hills.npy"), "--compare", "--views", "1", "-o", str(out)]
    assert run(tokens) == 0
    assert {"compare.html", "compare.json", "compare.csv", "times.csv"} <= {
        path.name for path in out.iterdir()
    }
    assert "Error asked for is error measured" in capsys.readouterr().out
