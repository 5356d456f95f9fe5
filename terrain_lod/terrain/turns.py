"""Turns that threads take: many read at a time, who changes is alone."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager


class Turns:
    """A lock for many readers or one that changes; who waits for a change goes before new readers.

    No thread may read within its own reading: a change that waits between the two would wait for
    ever.
    """

    def __init__(self) -> None:
        self._condition = threading.Condition()
        self._readers = self._waiting = 0

    @contextmanager
    def reading(self) -> Iterator[None]:
        """Read beside other readers."""
        with self._condition:
            self._condition.wait_for(lambda: not self._waiting)
            self._readers += 1
        try:
            yield
        finally:
            with self._condition:
                self._readers -= 1
                self._condition.notify_all()

    @contextmanager
    def changing(self) -> Iterator[None]:
        """Change, alone."""
        with self._condition:
            self._waiting += 1
            try:
                self._condition.wait_for(lambda: not self._readers)
                yield
            finally:
                self._waiting -= 1
                self._condition.notify_all()
