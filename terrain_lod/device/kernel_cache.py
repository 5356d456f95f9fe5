"""The folder that PoCL keeps compiled kernels in, sound before PoCL reads it.

PoCL runs what it finds there, and a damaged file ends the process. So a process that ends seals
the files: it writes down their checksums. One that begins removes every program that is not as it
was sealed, and PoCL compiles it again. What has no seal was left by a process that was killed, or
is written by another just now: a process that is alone removes it, too.
"""

from __future__ import annotations

import atexit
import json
import logging
import os
import shutil
import tempfile
import time
import zlib
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Final, NamedTuple

from ..errors import DeviceError

_log = logging.getLogger(__name__)

CACHE_VARIABLE: Final = "POCL_CACHE_DIR"

# a folder of our own: what other programs keep beside it, nobody seals
_NAME: Final = "terrain_lod"
_SEALS: Final = "seals.json"
_LOCK: Final = "lock"
_RUN: Final = (".so", ".bc")  # endings of what PoCL runs
_OLD: Final = 30 * 86400.0  # seconds after which a program that nobody used is removed
_ROOM: Final = 64 << 20  # bytes that new kernels may take: PoCL does not survive a full disk


@cache
def provide_kernel_cache() -> None:
    """Name PoCL a folder for its kernels that is sound, or one for this process alone.

    Raises
    ------
    DeviceError
        If there is no room for kernels anywhere.
    """
    if os.name != "posix":  # no locks, and no PoCL to speak of
        return
    folder = _own_folder()
    try:
        kept = KernelCache(folder)
    except OSError as error:
        _log.warning(
            "kernels are compiled for this run alone: cannot keep them in %s (%s); "
            "%s names another folder", folder, error.strerror or error, CACHE_VARIABLE,
        )  # fmt: skip
        folder = temporary_folder()
        if shutil.disk_usage(folder).free < _ROOM:
            raise DeviceError(
                f"expected {_ROOM >> 20} MB free for PoCL's kernels in {folder.parent}, got less: "
                f"make room, or name another folder in {CACHE_VARIABLE}"
            ) from None
    else:
        _at_exit(kept.seal)
    os.environ[CACHE_VARIABLE] = str(folder)


def temporary_folder() -> Path:
    """Return a new folder that is removed as this process ends."""
    folder = Path(tempfile.mkdtemp(prefix="terrain_lod-"))
    _at_exit(lambda: shutil.rmtree(folder, ignore_errors=True))
    return folder


def _at_exit(work: Callable[[], None]) -> None:
    """Do something as this process ends, but not as forks of it do."""
    process = os.getpid()
    atexit.register(lambda: work() if os.getpid() == process else None)


def _own_folder() -> Path:
    """Return our folder in that which PoCL would take."""
    told = os.environ.get(CACHE_VARIABLE) or os.environ.get("XDG_CACHE_HOME")
    folder = Path(told or os.path.expanduser("~/.cache")).absolute()
    return folder if folder.name == _NAME else folder / _NAME


class _Seal(NamedTuple):
    """What a file was when a process ended: all of it, and what tells quickly that it still is."""

    checksum: int
    stamp: str


class KernelCache:
    """A folder of programs, and their seals. Raises OSError where it cannot be used."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        if shutil.disk_usage(folder).free < _ROOM:
            raise OSError("the disk is full")
        self._folder = folder
        self._boot = _boot()
        self._seals = self._read_seals()
        # held until this process ends, however it ends
        self._lock = os.open(folder / _LOCK, os.O_RDWR | os.O_CREAT)
        alone = _locked_alone(self._lock)
        try:
            self._remove_unsound(alone)
        finally:
            _lock_with_others(self._lock)

    def leave(self) -> None:
        """Be no more among those who use the folder."""
        os.close(self._lock)

    def seal(self) -> None:
        """Write down what the files are, but of those that are no more what they were sealed as."""
        seals = {}
        for program in self._programs():
            for name in _files(program):
                path = self._within(name)
                with suppress(OSError):
                    known = self._seals.get(path)
                    seal = known if known and known.stamp == self._stamp(name) else None
                    seal = seal or _Seal(_checksum(name), self._stamp(name))
                    if known is None or known.checksum == seal.checksum:
                        seals[path] = seal
        if seals != self._seals:
            new = self._folder / f"{_SEALS}-{os.getpid()}"
            with suppress(OSError):
                new.write_text(json.dumps(seals), encoding="utf-8")
                new.replace(self._folder / _SEALS)

    def _read_seals(self) -> dict[str, _Seal]:
        """Return the seals by paths in the folder; none where their list is damaged."""
        try:
            text = (self._folder / _SEALS).read_text(encoding="utf-8")
            listed = json.loads(text).items()
            return {path: _Seal(int(seal[0]), str(seal[1])) for path, seal in listed}
        except (OSError, ValueError, TypeError, AttributeError, LookupError, RecursionError):
            return {}

    def _remove_unsound(self, alone: bool) -> None:
        for program in self._programs():
            if not all(self._is_sound(name, alone) for name in _files(program)) or (
                alone and _is_old(program)
            ):
                shutil.rmtree(program)
                within = self._within(program) + os.sep
                self._seals = {
                    path: seal for path, seal in self._seals.items() if not path.startswith(within)
                }
        for left in self._folder.glob("tempfile_*") if alone else ():
            left.unlink()

    def _is_sound(self, name: str, alone: bool) -> bool:
        seal = self._seals.get(self._within(name))
        if seal is None:
            return not alone
        try:
            return seal.stamp == self._stamp(name) or seal.checksum == _checksum(name)
        except OSError:
            return False

    def _within(self, name: str) -> str:
        """Return a path in the folder; os.path.relpath takes as long as all the rest."""
        return name[len(str(self._folder)) + 1 :]

    def _stamp(self, name: str) -> str:
        """Return what changes whenever a file does; after a power cut all have changed."""
        found = os.stat(name)
        return f"{self._boot} {found.st_ino} {found.st_size} {found.st_ctime_ns}"

    def _programs(self) -> Iterator[str]:
        """Yield the folders of programs: two letters, and the rest of a hash."""
        for group in list(os.scandir(self._folder)):
            if len(group.name) == 2 and group.is_dir():
                programs = list(os.scandir(group))
                if not all(os.access(folder, os.W_OK) for folder in (group, *programs)):
                    raise OSError("not all of it can be written")
                yield from [program.path for program in programs]


def _files(folder: str) -> Iterator[str]:
    """Yield what PoCL runs of a program, whether files or not."""
    for entry in list(os.scandir(folder)):
        if entry.name.endswith(_RUN):
            yield entry.path
        elif entry.is_dir():
            yield from _files(entry.path)


def _checksum(name: str) -> int:
    with open(name, "rb") as file:
        return zlib.crc32(file.read())


def _is_old(program: str) -> bool:
    try:
        return time.time() - os.stat(os.path.join(program, "last_accessed")).st_mtime > _OLD
    except OSError:
        return True


def _boot() -> str:
    """Return what names the time since this machine was started; what no seal has if unknown."""
    try:
        return Path("/proc/sys/kernel/random/boot_id").read_text(encoding="ascii").strip()
    except (OSError, ValueError):
        return str(time.time_ns())


def _locked_alone(lock: int) -> bool:
    """Say whether no other process uses the folder; none can begin to while this one is alone."""
    import fcntl

    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        _lock_with_others(lock)
        return False
    return True


def _lock_with_others(lock: int) -> None:
    import fcntl

    fcntl.flock(lock, fcntl.LOCK_SH)
