"""Wavefront OBJ, read: positions, texture coordinates, normals and faces of all groups.

A corner is ``v``, ``v/vt``, ``v//vn`` or ``v/vt/vn``; counted from 1, or from the last so far, -1.
Alias|Wavefront: *Object Files (.obj)*, Advanced Visualizer Manual, appendix B1.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Final

import numpy as np

from .raw import Floats, Integers, RawMesh, numbers, require_corners

_LEFT_OUT: Final = {
    b"l": "lines",
    b"p": "points",
    b"curv": "curves",
    b"curv2": "curves",
    b"surf": "surfaces",
}


def read_obj(path: Path) -> RawMesh:
    """Return the faces of all groups and objects of a file, materials left aside.

    A position that is used with several texture coordinates or normals is a vertex for each.
    Both are kept where every corner has one that is there.

    Raises
    ------
    ValueError
        If it is damaged.
    InputError
        If a corner is no vertex.
    """
    text = path.read_bytes()
    if b"\0" in text:
        raise ValueError("it is no text")
    # long lines go on after a backslash
    joined = text.replace(b"\t", b" ").replace(b"\\\r\n", b" ").replace(b"\\\n", b" ")
    rows: dict[bytes, list[bytes]] = {b"v": [], b"vt": [], b"vn": []}
    positions, pairs, directions = rows.values()
    faces, dropped = list[bytes](), Counter[str]()
    for line in joined.splitlines():
        kind, _, rest = line.strip().partition(b" ")
        if kind in rows:
            rows[kind].append(rest)
        elif kind in (b"f", b"fo"):
            if b"#" in rest:
                rest = rest.partition(b"#")[0]
            if b"-" in rest:
                rest = _from_the_first(rest, (len(positions), len(pairs), len(directions)))
            faces.append(rest)
        elif kind in _LEFT_OUT:
            dropped[_LEFT_OUT[kind]] += 1

    points = numbers(positions, 3, "a vertex")
    corners, sizes = _corners(faces)
    require_corners(corners[:, 0], sizes, len(points))
    # v may be missing: it is zero then
    textures = numbers([row + b" 0" for row in pairs], 2, "texture coordinates")
    normals = numbers(directions, 3, "a normal")
    has_textures = _is_usable("texture coordinates", corners[:, 1], textures, dropped)
    has_normals = _is_usable("normals", corners[:, 2], normals, dropped)

    key = corners[:, 0]
    for column, array, has in ((1, textures, has_textures), (2, normals, has_normals)):
        if has:
            # numbers stay small: as many keys as there are different corners so far
            key = np.unique(key, return_inverse=True)[1] * (len(array) + 1) + corners[:, column]
    if not (has_textures or has_normals):
        return RawMesh(points, key, sizes, dropped=dropped).note(text)
    _, first, vertex = np.unique(key, return_index=True, return_inverse=True)
    return RawMesh(
        points[corners[first, 0]],
        vertex,
        sizes,
        normals[corners[first, 2]] if has_normals else None,
        textures[corners[first, 1]] if has_textures else None,
        dropped=dropped,
    ).note(text)


class _Seen(dict[bytes, int]):
    """The different corners of a file, each understood once and numbered."""

    def __init__(self) -> None:
        self.corners: list[tuple[int, ...]] = []

    def __missing__(self, corner: bytes) -> int:
        places = [int(number or 0) - 1 for number in corner.split(b"/")]
        self.corners.append((*places, -1, -1)[:3])
        return self.setdefault(corner, len(self))


def _corners(faces: list[bytes]) -> tuple[Integers, Integers]:
    """Return (v, vt, vn) of each corner, counted from 0, -1 for none, (K, 3); and faces' sizes."""
    seen = _Seen()
    try:
        which = np.fromiter((seen[word] for face in faces for word in face.split()), np.int64)
        table = np.array(seen.corners, np.int64).reshape(-1, 3)
    except (ValueError, OverflowError):
        raise ValueError("a face's corners are no whole numbers") from None
    return table[which], np.fromiter((len(face.split()) for face in faces), np.int64)


def _from_the_first(face: bytes, counts: tuple[int, ...]) -> bytes:
    """Return a face whose corners, counted from the last so far, are counted from the first."""
    return b" ".join(
        b"/".join(
            b"%d" % (count + 1 + int(number)) if number.startswith(b"-") else number
            for number, count in zip(corner.split(b"/"), counts, strict=False)
        )
        for corner in face.split()
    )


def _is_usable(what: str, indices: Integers, array: Floats, dropped: Counter[str]) -> bool:
    """Return whether every corner has an entry; note those that are no use."""
    if not indices.size or (indices.max() < 0 and not len(array)):
        return False
    if 0 <= indices.min() <= indices.max() < len(array):
        return True
    if len(array) or indices.max() >= 0:
        dropped[f"{what}, as not every corner has them"] += len(array)
    return False
