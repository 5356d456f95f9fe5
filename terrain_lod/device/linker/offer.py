"""PoCL links every kernel it compiles and ends the process where it finds no linker: offer ours."""

from __future__ import annotations

import os
import platform
import shlex
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Final

from ...errors import DeviceError
from ..kernel_cache import temporary_folder

# where PoCL's compiler looks for the programs it runs, before the PATH
_FOLDER_VARIABLE: Final = "COMPILER_PATH"
_PROGRAM: Final = Path(__file__).with_name("elf.py")


@cache
def provide_linker() -> None:
    """Offer PoCL the linker of ``elf.py`` where the machine has no compiler with its own.

    Raises
    ------
    DeviceError
        If there is none and ours cannot run here; the message names the command that mends it.
    """
    # an ld alone is not enough: PoCL also names the files that come with a C compiler
    if shutil.which("ld") and shutil.which("cc"):
        return
    folder = temporary_folder()
    script = folder / "ld"
    command = shlex.join([sys.executable, "-I", "-S", str(_PROGRAM)])
    script.write_text(f'#!/bin/sh\nexec {command} "$@"\n', encoding="utf-8")
    script.chmod(0o755)
    if platform.machine() != "x86_64" or not _starts(script):
        raise DeviceError(
            "expected a linker for PoCL's kernels, found none: apt-get install gcc libc6-dev"
        )
    others = os.environ.get(_FOLDER_VARIABLE)
    os.environ[_FOLDER_VARIABLE] = os.pathsep.join(filter(None, [str(folder), others]))


def _starts(script: Path) -> bool:
    """Say whether `script` runs: a folder for temporary files may forbid it."""
    try:
        return subprocess.run([script, "--version"], capture_output=True).returncode == 0
    except OSError:
        return False
