"""What of a folder of tiles is finished: one line of JSON for each tile, behind one for the work.

A tile's line is written after its file, which appears whole. So what the journal names is there,
and work that was cut off goes on where it ended.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any, Final

from ..errors import FileError, InputError
from ..paths import require_made
from .mend import TileMesh
from .schemes import Tile

NAME: Final = "tiles.jsonl"


@dataclass(frozen=True)
class Record:
    """A finished tile.

    Attributes
    ----------
    z, x, y : int
        As its file is called.
    path : str
        Of its file, within the folder.
    bytes : int
    triangles : int
        0 of a picture.
    error : float
        Metres, measured: no sample within the tile is farther from it.
    low, high : float
        Metres: the lowest and highest sample within it, or vertex.
    """

    z: int
    x: int
    y: int
    path: str
    bytes: int
    triangles: int
    error: float
    low: float
    high: float

    @classmethod
    def of(cls, mesh: TileMesh, path: str) -> Record:
        """Return what is known of a mesh before it is written."""
        heights = mesh.heights
        # triangles are straight, so the Earth bends away above them
        low, high = float(heights.min()) - mesh.error, float(heights.max())
        return cls(*mesh.tile, path, 0, len(mesh.triangles), mesh.error, low, high)

    @property
    def tile(self) -> Tile:
        return self.z, self.x, self.y


class Journal:
    """The journal of one folder.

    Parameters
    ----------
    folder : Path
    work : dict
        What is being done. A journal of other work is refused.
    """

    def __init__(self, folder: Path, work: dict[str, Any]) -> None:
        self.folder, self._path = require_made(folder), folder / NAME
        self.done: dict[Tile, Record] = {}
        try:
            there = any(folder.iterdir())
            lines = self._path.read_text().splitlines() if self._path.exists() else []
        except OSError as error:
            raise FileError(f"cannot read {folder}: {error.strerror}") from None
        begun = _parsed(lines[0]) if lines else None
        if there and begun != json.loads(json.dumps(work)):
            what = "tiles of other work" if lines else "other files"
            raise InputError(
                f"expected an empty folder, or one where the same work was cut off, got {what} in "
                f"{folder}: choose another folder"
            )
        for line in lines[1:]:
            entry = _parsed(line)
            if entry is not None and entry.keys() == {field.name for field in fields(Record)}:
                record = Record(**entry)
                # a tile where no ground is has no file
                if not record.path or _size(folder / record.path) == record.bytes:
                    self.done[record.tile] = record
        self._work = work

    @contextmanager
    def writing(self) -> Iterator[None]:
        """Keep the file open; what a killed writer left half written is dropped."""
        try:
            with self._path.open("w", encoding="utf-8") as self._file:
                self._line(self._work)
                for record in self.done.values():
                    self._line(asdict(record))
                yield
        except OSError as error:
            if isinstance(error, FileError):
                raise
            raise FileError(f"cannot write {self._path}: {error.strerror}") from None

    def add(self, record: Record) -> None:
        self.done[record.tile] = record
        self._line(asdict(record))

    def _line(self, entry: dict[str, Any]) -> None:
        self._file.write(json.dumps(entry, separators=(",", ":")) + "\n")
        self._file.flush()


def _parsed(line: str) -> dict[str, Any] | None:
    try:
        entry = json.loads(line)
    except ValueError:
        return None
    return entry if isinstance(entry, dict) else None


def _size(path: Path) -> int:
    try:
        return os.stat(path).st_size
    except OSError:
        return -1
