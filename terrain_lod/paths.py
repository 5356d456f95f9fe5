"""Files appear whole or not at all: written under a temporary name, then renamed."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import FileError


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path to write; on leaving the block it becomes `path`.

    The temporary file stands beside `path` and has its ending, in lower case, as some writers
    demand. If the block raises, it is removed and `path` is as it was.

    Raises
    ------
    FileError
        If the folder does not exist, or the file cannot be written.
    """
    final = Path(path)
    require_folder(final)
    temporary = final.with_name(f".{final.stem}.{os.getpid()}{final.suffix.lower()}")
    try:
        yield temporary
        temporary.replace(final)
    except OSError as error:
        if isinstance(error, FileError):
            raise
        raise FileError(f"cannot write {final}: {error.strerror or error}") from None
    finally:
        temporary.unlink(missing_ok=True)


def require_made(folder: Path) -> Path:
    """Make `folder`, and those it is in, unless it is there; return it.

    Raises
    ------
    FileError
        If it cannot be made.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"cannot make the folder {folder}: {error.strerror}") from None
    return folder


def require_folder(path: Path) -> None:
    """Say so before the work begins if `path` cannot be written.

    Raises
    ------
    FileError
        If its folder does not exist, cannot be written, or `path` itself is a folder.
    """
    folder = path.parent
    if not folder.is_dir():
        raise FileError(f"expected a folder to write {path.name} in, got none at {folder}")
    if path.is_dir():
        raise FileError(f"expected a file name to write, got the folder {path}")
    if not os.access(folder, os.W_OK):
        raise FileError(f"expected a folder that can be written, got {folder} without permission")
