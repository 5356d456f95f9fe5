"""Read a mesh, write the answer: the child process of ``child.py``, run as a module.

::

    python -m terrain_lod.files.meshes.answer MESH ANSWER.npz

The answer holds the arrays of a RawMesh and, as JSON in ``said``, the rest of it or the error.
"""

from __future__ import annotations

import contextlib
import json
import sys
from pathlib import Path
from typing import Any, Final

import numpy as np

from ...errors import TerrainError
from .raw import ARRAYS
from .readers import read_here

# memory that no mesh needs: at least, and for each byte of the file
_BYTES: Final = 8 << 30
_BYTES_A_BYTE: Final = 200


def main(path: Path, answer: Path) -> None:
    """Write what `path` holds to `answer`."""
    _limit_memory(path.stat().st_size)
    said: dict[str, Any]
    arrays = {}
    try:
        raw = read_here(path)
        said = {"crs": raw.crs, "notes": raw.notes, "dropped": raw.dropped}
        arrays = {name: getattr(raw, name) for name in ARRAYS if getattr(raw, name) is not None}
    except TerrainError as error:
        said = {"error": type(error).__name__, "message": str(error)}
    np.savez(answer, said=np.array(json.dumps(said)), **arrays)


def _limit_memory(size: int) -> None:
    """Let what a damaged file claims fail at once, where the system knows limits."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        _, hard = resource.getrlimit(resource.RLIMIT_AS)
        limit = _BYTES + _BYTES_A_BYTE * size
        if hard == resource.RLIM_INFINITY or limit < hard:
            resource.setrlimit(resource.RLIMIT_AS, (limit, hard))


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
