"""Every example runs as it stands, in an empty folder, and makes what it says."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from terrain_lod.drawing.graphics import graphics_problem

EXAMPLES = sorted((Path(__file__).parent.parent / "examples").glob("*.py"))

ARGUMENTS = {"render_flyover": ["flight", "--frames", "2", "--size", "320", "160"]}


@pytest.mark.slow
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example(example: Path, tmp_path: Path) -> None:
    if "render" in example.read_text(encoding="utf-8") and graphics_problem():
        pytest.skip(f"3-D pictures cannot be drawn here: {graphics_problem()}")
    command = [sys.executable, "-W", "error", str(example), *ARGUMENTS.get(example.stem, ())]
    ran = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    assert ran.stdout
    assert 10 <= len(example.read_text(encoding="utf-8").splitlines()) <= 70


def test_the_guide_to_formulas_shows_what_the_examples_run() -> None:
    guide = (EXAMPLES[0].parents[1] / "docs" / "own_lod.md").read_text(encoding="utf-8")
    for name in ("slope.h", "upright.h", "egg.h"):
        assert f"```c\n{(EXAMPLES[0].parent / name).read_text(encoding='utf-8')}```" in guide
    example = (EXAMPLES[0].parent / "own_lod.py").read_text(encoding="utf-8")
    for begin in ("@dataclass(frozen=True)\nclass SlopeLod", "def slope("):
        code = example[example.index(begin) :].split("\n\n\n")[0]
        assert f"```python\n{code}\n```" in guide
