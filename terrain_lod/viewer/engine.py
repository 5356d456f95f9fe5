"""A thread that makes what a viewer shows, so that its window never waits.

Of the pictures that are asked for while one is made, only the newest is made next. What cannot be
made becomes a line to show, and the last good picture stays.
"""

from __future__ import annotations

import logging
from threading import Condition, Thread
from typing import Final

from ..errors import TerrainError
from .model import Model
from .scene import Frame, Request

_log = logging.getLogger(__name__)

# what a mesh did not measure takes most of a second: only for eyes at rest
_REST: Final = 0.3  # seconds
# what is not all there is made again, after so long
_AGAIN: Final = 0.1  # seconds


class Engine:
    """Makes frames of a model on a thread of its own.

    Parameters
    ----------
    model : Model

    Attributes
    ----------
    problem : str or None
        Why the last request could not be answered, in one line.
    """

    def __init__(self, model: Model) -> None:
        self.problem: str | None = None
        self._model = model
        self._changed = Condition()
        self._request: Request | None = None
        self._reload = False
        self._frame: Frame | None = None
        self._working = self._making = False
        self._closed = False
        self._thread = Thread(target=self._run, name="terrain-lod-viewer", daemon=True)
        self._thread.start()

    def ask(self, request: Request, *, reload: bool = False) -> None:
        """Want this picture, instead of any that is not begun; with `reload` of a scene read again.

        If it cannot be read, there is no picture either.
        """
        with self._changed:
            self._request = request
            self._reload = self._reload or reload
            self._changed.notify_all()

    def take(self) -> Frame | None:
        """Return the newest frame, if it has not been taken before. Never waits."""
        with self._changed:
            frame, self._frame = self._frame, None
            return frame

    def wait(self, seconds: float, *, measured: bool = False) -> bool:
        """Return whether a frame is there, or everything is done, within so many seconds.

        With `measured`, only when nothing is left to do.
        """
        with self._changed:
            return self._changed.wait_for(
                lambda: self._idle() or (self._frame is not None and not measured), seconds
            )

    @property
    def working(self) -> bool:
        """Whether a mesh that was asked for is not there yet."""
        return self._making or self._request is not None

    def close(self) -> None:
        """End the thread, after what it is doing."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        self._thread.join(30.0)

    def _idle(self) -> bool:
        return not self._working and self._request is None

    def _run(self) -> None:
        while True:
            with self._changed:
                self._working = self._making = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._closed or not self._idle())
                if self._closed:
                    return
                self._working = self._making = True
                request, self._request = self._request, None
                reload, self._reload = self._reload, False
            if request is not None:
                self._attempt(request, reload)

    def _attempt(self, request: Request, reload: bool) -> None:
        try:
            if reload:
                self._model.reload()
            frame = self._model.scene.frame(request)
            self.problem = None
            self._publish(frame)
            while not (frame.is_complete or self._disturbed(_AGAIN)):
                frame = self._model.scene.frame(request)
                self._publish(frame)
            if not self._disturbed(_REST):
                self._publish(frame.measured())
        except (TerrainError, OSError, MemoryError) as error:
            self.problem = " ".join(str(error).split()) or type(error).__name__
        except Exception as error:  # a viewer that dies of one picture has lost its user's place
            _log.debug("no frame for %r", request, exc_info=True)
            self.problem = f"{type(error).__name__}: {error}"

    def _disturbed(self, seconds: float) -> bool:
        """Return whether something else is wanted within so many seconds."""
        with self._changed:
            return self._changed.wait_for(
                lambda: self._closed or self._request is not None, seconds
            )

    def _publish(self, frame: Frame) -> None:
        with self._changed:
            self._frame, self._making = frame, False
            self._changed.notify_all()
