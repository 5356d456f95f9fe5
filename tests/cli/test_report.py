"""``terrain-lod report``: what does not apply is refused in one line, and nothing is written."""

from __future__ import annotations

from pathlib import Path

import pytest

from terrain_lod.cli.app import REFUSED, run

# an option of each group that only two levels of detail at one camera have
PAIR_ALONE = {
    "--edge-rule": "max",
    "--camera": "none.json",
    "--eye": "1,2,3",
    "--size": "64x48",
    "--near": "5",
    "--falloff": "2",
    "--plane": "corners",
}
RASTER = {"--spacing": "2", "--height-range": "0,9", "--nodata": "7"}


def refused(tmp_path: Path, capsys: pytest.CaptureFixture[str], *tokens: str) -> str:
    folder = tmp_path / "out"
    assert run(["report", *tokens, "-o", str(folder)]) == REFUSED
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.count("\n") == 1
    assert not folder.exists()
    return printed.err


@pytest.mark.parametrize("option", PAIR_ALONE)
def test_compare_refuses_what_is_of_the_pair_alone(
    option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    said = refused(tmp_path, capsys, "ridge", "--compare", option, PAIR_ALONE[option])
    assert f"expected no {option} with --compare, got" in said


@pytest.mark.parametrize("option", [*PAIR_ALONE, *RASTER, "--views", "--tile"])
def test_stability_refuses_all_but_the_device(
    option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    value = (PAIR_ALONE | RASTER).get(option, "7")
    said = refused(tmp_path, capsys, "--stability", option, value)
    assert f"expected no {option} with --stability, got" in said


@pytest.mark.parametrize(
    ("tokens", "message"),
    [
        (["none.tif", "--stability"], "expected no GROUND with --stability, got 'none.tif'"),
        (["ridge", "--views", "3"], "expected --compare with --views, got --views 3 alone"),
        (["none.tif", "--compare"], "none.tif"),
        (["--compare"], "expected GROUND"),
    ],
)
def test_ground_and_views_are_refused_where_they_mean_nothing(
    tokens: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert message in refused(tmp_path, capsys, *tokens)
