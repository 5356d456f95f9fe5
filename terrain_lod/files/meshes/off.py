"""Object File Format, read: OFF in text, with normals, colours and polygons.

::

    OFF                     or COFF, NOFF, CNOFF, STOFF ...; # begins a comment anywhere
    4 1 0                   vertices, faces, edges
    0 0 0                   x y z, then normals and colours where the first line says so
    ...
    4 0 1 2 3               how many corners, the corners, perhaps a colour

Geomview manual, *OFF Files*, http://www.geomview.org/docs/html/OFF.html
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Final

import numpy as np

from .raw import RawMesh
from .words import numbers, text_of

_KEYWORD: Final = re.compile(rb"(ST)?(C)?(N)?(4)?(n)?OFF\b")


def read_off(path: Path) -> RawMesh:
    """Return the faces of a file, colours left aside.

    Raises
    ------
    ValueError
        If it is damaged, binary, or not of three dimensions.
    """
    text = text_of(path)
    lines = [line.partition(b"#")[0].strip() for line in text.splitlines()]
    lines = [line for line in lines if line]
    keyword = _KEYWORD.match(lines[0]) if lines else None
    if keyword is None:
        raise ValueError("it does not begin with OFF")
    has_normals, has_four, has_any = (keyword[group] for group in (3, 4, 5))
    # the counts may follow on the same line
    lines[0] = lines[0][keyword.end() :].strip()
    if has_four or has_any or b"BINARY" in lines[0]:
        raise ValueError(f"expected three dimensions in text, got {keyword[0].decode()}")
    lines = lines if lines[0] else lines[1:]
    counts = lines[0].split()[:2] if lines else []
    if len(counts) < 2:
        raise ValueError("it does not say how many vertices and faces it has")
    vertex_count, face_count = map(int, counts)
    if min(vertex_count, face_count) < 0 or len(lines) - 1 < vertex_count + face_count:
        raise ValueError("it ends before its header says")
    rows = numbers(lines[1 : 1 + vertex_count], 6 if has_normals else 3, "a vertex")
    sizes, corners = [], list[int]()
    for line in lines[1 + vertex_count : 1 + vertex_count + face_count]:
        size, *words = line.split()
        sizes.append(int(size))
        own = words[: sizes[-1]]
        if len(own) != sizes[-1]:
            raise ValueError(f"expected {sizes[-1]} corners of a face, got {len(own)}")
        corners += map(int, own)
    return RawMesh(
        rows[:, :3],
        np.array(corners, np.int64),
        np.array(sizes, np.int64),
        rows[:, 3:] if has_normals else None,
    ).note(text)
