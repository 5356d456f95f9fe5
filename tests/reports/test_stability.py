"""Every kernel on hard ground and for hard cameras keeps the bound that the report states."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from terrain_lod.reports.stability.cases import cameras, grounds, rough_ground
from terrain_lod.reports.stability.checks import (
    BOUNDS,
    OnGround,
    camera_findings,
    finding,
)
from terrain_lod.reports.stability.stability import verdict, write_stability

pytestmark = pytest.mark.filterwarnings("ignore::RuntimeWarning:terrain_lod.reference")


@pytest.mark.parametrize("name", grounds())
def test_ground(name: str) -> None:
    found = list(OnGround(name, grounds()[name], tl.Device.open()).findings())
    assert {each.quantity for each in found} == BOUNDS.keys() - {"factors", "allowed error"}
    assert [each for each in found if not each.is_met] == []


@pytest.mark.parametrize("name", cameras(rough_ground()))
def test_camera(name: str) -> None:
    ground = rough_ground()
    camera = cameras(ground)[name]
    found = list(camera_findings(name, ground, camera, tl.Device.open()))
    assert [each for each in found if not each.is_met] == []
    mesh = tl.Terrain(ground).mesh(camera, lod=tl.ScreenErrorLod(1.0))
    assert np.isfinite(mesh.vertices).all()
    assert np.isfinite(mesh.normals).all()
    assert not tl.screen_error(mesh, ground, camera).maximum > 1.0


def test_a_difference_is_found() -> None:
    # the tests above mean something only if they can fail
    expected = np.array([1.0, 2.0, np.nan])
    off = finding("", "deviation", expected + np.array([0, 1e-3, 0]), expected, 2.0, 1e-4)
    assert not off.is_met
    assert off.share == pytest.approx(10)
    assert off.relative == pytest.approx(5e-4)
    for wrong in (np.nan, np.inf):
        found = finding("", "deviation", np.array([wrong]), np.array([1.0]), 1.0, 1e9)
        assert not found.is_met
        assert found.error == np.inf
    assert not finding("", "deviation", np.zeros(1), np.array([np.nan]), 1.0, 1e9).is_met
    assert finding("", "deviation", expected, expected, 0.0, 0.0).is_met


def test_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    few = {name: grounds()[name] for name in ("one spike", "2 × 2 samples")}
    monkeypatch.setattr("terrain_lod.reports.stability.stability.grounds", lambda: few)
    steps: list[tuple[int, int]] = []
    made = write_stability(tmp_path, progress=lambda done, total: steps.append((done, total)))
    assert steps[-1] == (len(few) + len(cameras(rough_ground())),) * 2
    assert made.verdict == verdict(made.findings)
    assert made.verdict.startswith("All ")
    content = json.loads(made.files["json"].read_text("utf-8"))
    assert content["bounds"] == BOUNDS
    assert all(each["met"] for each in content["findings"])
    page = made.files["html"].read_text("utf-8")
    assert "one spike" in page
    assert "$" not in page
    lines = made.files["csv"].read_text("utf-8").splitlines()
    assert len(lines) == 1 + len(made.findings)
    before = {key: path.read_bytes() for key, path in made.files.items()}
    again = write_stability(tmp_path)
    assert {key: path.read_bytes() for key, path in again.files.items()} == before


def test_a_bound_that_is_not_met_is_named() -> None:
    expected = np.ones(3)
    broken = finding("one spike", "deviation", expected + 1, expected, 1.0, 0.1)
    assert verdict([broken]) == ("1 of 1 bounds are not met, in 1 cases: deviation in one spike.")
