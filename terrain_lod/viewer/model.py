"""Where the scene of a viewer comes from, and whether its file is still what was read."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from .scene import Scene


class Model:
    """The scene that is looked at.

    Parameters
    ----------
    load : callable
        Returns the scene; called again by :meth:`reload`.
    path : Path, optional
        The file that it is read from.

    Attributes
    ----------
    scene : Scene

    Raises
    ------
    TerrainError
        Whatever `load` raises.
    """

    def __init__(self, load: Callable[[], Scene], *, path: Path | None = None) -> None:
        self._load, self._path = load, path
        self._read_at = self._modified()
        self.scene = load()

    def reload(self) -> None:
        """Read the scene again; what was read before stays if that fails."""
        self._read_at = self._modified()
        self.scene = self._load()

    def news(self) -> str | None:
        """Return a line if the file is not what was read, once for each change."""
        modified = self._modified()
        if modified == self._read_at:
            return None
        self._read_at = modified
        if modified is None:
            return f"{self._path} is gone: what was read from it stays"
        return f"{self._path} has changed: u reads it again"

    def _modified(self) -> int | None:
        if self._path is None:
            return None
        try:
            return self._path.stat().st_mtime_ns
        except OSError:
            return None
