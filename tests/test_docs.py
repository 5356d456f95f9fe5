"""What the pages say is so: their Python runs and prints what stands beside it, their commands
parse, their links lead somewhere, and the reference has every public name."""

from __future__ import annotations

import re
import runpy
import shlex
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

import terrain_lod
from terrain_lod.cli.app import app
from terrain_lod.drawing.graphics import graphics_problem

PROJECT = Path(__file__).parent.parent
PAGES = [
    *sorted(PROJECT.glob("*.md")),
    *sorted((PROJECT / "docs").glob("*.md")),
    *sorted((PROJECT / "benchmarks").glob("*.md")),
]
# what a print is said to print, behind it or in the line below
SAID = re.compile(r"^[ \t]*print\(.*\)\s+# (.*)$", re.MULTILINE)
# made when the site is built
MADE = ("gallery/", "project/", "reference/")


def name_of(page: Path) -> str:
    return str(page.relative_to(PROJECT))


def blocks(page: Path, language: str) -> list[str]:
    """Return the code of a page in a language; a block marked no-run is only shown."""
    text = page.read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def with_code(language: str) -> list[Path]:
    return [page for page in PAGES if blocks(page, language)]


@pytest.mark.slow
@pytest.mark.parametrize("page", with_code("python"), ids=name_of)
def test_python_of_a_page_runs_and_prints_what_it_says(
    page: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    code = blocks(page, "python")
    if "render(" in "".join(code) and graphics_problem():
        pytest.skip(f"3-D pictures cannot be drawn here: {graphics_problem()}")
    monkeypatch.chdir(tmp_path)
    # where the files lie that pages speak of
    names: dict[str, object] = {"__file__": str(PROJECT / "examples" / "example.py")}
    for block in code:
        exec(compile(block, name_of(page), "exec"), names)
    printed = capsys.readouterr().out.splitlines()
    for said in SAID.findall("\n".join(code)):
        pattern = said.replace("[", "[[]").replace(" ...", "*").replace("...", "*")
        assert any(fnmatchcase(line, pattern) for line in printed), (said, printed)


@pytest.mark.parametrize("page", with_code("sh"), ids=name_of)
def test_commands_of_a_page_are_those_of_the_program(page: Path) -> None:
    for block in blocks(page, "sh"):
        for line in block.replace("\\\n", " ").splitlines():
            program, *tokens = shlex.split(line, comments=True) or [""]
            if program == "terrain-lod":
                app.parse_args(tokens, exit_on_error=False, print_error=False)
            if program == "python":
                assert (PROJECT / tokens[0]).exists() or tokens[0] == "-m", line


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_of_a_page_lead_somewhere(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for target in re.findall(r"\]\(([^)#\s]+)[^)\s]*\)", text):
        if "://" not in target and not target.startswith(MADE):
            assert (page.parent / target).exists(), target


def test_the_reference_has_every_public_name_once(tmp_path: Path) -> None:
    pages = runpy.run_path(str(PROJECT / "docs" / "reference_pages.py"))
    pages["write_reference"](tmp_path)
    text = "\n".join(page.read_text(encoding="utf-8") for page in tmp_path.glob("*.rst"))
    documented = re.findall(r"^\.\. auto(?:class|exception|function|data):: (\S+)$", text, re.M)
    assert sorted(documented) == sorted(pages["public_names"]())
    assert {f"terrain_lod.{name}" for name in terrain_lod.__all__} <= {
        *documented,
        *(full.rpartition(".")[0] for full in documented),
    }
