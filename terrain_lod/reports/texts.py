"""What every report writes besides pictures: CSV, JSON and pages, whole or not at all."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable, Iterable, Mapping
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ..arguments import told
from ..errors import InputError
from ..paths import replacing


class Steps:
    """Counts steps for those who want to know.

    Parameters
    ----------
    progress : callable or None
        Called with steps done and steps in all.
    total : int
    """

    def __init__(self, progress: Callable[[int, int], None] | None, total: int) -> None:
        if not (progress is None or callable(progress)):
            raise InputError(f"expected a function for progress, got {told(progress)}")
        self._progress = progress or (lambda done, total: None)
        self._done, self._total = 0, total

    def __call__(self) -> None:
        self._done += 1
        self._progress(self._done, self._total)

    def finish(self) -> None:
        """Report the end, steps that were left out included."""
        self._progress(self._total, self._total)


def write_texts(folder: Path, texts: Mapping[str, tuple[str, str]]) -> dict[str, Path]:
    """Write files of a name and a text each to `folder`; return the paths, by the same keys.

    Raises
    ------
    FileError
        If one cannot be written.
    """
    for name, text in texts.values():
        with replacing(folder / name) as temporary:
            temporary.write_text(text, encoding="utf-8", newline="\n")
    return {key: folder / name for key, (name, _) in texts.items()}


def csv_text(lines: Iterable[Iterable[object]]) -> str:
    """Return lines of values as CSV, None as nothing."""
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(lines)
    return stream.getvalue()


def json_text(form: int, content: Mapping[str, Any]) -> str:
    """Return `content` as JSON, after the number of its format and the version that made it.

    Numbers that JSON has no name for, infinite ones and NaN, become null.
    """
    whole = {"format": form, "terrain_lod": version("terrain_lod"), **content}
    return json.dumps(_finite(whole), indent=2, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {name: _finite(inner) for name, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(inner) for inner in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
