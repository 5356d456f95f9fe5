"""Files appear whole or not at all: written under a temporary name, then renamed."""

from __future__ import annotations

import contextlib
import hashlib
import itertools
import os
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Final, NoReturn

from .errors import FileError

# a temporary file that nobody has written to for so long was left by a process that was killed
_OLD: Final = 3600.0  # seconds
# endings that writers go by are shorter; a longer one would make the name too long
_LONGEST_ENDING: Final = 16

_writers = itertools.count()


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path to write; on leaving the block it becomes `path`.

    The temporary file stands beside `path`, under a name of this writer alone, and has its ending,
    in lower case, as some writers demand. If the block raises, or SIGTERM comes, it is removed and
    `path` is as it was. Temporary files that killed writers of `path` left more than an hour ago
    are removed, too.

    Raises
    ------
    FileError
        If the folder does not exist, or the file cannot be written.
    """
    final = Path(path)
    require_folder(final)
    # short, however long the name is, and the same for all writers of this name
    mark = f".terrain_lod-{hashlib.sha256(os.fsencode(final.name)).hexdigest()[:16]}"
    ending = final.suffix.lower()
    if len(os.fsencode(ending)) > _LONGEST_ENDING:
        ending = ""
    temporary = final.with_name(f"{mark}-{os.getpid()}-{next(_writers)}{ending}")
    _remove_old(final.parent, mark)
    with _ended_by_sigterm():
        try:
            yield temporary
            temporary.replace(final)
        except OSError as error:
            if isinstance(error, FileError):
                raise
            raise FileError(f"cannot write {final}: {error.strerror or error}") from None
        finally:
            temporary.unlink(missing_ok=True)


def _remove_old(folder: Path, mark: str) -> None:
    """Remove the temporary files of killed writers."""
    for left in folder.glob(f"{mark}-*"):
        # another process may be quicker, or the file not ours
        with contextlib.suppress(OSError):
            if time.time() - left.stat().st_mtime > _OLD:
                left.unlink()


@contextmanager
def _ended_by_sigterm() -> Iterator[None]:
    """Let SIGTERM raise SystemExit inside the block, as Ctrl-C raises KeyboardInterrupt.

    Where someone else has a handler for it, or in a thread, where Python allows none, nothing is
    changed.
    """
    in_main = threading.current_thread() is threading.main_thread()
    if not in_main or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield
        return

    def end(number: int, frame: FrameType | None) -> NoReturn:
        raise SystemExit(128 + number)

    signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


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
        If its folder does not exist, cannot be written, or `path` itself is a folder or no name
        that a file can have.
    """
    folder = path.parent
    try:
        is_folder, is_in_folder = path.is_dir(), folder.is_dir()
    except OSError as error:
        raise FileError(f"cannot write {path}: {error.strerror}") from None
    if not is_in_folder:
        raise FileError(f"expected a folder to write {path.name} in, got none at {folder}")
    if is_folder:
        raise FileError(f"expected a file name to write, got the folder {path}")
    if not os.access(folder, os.W_OK):
        raise FileError(f"expected a folder that can be written, got {folder} without permission")
