"""PLY, read: text and binary of either order, faces and triangle strips.

Turk: *The PLY Polygon File Format*, 1994.
"""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from .raw import Integers, RawMesh, of_triangles, strips_to_triangles
from .words import numbers

_TYPES: Final = {
    name: code
    for code, names in {
        "i1": "char int8", "u1": "uchar uint8", "i2": "short int16", "u2": "ushort uint16",
        "i4": "int int32", "u4": "uint uint32", "i8": "int64", "u8": "uint64",
        "f4": "float float32", "f8": "double float64",
    }.items()
    for name in names.split()
}  # fmt: skip
_ORDERS: Final = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_END: Final = re.compile(rb"(?:^|[\r\n])end_header[ \t]*(?:\r\n|\n|\r)")
_INDICES: Final = ("vertex_indices", "vertex_index")
_TEXTURES: Final = (("u", "v"), ("s", "t"), ("texture_u", "texture_v"), ("texture_s", "texture_t"))


@dataclass(frozen=True)
class _Property:
    """A column of a table: its type, and that of the count before it where it is a list."""

    name: str
    kind: str
    count: str = ""


@dataclass(frozen=True)
class _Element:
    """A table of the file."""

    name: str
    rows: int
    properties: list[_Property] = field(default_factory=list)


# a column's values, all rows after another, and how many each row has
_Column = tuple[npt.NDArray[Any], Integers]


def read_ply(path: Path) -> RawMesh:
    """Return the faces and strips of a file, colours and the rest left aside.

    In text, a row is a line; words beyond what the header says are left out and counted.

    Raises
    ------
    ValueError
        If it is damaged, or ends before its header says.
    """
    content = path.read_bytes()
    end = _END.search(content)
    if content[:3] != b"ply" or end is None:
        raise ValueError("it has no whole PLY header")
    order, elements = _parse(content[: end.start()].decode("ascii", "replace"))
    body, dropped = content[end.end() :], Counter[str]()
    if order:
        tables = _binary_tables(body, order, elements)
    else:
        tables = _text_tables(body, elements, dropped)

    vertices = tables.get("vertex", {})
    points = _columns(vertices, ("x", "y", "z"))
    if points is None:
        raise ValueError("its vertices have no x, y and z")
    corners, sizes = _lists(tables.get("face", {}))
    strips, lengths = _lists(tables.get("tristrips", {}))
    if len(strips):
        more_corners, more_sizes = of_triangles(_strip_triangles(strips, lengths))
        corners = np.concatenate([corners, more_corners])
        sizes = np.concatenate([sizes, more_sizes])
    for element in elements:
        if element.name not in ("vertex", "face", "tristrips") and element.rows:
            dropped[f"rows of {element.name!r}"] += element.rows
    textures = (_columns(vertices, pair) for pair in _TEXTURES)
    return RawMesh(
        points,
        corners,
        sizes,
        _columns(vertices, ("nx", "ny", "nz")),
        next((pair for pair in textures if pair is not None), None),
        dropped=dropped,
    ).note(content[: end.start()])


def _parse(header: str) -> tuple[str, list[_Element]]:
    """Return the byte order, empty for text, and the elements of a header."""
    order, elements = None, list[_Element]()
    try:
        for words in (line.split() for line in header.splitlines()):
            match words:
                case ["format", form, _]:
                    order = _ORDERS[form]
                case ["element", name, rows]:
                    elements.append(_Element(name, int(rows)))
                case ["property", "list", count, kind, name]:
                    if _TYPES[count][0] == "f":
                        raise ValueError
                    column = _Property(name, _TYPES[kind], _TYPES[count])
                    elements[-1].properties.append(column)
                case ["property", kind, name]:
                    elements[-1].properties.append(_Property(name, _TYPES[kind]))
    except (KeyError, ValueError, IndexError):
        raise ValueError(f"its header has {' '.join(words)[:60]!r}") from None
    if order is None or any(element.rows < 0 for element in elements):
        raise ValueError("its header is not understood")
    return order, [element for element in elements if element.properties]


def _columns(table: dict[str, _Column], names: tuple[str, ...]) -> npt.NDArray[Any] | None:
    """Return single numbers as an array (rows, names), float32 where all are; None if some lack."""
    if not all(name in table for name in names):
        return None
    columns = [table[name][0] for name in names]
    single = all(column.dtype.kind == "f" and column.itemsize == 4 for column in columns)
    return np.stack(columns, axis=1).astype(np.float32 if single else np.float64)


def _lists(table: dict[str, _Column]) -> tuple[Integers, Integers]:
    """Return the vertex indices of a table, and how many each row has."""
    for name in _INDICES:
        if name in table:
            values, counts = table[name]
            return values.astype(np.int64), counts
    return np.zeros(0, np.int64), np.zeros(0, np.int64)


def _strip_triangles(values: Integers, lengths: Integers) -> Integers:
    """Return the triangles (T, 3) of strips, which -1 ends as the end of a row does."""
    row = np.repeat(np.arange(len(lengths)), lengths)
    strip = row + np.cumsum(values < 0)
    inside = values >= 0
    _, sizes = np.unique(strip[inside], return_counts=True)
    return strips_to_triangles(values[inside], sizes)


