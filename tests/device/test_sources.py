"""Kernel text: includes in place once, line numbers true, a missing file blamed on its asker."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from terrain_lod.device import sources
from terrain_lod.device.sources import kernel_source, with_true_places
from terrain_lod.errors import DeviceError


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A kernels folder of the test's own, with a space in its path."""
    path = tmp_path / "my kernels"
    path.mkdir()
    monkeypatch.setattr(sources, "KERNELS", path)
    return path


def test_includes_stand_in_place_and_lines_keep_their_numbers(folder: Path) -> None:
    (folder / "main.cl").write_text('int before;\n#include "part.h"\nint after;\n')
    (folder / "part.h").write_text("int part;\n")
    assert kernel_source("main.cl").splitlines() == [
        '#line 1 "main.cl"',
        "int before;",
        '#line 1 "part.h"',
        "int part;",
        '#line 3 "main.cl"',
        "int after;",
    ]


def test_an_include_is_resolved_once(folder: Path) -> None:
    (folder / "main.cl").write_text('#include "a.h"\n#include "b.h"\n')
    (folder / "a.h").write_text('#include "b.h"\nint a;\n')
    (folder / "b.h").write_text('#include "a.h"\nint b;\n')  # a circle ends, too
    text = kernel_source("main.cl")
    assert text.count("int a;") == 1
    assert text.count("int b;") == 1
    assert "#include" not in text


@pytest.mark.parametrize("line", ['#include "x.h"', '  #  include  "x.h" // why'])
def test_include_is_recognised_however_it_is_spaced(folder: Path, line: str) -> None:
    (folder / "main.cl").write_text(line)
    assert "int x;" in kernel_source("main.cl", {"x.h": "int x;"})


def test_a_commented_include_is_left_alone(folder: Path) -> None:
    (folder / "main.cl").write_text('// #include "nowhere.h"\n')
    assert '// #include "nowhere.h"' in kernel_source("main.cl")


def test_generated_text_wins_over_a_file(folder: Path) -> None:
    (folder / "main.cl").write_text('#include "layout.h"\n')
    (folder / "layout.h").write_text("stale")
    assert "stale" not in kernel_source("main.cl", {"layout.h": "#define TRUE_ONE 1"})


def test_a_missing_include_names_who_asked(folder: Path) -> None:
    (folder / "main.cl").write_text('int a;\n#include "nowhere.h"\n')
    with pytest.raises(DeviceError, match=r"^main\.cl:2 wants kernels/nowhere\.h"):
        kernel_source("main.cl")


def test_a_missing_kernel_file_is_named() -> None:
    with pytest.raises(DeviceError, match=r"wants kernels/nowhere\.cl: there is no such file"):
        kernel_source("nowhere.cl")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (15, "15"),
        (np.int32(15), "15"),
        (True, "1"),
        (0.1, "0.1f"),
        (2.0, "2.0f"),
        (1e-7, "1e-07f"),
        (np.float32(0.5), "0.5f"),
        ("min", "min"),
    ],
)
def test_defines_are_literals_of_their_type(folder: Path, value: float, text: str) -> None:
    (folder / "main.cl").write_text("")
    assert kernel_source("main.cl", None, {"N": value}).startswith(f"#define N {text}\n#line 1")


def test_a_log_without_files_gets_them(folder: Path) -> None:
    (folder / "main.cl").write_text('#include "part.h"\n\nint after;\n')
    (folder / "part.h").write_text("int part;\nint more;\n")
    source = kernel_source("main.cl", None, {"N": 1})
    for place, text in (("part.h:2", "int more;"), ("main.cl:3", "int after;")):
        number = source.splitlines().index(text) + 1
        log = f"<kernel>:{number}:5: error: no {text}"
        assert with_true_places(log, source) == f"{place}:5: error: no {text}"
    assert with_true_places("<kernel>:1:1", source) == "<defines>:1:1"
