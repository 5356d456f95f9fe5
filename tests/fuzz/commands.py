"""Wrong values for options of every command: done, or refused in a line and nothing written."""

from __future__ import annotations

import contextlib
import io
import os
import random
import warnings
from functools import cache
from pathlib import Path
from typing import Final

import numpy as np

import terrain_lod as tl
from fuzz.kind import require
from terrain_lod.cli.app import REFUSED, app, run

# what each command is given besides, so that it has little to do
_USUAL: Final = {
    "demo": ("ground.asc", "--output=out"),
    "render": ("ground.asc", "--output=x.png"),
    "mesh": ("ground.asc", "--output=x.glb"),
    "report": ("ground.asc", "--output=out"),
    "view": ("ground.asc", "--off-screen"),
    "smooth": ("quad.ply", "--output=x.obj"),
    "pattern": ("--output=x.svg",),
}
_VALUES: Final = (
    *("", "seven", "nan", "inf", "-inf", "-1", "0", "0.5", "1e300", "-1e300", "9" * 30, "None"),
    *("1,2", "1,2,3", "1,2,3,4", "a,b", "nan,nan,nan", "1e300,1", "1,2,3,4,5", ",", "0x0"),
    *("99999x99999", "nowhere/x.png", ".", "x" * 5000, "ä\u2028", "a\nb", "[]", "{}", "map", "--"),
    *("nowhere.py:X", "quad.ply", "ground.asc", "\udcff", "min", "shaded"),
)


@cache
def options(command: str) -> tuple[str, ...]:
    """Return the options that a command has."""
    arguments = app[command].assemble_argument_collection()
    names = (name for argument in arguments for name in argument.names[:1])
    return tuple(name for name in names if name.startswith("--"))


def trial(chance: random.Random, folder: Path) -> None:
    (folder / "ground.asc").write_text(
        "ncols 9\nnrows 9\nxllcorner 0\nyllcorner 0\ncellsize 2\n"
        + "\n".join(" ".join(str(chance.randrange(9)) for _ in range(9)) for _ in range(9))
    )
    corners = np.float32([[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    tl.Mesh(corners, corners * 0 + 1, np.int32([[0, 1, 2]])).save(folder / "quad.ply")
    command = chance.choice(tuple(_USUAL))
    tokens = [command, *_USUAL[command]]
    if "--size" in options(command):
        tokens.append("--size=64x48")
    for _ in range(chance.choice((1, 1, 1, 2))):
        option, value = chance.choice(options(command)), chance.choice(_VALUES)
        tokens = [token for token in tokens if token.split("=")[0] != option]
        tokens.append(f"{option}={value}")
    if chance.random() < 0.05:
        tokens[1] = chance.choice(_VALUES)
    before = sorted(folder.rglob("*"))
    code, complaint = _ran(tokens, folder)
    require(code in (0, REFUSED), f"{tokens} ended with {code}")
    if code == REFUSED:
        require(complaint.count("\n") == 1, f"{tokens} said {complaint[:300]!r}")
        written = sorted(folder.rglob("*"))
        require(written == before, f"{tokens} left {written}")
        raise tl.InputError("said in one line")


def _ran(tokens: list[str], folder: Path) -> tuple[int, str]:
    """Return the exit code, and what was said on stderr."""
    os.environ.pop("DISPLAY", None)  # no window
    said = io.StringIO()
    with (
        warnings.catch_warnings(),
        contextlib.chdir(folder),
        contextlib.redirect_stdout(io.StringIO()),
        contextlib.redirect_stderr(said),
    ):
        warnings.simplefilter("ignore", UserWarning)
        return run(tokens), said.getvalue()