# binary


def _binary_tables(
    body: bytes, order: str, elements: list[_Element]
) -> dict[str, dict[str, _Column]]:
    tables, position = {}, 0
    for element in elements:
        found = _even_table(body, position, order, element)
        tables[element.name], position = found or _uneven_table(body, position, order, element)
    return tables


def _even_table(
    body: bytes, position: int, order: str, element: _Element
) -> tuple[dict[str, _Column], int] | None:
    """Return a table whose lists are as long in all rows, and where it ends; None for others."""
    fields: list[Any] = []
    size = 0
    for index, column in enumerate(element.properties):
        length: tuple[int, ...] = ()
        if column.count:
            count = np.dtype(order + column.count)
            raw = body[position + size : position + size + count.itemsize]
            if len(raw) < count.itemsize or element.rows == 0:
                return None
            length = (int(np.frombuffer(raw, count)[0]),)
            if not 0 <= length[0] <= len(body):
                return None
            fields.append((f"count {index}", count))
            size += count.itemsize
        kind = np.dtype(order + column.kind)
        fields.append((f"value {index}", kind, *((length,) if length else ())))
        size += kind.itemsize * (length[0] if length else 1)
    if size * element.rows > len(body) - position:
        return None
    rows = np.frombuffer(body, np.dtype(fields), element.rows, position)
    table = {}
    for index, column in enumerate(element.properties):
        values = rows[f"value {index}"]
        if column.count and (rows[f"count {index}"] != values.shape[1]).any():
            return None
        width = values.shape[1] if column.count else 1
        table[column.name] = values.ravel(), np.full(element.rows, width, np.int64)
    return table, position + size * element.rows


def _uneven_table(
    body: bytes, position: int, order: str, element: _Element
) -> tuple[dict[str, _Column], int]:
    """Return any table, row by row, and where it ends."""
    sizes = [
        (column.count and np.dtype(column.count).itemsize, np.dtype(column.kind).itemsize)
        for column in element.properties
    ]
    signed = [column.count[:1] == "i" for column in element.properties]
    byte_order = "little" if order == "<" else "big"
    pieces: list[list[bytes]] = [[] for _ in sizes]
    counts: list[list[int]] = [[] for _ in sizes]
    for _ in range(element.rows):
        for index, (count_size, value_size) in enumerate(sizes):
            count = 1
            if count_size:
                raw = body[position : position + count_size]
                count = int.from_bytes(raw, byte_order, signed=signed[index])  # type: ignore[arg-type]
                position += count_size
            end = position + count * value_size
            if count < 0 or end > len(body) or position > len(body):
                raise ValueError(f"it ends before its {element.rows} rows of {element.name!r}")
            pieces[index].append(body[position:end])
            counts[index].append(count)
            position = end
    return {
        column.name: (
            np.frombuffer(b"".join(pieces[index]), order + column.kind),
            np.array(counts[index], np.int64),
        )
        for index, column in enumerate(element.properties)
    }, position


# text


def _text_tables(
    body: bytes, elements: list[_Element], dropped: Counter[str]
) -> dict[str, dict[str, _Column]]:
    lines = [line for line in body.splitlines() if line.strip()]
    tables, first = {}, 0
    for element in elements:
        rows = lines[first : first + element.rows]
        first += element.rows
        if len(rows) < element.rows:
            raise ValueError(f"it ends before its {element.rows} rows of {element.name!r}")
        tables[element.name], longer = _text_table(rows, element)
        if longer:
            dropped[f"ends of rows of {element.name!r}, longer than the header says"] += longer
    return tables


def _text_table(rows: list[bytes], element: _Element) -> tuple[dict[str, _Column], int]:
    """Return a table in text, and how many of its rows are longer than they should be."""
    if not any(column.count for column in element.properties):
        width = len(element.properties)
        values = numbers(rows, width, f"a {element.name}")
        longer = sum(len(row.split()) > width for row in rows)
        ones = np.ones(len(rows), np.int64)
        return {
            column.name: (values[:, index], ones) for index, column in enumerate(element.properties)
        }, longer
    words: list[list[bytes]] = [[] for _ in element.properties]
    counts: list[list[int]] = [[] for _ in element.properties]
    longer = 0
    for row in rows:
        own, place = row.split(), 0
        for index, column in enumerate(element.properties):
            count = 1
            if column.count:
                count = int(own[place]) if place < len(own) else -1
                place += 1
            if count < 0 or place + count > len(own):
                shown = row[:40].decode(errors="replace").strip()
                raise ValueError(f"expected a row of {element.name!r}, got {shown!r}")
            words[index] += own[place : place + count]
            counts[index].append(count)
            place += count
        longer += place < len(own)
    return {
        column.name: (
            # whole numbers to index with are lists' alone; text may have more digits than float32
            np.fromiter(map(float, words[index]), np.float64)
            if column.kind[0] == "f" or not column.count
            else np.fromiter(map(int, words[index]), np.int64),
            np.array(counts[index], np.int64),
        )
        for index, column in enumerate(element.properties)
    }, longer
