"""What C libraries print over a damaged file, kept off stderr; the error says it once."""

from __future__ import annotations

import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Final

_LOCK: Final = threading.Lock()


class _Descriptor:
    """The descriptor of stderr, and how many readers keep it closed."""

    def __init__(self) -> None:
        self.readers = 0
        self.kept: int | None = None

    def enter(self) -> None:
        with _LOCK:
            self.readers += 1
            if self.readers > 1:
                return
            try:
                self.kept = os.dup(2)
            except OSError:
                return  # there is no stderr
            with open(os.devnull, "wb") as nowhere:
                os.dup2(nowhere.fileno(), 2)

    def leave(self) -> None:
        with _LOCK:
            self.readers -= 1
            if self.readers == 0 and self.kept is not None:
                os.dup2(self.kept, 2)
                os.close(self.kept)
                self.kept = None


_DESCRIPTOR: Final = _Descriptor()


@contextmanager
def quiet_libraries() -> Iterator[None]:
    """Close the descriptor of stderr to libtiff and PROJ, whose words nobody can catch.

    Python's own stderr of other threads is silent meanwhile, too: this is for single calls.
    """
    _DESCRIPTOR.enter()
    try:
        yield
    finally:
        _DESCRIPTOR.leave()


class _Hooks:
    """Python's two hooks for errors that nobody catches, and how many readers pass over some."""

    def __init__(self) -> None:
        self.readers = 0
        self.ignored = sys.unraisablehook
        self.printed = sys.excepthook

    def enter(self) -> None:
        with _LOCK:
            self.readers += 1
            if self.readers == 1:
                self.ignored, self.printed = sys.unraisablehook, sys.excepthook
                sys.unraisablehook, sys.excepthook = self._ignored, self._printed

    def leave(self) -> None:
        with _LOCK:
            self.readers -= 1
            if self.readers == 0:
                sys.unraisablehook, sys.excepthook = self.ignored, self.printed

    def _ignored(self, unraisable: sys.UnraisableHookArgs, /) -> None:
        if not isinstance(unraisable.exc_value, UnicodeDecodeError):
            self.ignored(unraisable)

    def _printed(
        self, kind: type[BaseException], error: BaseException, trace: TracebackType | None, /
    ) -> None:
        if not isinstance(error, UnicodeDecodeError):
            self.printed(kind, error, trace)


_HOOKS: Final = _Hooks()


@contextmanager
def quiet_rasterio() -> Iterator[None]:
    """Pass over what rasterio's log cannot decode of GDAL's messages; all else is heard.

    It prints such an error to stderr and goes on (Cython's "unraisable" exceptions).
    """
    _HOOKS.enter()
    try:
        yield
    finally:
        _HOOKS.leave()
