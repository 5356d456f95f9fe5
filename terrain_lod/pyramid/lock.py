"""One build at a time writes a store."""

from __future__ import annotations

import getpass
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import FileError


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock on the file `path` while the block runs, and say in it who does.

    The system lets go of it when the process ends, however it does.

    Raises
    ------
    FileError
        If another process holds it, with what that said of itself, or it cannot be written.
    """
    import fcntl  # not on Windows: everything else imports there

    while True:
        try:
            file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        except OSError as error:
            raise FileError(f"cannot write {path}: {error.strerror}") from None
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            holder = os.read(file, 200).decode(errors="replace").strip() or "another process"
            os.close(file)
            raise FileError(
                f"expected a store that nobody else is building, got {path.parent}, which "
                f"{holder} is at work on: wait for it"
            ) from None
        if _is_still(file, path):
            break
        # whoever had it before has just taken the file away
        os.close(file)
    try:
        os.ftruncate(file, 0)
        os.write(file, _name().encode())
        yield
    finally:
        path.unlink(missing_ok=True)
        os.close(file)


def _is_still(file: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(file), path.stat())
    except OSError:
        return False


def _name() -> str:
    try:
        user = getpass.getuser()
    except (KeyError, OSError):
        user = f"user {os.getuid()}"
    return f"process {os.getpid()} of {user} on {socket.gethostname()}"
