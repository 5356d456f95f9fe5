"""Bézier patches in text files: .bpt, the format that the Utah teapot is passed around in.

::

    32                      number of patches
    3 3                     degree along u and along v
    1.4 0.0 2.4             a control point a line: v runs fastest
    1.4 -0.784 2.4
    ...                     16 of them, then the next patch's degrees
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ...arguments import array, file_path
from ...errors import FileError, InputError
from ...paths import replacing

Nets = npt.NDArray[np.float64]


def load_bpt(path: str | Path) -> Nets:
    """Read bicubic Bézier patches.

    Parameters
    ----------
    path : str or pathlib.Path

    Returns
    -------
    (P, 4, 4, 3) float64
        Control points, [patch, along u, along v].

    Raises
    ------
    FileError
        If the file cannot be read.
    InputError
        If it holds anything else than bicubic patches; names the line.
    """
    path = file_path("path", path)
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        reason = getattr(error, "strerror", None) or "it is no text"
        raise FileError(f"cannot read {path}: {reason}") from None
    lines = _Lines(path, text)
    (count,) = lines.numbers(1, "the number of patches")
    if count < 0 or count != int(count):
        raise lines.wrong("the number of patches", f"{count:g}")
    nets = []
    for _ in range(int(count)):
        degrees = lines.numbers(2, "the degrees 3 3")
        if degrees != [3, 3]:
            raise lines.wrong("a bicubic patch, 3 3", " ".join(f"{n:g}" for n in degrees))
        nets.append([lines.numbers(3, "a control point x y z") for _ in range(16)])
    lines.end(int(count))
    return np.array(nets, np.float64).reshape(-1, 4, 4, 3)


def save_bpt(nets: npt.ArrayLike, path: str | Path) -> Path:
    """Write bicubic Bézier patches, (P, 4, 4, 3), and return the path.

    Raises
    ------
    InputError
        If the shape is another.
    FileError
        If the file cannot be written.
    """
    checked, path = as_nets(nets), file_path("path", path)
    lines = [f"{len(checked)}"]
    for net in checked.reshape(-1, 16, 3):
        lines += ["3 3", *(" ".join(f"{x:.9g}" for x in point) for point in net + 0.0)]
    with replacing(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def as_nets(nets: npt.ArrayLike) -> Nets:
    """Return control points as (P, 4, 4, 3), or say what does not fit."""
    points = array("patches", nets, ("P", ...))
    if points.shape[1:] not in ((4, 4, 3), (16, 3)):
        raise InputError(
            f"expected patches (P, 4, 4, 3) or (P, 16, 3) of 16 control points, got shape "
            f"{points.shape}"
        )
    return points.reshape(-1, 4, 4, 3)


class _Lines:
    """The lines of a text that are not empty, read one by one, and their numbers."""

    def __init__(self, path: Path, text: str) -> None:
        self._path = path
        self._number = 0
        self._rest: Iterator[tuple[int, str]] = (
            (number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip()
        )

    def numbers(self, count: int, what: str) -> list[float]:
        """Return the `count` numbers of the next line."""
        self._number, line = next(self._rest, (self._number + 1, ""))
        if not line:
            raise self.wrong(what, "the end of the file")
        try:
            values = [float(word) for word in line.split()]
        except ValueError:
            values = []
        if len(values) != count or not np.isfinite(values).all():
            raise self.wrong(what, repr(line.strip()[:40]))
        return values

    def end(self, patches: int) -> None:
        """Say so if there is more."""
        number, line = next(self._rest, (0, ""))
        if line:
            self._number = number
            raise self.wrong(f"the end after {patches} patches", repr(line.strip()[:40]))

    def wrong(self, expected: str, got: str) -> InputError:
        return InputError(f"{self._path} line {self._number}: expected {expected}, got {got}")
