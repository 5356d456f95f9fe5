"""The commands of pyramids: build, info, and those that open one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from support.pyramids import contents, rugged
from terrain_lod.cli.app import run

pytest.importorskip("zarr")


@pytest.fixture
def source(tmp_path: Path) -> Path:
    np.save(tmp_path / "hills.npy", rugged(100, 140) * 10)
    return tmp_path / "hills.npy"


def test_two_commands_from_a_raster_to_a_mesh(
    tmp_path: Path, source: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    store = tmp_path / "hills.tlod"
    assert run(["build", str(source), str(store), "--chunk", "32", "--spacing", "30"]) == 0
    assert "each worker takes at most 0.25 GB" in capsys.readouterr().out
    out = tmp_path / "hills.glb"
    assert run(["mesh", str(store), "-o", str(out), "--memory", "50MB"]) == 0
    said = capsys.readouterr().out
    assert "within 0.9" in said
    assert "watertight" in said
    assert out.stat().st_size > 1000


def test_processes_make_the_same_store(tmp_path: Path, source: Path) -> None:
    for name, more in (("one", []), ("two", ["--workers", "2"])):
        command = ["build", str(source), str(tmp_path / name), "--chunk", "16", "--spacing", "1"]
        assert run([*command, *more]) == 0
    assert contents(tmp_path / "one") == contents(tmp_path / "two")


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (["build", "{source}", "{folder}/a.tlod", "--workers", "0"], "at least 1 worker"),
        (["build", "{source}", "{folder}/none/a.tlod"], "expected a folder to make a.tlod in"),
        (["build", "{folder}/none.tif", "{folder}/a.tlod"], "got nothing at"),
        (["build", "{source}", "{folder}/a.tlod", "--chunk", "100"], "power of two"),
        (
            ["build", "{source}", "{folder}/a.tlod", "--workers", "2", "--scheduler", "x:1"],
            "expected --workers or --scheduler, got both",
        ),
        (["info", "{folder}"], "expected a store that terrain-lod build wrote"),
    ],
)
def test_what_is_wrong_is_one_line(
    tmp_path: Path,
    source: Path,
    command: list[str],
    said: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    tokens = [token.format(source=source, folder=tmp_path) for token in command]
    assert run(tokens) == 2
    lines = capsys.readouterr().err.splitlines()
    assert said in lines[-1]
    assert not (tmp_path / "a.tlod").exists()
