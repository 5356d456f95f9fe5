"""A reader that may crash, in a process of its own: VTK's, meshio's and Draco's."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import Any, Final

import numpy as np

from ... import errors
from ...errors import FileError
from .raw import ARRAYS, RawMesh

# a reader that takes longer than any mesh of that size needs has lost its way
_SECONDS: Final = 60.0
_SECONDS_A_MEGABYTE: Final = 2.0


def read_in_child(path: Path) -> RawMesh:
    """Return what a child process reads of a file: see ``answer.py``.

    Raises
    ------
    FileError
        If the file is damaged, or its reader crashes or finds no end.
    InputError, MissingExtraError
        As the readers do.
    """
    limit = _SECONDS + _SECONDS_A_MEGABYTE * path.stat().st_size / 1e6
    # the child finds the modules that this process finds, and none that merely lie around
    paths = os.pathsep.join(folder or os.getcwd() for folder in sys.path)
    with tempfile.TemporaryDirectory(prefix="terrain_lod-") as folder:
        answer = Path(folder) / "answer.npz"
        module = "terrain_lod.files.meshes.answer"
        try:
            ended = subprocess.run(
                [sys.executable, "-P", "-m", module, path, answer],
                capture_output=True,
                timeout=limit,
                stdin=subprocess.DEVNULL,
                env={**os.environ, "PYTHONPATH": paths},
            )
        except subprocess.TimeoutExpired:
            raise FileError(f"cannot read {path}: its reader found no end in {limit:g} s") from None
        except OSError as error:
            raise FileError(f"cannot read {path}: no child process: {error.strerror}") from None
        if ended.returncode < 0:
            name = signal.Signals(-ended.returncode).name
            raise FileError(f"cannot read {path}: its reader crashed ({name}): is it damaged?")
        if ended.returncode or not answer.is_file():
            last_line = ended.stderr.decode(errors="replace").strip().rpartition("\n")[2]
            raise FileError(f"cannot read {path}: {last_line or 'its reader gave no answer'}")
        return _understood(answer)


def _understood(answer: Path) -> RawMesh:
    """Return the mesh that the child wrote, or raise its error."""
    with np.load(answer) as arrays:
        said = json.loads(str(arrays["said"]))
        if "error" in said:
            raise getattr(errors, said["error"])(said["message"])
        found: dict[str, Any] = {name: arrays[name] for name in ARRAYS if name in arrays}
        return RawMesh(
            **found, crs=said["crs"], notes=said["notes"], dropped=Counter(said["dropped"])
        )
