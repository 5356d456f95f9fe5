"""Ctrl-C at the command line: one line and exit code 130, be it in the middle of an import."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(os.name != "posix", reason="signals are sent as POSIX has them")

# found by Python as it starts: presses Ctrl-C when a module is looked for
PRESS_AT = """
import os, signal, sys

class Press:
    def find_spec(self, name, path=None, target=None):
        if name == os.environ["PRESS_AT"]:
            os.kill(os.getpid(), signal.SIGINT)

sys.meta_path.insert(0, Press())
"""
SCRIPT = Path(sys.executable).with_name("terrain-lod")


def interrupted(tmp_path, module, *command, ignored=False):
    """Return the exit code and stderr of a command that is interrupted as it imports `module`."""
    (tmp_path / "sitecustomize.py").write_text(PRESS_AT)
    child = subprocess.run(
        command,
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, "PYTHONPATH": str(tmp_path), "PRESS_AT": module},
        preexec_fn=lambda: signal.signal(
            signal.SIGINT, signal.SIG_IGN if ignored else signal.default_int_handler
        ),
    )
    return child.returncode, child.stderr


@pytest.mark.parametrize(
    "module",
    # of the package, of what it stands on, of the command line, of a command
    ["terrain_lod.camera", "numpy", "pyopencl", "cyclopts", "terrain_lod.cli.view", "PIL.Image"],
)
@pytest.mark.parametrize("how", ["module", "script"])
def test_an_import_is_interrupted_with_one_line(tmp_path, module, how):
    if how == "script" and not SCRIPT.exists():
        pytest.skip(f"no {SCRIPT}: terrain_lod is not installed here")
    program = (sys.executable, "-m", "terrain_lod") if how == "module" else (str(SCRIPT),)
    output = tmp_path / "volcano.png"
    said = interrupted(tmp_path, module, *program, "render", "volcano", "-o", str(output))
    assert said == (130, "terrain-lod: interrupted\n")
    assert not output.exists()


def test_a_signal_that_is_ignored_stays_so(tmp_path):
    program = (sys.executable, "-m", "terrain_lod", "samples")
    assert interrupted(tmp_path, "numpy", *program, ignored=True) == (0, "")


def test_another_program_keeps_its_signals(tmp_path):
    code = "import signal, terrain_lod; print(signal.getsignal(signal.SIGINT).__name__)"
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert child.stdout == "default_int_handler\n", child.stderr
    # and sees the exception that it expects
    code = "import terrain_lod; terrain_lod.Terrain"
    code, said = interrupted(tmp_path, "pyopencl", sys.executable, "-c", code)
    assert said.endswith("KeyboardInterrupt\n")
    assert code == -signal.SIGINT
