"""Is a PLY file all there? VTK's reader crashes on a truncated one, or invents the rest.

Turk: *The PLY Polygon File Format*, 1994.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Literal

import numpy as np

from ...errors import FileError

_BYTES: Final = {
    **dict.fromkeys(("char", "uchar", "int8", "uint8"), 1),
    **dict.fromkeys(("short", "ushort", "int16", "uint16"), 2),
    **dict.fromkeys(("int", "uint", "float", "int32", "uint32", "float32"), 4),
    **dict.fromkeys(("double", "float64"), 8),
}


@dataclass
class _Element:
    """A table of the file: its rows, and (bytes of a list's count or 0, bytes of a value) each."""

    rows: int
    columns: list[tuple[int, int]] = field(default_factory=list)


def require_whole_ply(path: Path) -> None:
    """Refuse a PLY file that ends before its header says.

    Raises
    ------
    FileError
        If it is no PLY file, its header cannot be understood, or rows are missing.
    """
    content = path.read_bytes()
    head, mark, body = content.partition(b"end_header")
    lines = head.decode("ascii", "replace").splitlines()
    if not mark or lines[0] != "ply":
        raise FileError(f"expected a PLY file, got no whole header in {path}")
    try:
        form, elements = _parse(lines[1:])
    except (KeyError, ValueError, IndexError):
        raise FileError(f"expected a PLY header, got one not understood in {path}") from None
    body = body.removeprefix(b"\r").removeprefix(b"\n")
    if form == "ascii":
        whole = _is_whole_text(body, elements)
    else:
        whole = _is_whole(body, "little" if form == "binary_little_endian" else "big", elements)
    if not whole:
        raise FileError(f"expected a whole PLY file, got {path}: it ends before its header says")


def _parse(lines: list[str]) -> tuple[str, list[_Element]]:
    """Return the format and the elements of a header."""
    form, elements = "", list[_Element]()
    for words in (line.split() for line in lines):
        match words:
            case ["format", ("ascii" | "binary_little_endian" | "binary_big_endian") as form, _]:
                pass
            case ["element", _, rows]:
                elements.append(_Element(int(rows)))
            case ["property", "list", count, value, _]:
                elements[-1].columns.append((_BYTES[count], _BYTES[value]))
            case ["property", value, _]:
                elements[-1].columns.append((0, _BYTES[value]))
    if not form:
        raise ValueError("no format")
    return form, [element for element in elements if element.rows]


def _is_whole_text(body: bytes, elements: list[_Element]) -> bool:
    """Return whether every row has its line, and the last as many words as it says."""
    lines = [line for line in body.splitlines() if line.strip()]
    rows = sum(element.rows for element in elements)
    if not 0 < rows <= len(lines):
        return rows == 0
    words = lines[rows - 1].split()
    expected = 0
    for count, _ in elements[-1].columns:
        has_count = count and expected < len(words)
        expected += 1 + (int(words[expected]) if has_count else 0)
    return expected <= len(words)


def _is_whole(body: bytes, order: Literal["little", "big"], elements: list[_Element]) -> bool:
    """Return whether the rows of every element lie within a binary body."""
    position = 0
    for element in elements:
        size, counts = _measure_row(body, position, order, element)
        end = position + element.rows * size
        if end <= len(body):
            # nearly always all lists are as long as those of the first row
            table = np.frombuffer(body, np.uint8, end - position, position).reshape(-1, size)
            if all((table[:, count] == table[0, count]).all() for count in counts):
                position = end
                continue
        for _ in range(element.rows):
            position += _measure_row(body, position, order, element)[0]
            if position > len(body):
                return False
    return True


def _measure_row(
    body: bytes, position: int, order: Literal["little", "big"], element: _Element
) -> tuple[int, list[slice]]:
    """Return the bytes of the row at `position`, and where in it the counts of its lists are."""
    size, counts = 0, []
    for count, value in element.columns:
        length = 1
        if count:
            counts.append(slice(size, size + count))
            start = position + size
            length = int.from_bytes(body[start : start + count], order)
            size += count
        size += length * value
    return size, counts
