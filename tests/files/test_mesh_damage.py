"""Whatever bytes a mesh file has, the outcome is a sound mesh or a documented error."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[1] / "support" / "mesh_damage.py"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="no alarm there")
@pytest.mark.parametrize(
    ("count", "endings"),
    [(1000, []), (4, [".vtp", ".vtk", ".vtu", ".msh"])],
    ids=["readers of ours", "readers in a child"],
)
def test_damaged_files(tmp_path, count: int, endings: list[str]) -> None:
    # in a child process: what kills it is a failure of this test alone
    command = [sys.executable, str(SCRIPT), str(tmp_path), "20261128", str(count), *endings]
    child = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert child.returncode == 0, child.stdout + child.stderr
    *wrong, counts = child.stdout.splitlines()
    assert wrong == []
    found = json.loads(counts)
    assert found.keys() <= {"mesh", "refused"}
    assert sum(found.values()) == count
    if not endings:
        # damage that nothing notices, or that nothing survives, would try little
        assert min(found.values()) > count / 10
