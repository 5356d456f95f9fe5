"""Every benchmark starts, says what it does, and stands in the list."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
# what the others share
SHARED = {"character.py", "measure.py", "rings.py"}
# of packages that are no part of the extra `test`
PEERS = ("pydelatin", "quantized_mesh_encoder")
COMMANDS = sorted(path for path in BENCHMARKS.glob("*.py") if path.name not in SHARED)


@pytest.mark.parametrize("path", COMMANDS, ids=lambda path: path.name)
def test_it_starts_and_says_what_it_does(
    path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", [str(path), "--help"])
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    try:
        with pytest.raises(SystemExit) as left:
            runpy.run_path(str(path), run_name="__main__")
    except ModuleNotFoundError as missing:
        if missing.name not in PEERS:
            raise
        pytest.skip(f"needs {missing.name}")
    assert not left.value.code
    assert "usage:" in capsys.readouterr().out
    assert f"`python benchmarks/{path.name}" in (BENCHMARKS / "README.md").read_text()
