"""The report of the hard cases: every case is in it with its bound, and what is broken named."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from terrain_lod.checks.check import Bound, Check
from terrain_lod.checks.table import CHECKS
from terrain_lod.reports import stability
from terrain_lod.reports.stability import Finding, verdict, write_stability

METRES = Bound("height", "m", "a tenth of a metre", "for tests")
FEW = ("terrain/control_points", "common/scan", "curved/decals")


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> dict[str, Check]:
    """The checks of some kernels, which take no time."""
    checks = {kernel: CHECKS[kernel] for kernel in FEW}
    monkeypatch.setattr(stability, "CHECKS", checks)
    return checks


@pytest.mark.slow
def test_report(tmp_path: Path, few: dict[str, Check]) -> None:
    steps: list[tuple[int, int]] = []
    made = write_stability(tmp_path, progress=lambda done, total: steps.append((done, total)))
    assert steps[-1] == (sum(len(check.cases) for check in few.values()),) * 2
    assert {(each.kernel, each.case) for each in made.findings} == {
        (kernel, case) for kernel, check in few.items() for case in check.cases
    }
    assert made.verdict == verdict(made.findings)
    assert made.verdict.startswith("All ")
    content = json.loads(made.files["json"].read_text("utf-8"))
    assert content["bounds"].keys() == {each.bound.quantity for each in made.findings}
    assert all(each["met"] for each in content["findings"])
    page = made.files["html"].read_text("utf-8")
    for text in ("one spike", "control points", "1 ulp of the largest coordinate", "100003 counts"):
        assert text in page
    assert "$" not in page
    lines = made.files["csv"].read_text("utf-8").splitlines()
    assert len(lines) == 1 + len(made.findings)
    before = {key: path.read_bytes() for key, path in made.files.items()}
    again = write_stability(tmp_path)
    assert {key: path.read_bytes() for key, path in again.files.items()} == before


def test_a_number_near_zero_is_in_metres_beside_its_bound(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # of a value of 1e-15 m, so much is any number of units in its last place
    near_zero = METRES.met_by([3e-14], [1e-15], 1e-13)
    worse = METRES.met_by([0.3, np.nan], [0.1, 0.1], 0.1)
    monkeypatch.setattr(
        stability,
        "CHECKS",
        {
            "curved/one": Check(lambda case, device: [near_zero], lambda: {"flat": None}),
            "terrain/two": Check(
                lambda case, device: [worse if case else near_zero],
                lambda: {"flat": False, "steep": True},
            ),
        },
    )
    made = write_stability(tmp_path)
    page = made.files["html"].read_text("utf-8")
    assert ">2.9e-14 m</td>" in page
    assert ">1e-13 m</td>" in page
    assert ">29%</td>" in page
    assert "<b>any ×</b>" in page
    found = json.loads(made.files["json"].read_text("utf-8"))["findings"]
    assert [each["difference"] for each in found] == [pytest.approx(2.9e-14)] * 2 + [None]
    assert made.verdict == ("1 of 3 bounds are not met, in 2 cases: height (terrain/two) in steep.")


def test_the_quantity_nearest_to_its_bound_counts() -> None:
    small, large = (METRES.met_by([each], [0.0], 1.0) for each in (0.2, 0.7))
    check = Check(lambda case, device: [small, large, small], lambda: {"one": None})
    found = list(stability.findings(None, {"terrain/kernel": check}))
    assert found == [Finding("terrain/kernel", "one", large)]
