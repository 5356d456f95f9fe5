"""Wavefront OBJ, read: positions, texture coordinates, normals and faces of all groups.

A corner is ``v``, ``v/vt``, ``v//vn`` or ``v/vt/vn``; counted from 1, or from the last so far, -1.
Alias|Wavefront: *Object Files (.obj)*, Advanced Visualizer Manual, appendix B1.
"""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from .raw import Floats, Integers, RawMesh, require_corners
from .words import numbers, numbers_of_lines, text_of, whole_numbers_of_words, words_of_lines

_LEFT_OUT: Final = {
    b"l": "lines",
    b"p": "points",
    b"curv": "curves",
    b"curv2": "curves",
    b"surf": "surfaces",
}
_SPACE, _NEWLINE = b" \n"
_BLANKS: Final = b"\t\v\f"
_INDENT: Final = re.compile(rb"\n +")
_COMMENT: Final = re.compile(rb"#[^\n]*")


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
    text = text_of(path)
    if b"\0" in text:
        raise ValueError("it is no text")
    lines = _Lines(text)
    points = _numbers(lines.behind(b"v"), 3, "a vertex")
    corners, sizes = _corners(lines)
    require_corners(corners[:, 0], sizes, len(points))
    # v may be missing: it is zero then
    pairs = lines.behind(b"vt").replace(b"\n", b" 0\n")
    textures = _numbers(pairs, 2, "texture coordinates")
    normals = _numbers(lines.behind(b"vn"), 3, "a normal")
    dropped = Counter[str]()
    for word, what in _LEFT_OUT.items():
        dropped[what] += int(np.count_nonzero(lines.beginning(word)))
    has_textures = _is_usable("texture coordinates", corners[:, 1], textures, dropped)
    has_normals = _is_usable("normals", corners[:, 2], normals, dropped)

    of_others = [
        (column, array)
        for column, array, has in ((1, textures, has_textures), (2, normals, has_normals))
        # what is numbered as the positions are belongs to them
        if has and not (len(array) == len(points) and (corners[:, column] == corners[:, 0]).all())
    ]
    key = corners[:, 0]
    for column, array in of_others:
        # numbers stay small: as many keys as there are different corners so far
        key = np.unique(key, return_inverse=True)[1] * (len(array) + 1) + corners[:, column]
    if of_others:
        _, first, vertex = np.unique(key, return_index=True, return_inverse=True)
        position, pair, direction = corners[first].T
    else:
        vertex, position = key, np.arange(len(points))
        pair = direction = position
    return RawMesh(
        points[position],
        vertex,
        sizes,
        normals[direction] if has_normals else None,
        textures[pair] if has_textures else None,
        dropped=dropped,
    ).note(text)


class _Lines:
    """The lines of a text: which of them begin with a word, and what they say behind it."""

    def __init__(self, text: bytes) -> None:
        if any(blank in text for blank in _BLANKS):
            text = text.translate(bytes.maketrans(_BLANKS, b" " * len(_BLANKS)))
        if b"\r" in text:
            text = text.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
        # long lines go on after a backslash
        text = b"\n" + text.replace(b"\\\n", b" ")
        if b"\n " in text:
            text = _INDENT.sub(b"\n", text)
        text = text.replace(b"\nfo ", b"\nf  ")
        # words are looked for a little behind the last line, too
        self._letters = np.frombuffer(text + b"\n" * 8, np.uint8)
        ends = np.flatnonzero(self._letters == _NEWLINE)[:-7] + 1
        self._starts, self._lengths = ends[:-1], np.diff(ends)

    def beginning(self, word: bytes) -> npt.NDArray[np.bool_]:
        """Return which lines begin with a word."""
        which = np.arange(len(self._starts))
        for place, letter in enumerate(word):
            which = which[self._letters[self._starts[which] + place] == letter]
        behind = self._letters[self._starts[which] + len(word)]
        found = np.zeros(len(self._starts), np.bool_)
        found[which[(behind == _SPACE) | (behind == _NEWLINE)]] = True
        return found

    def behind(self, word: bytes) -> bytes:
        """Return what the lines that begin with a word say behind it, comments left out."""
        which = self.beginning(word)
        letters = self._letters[1 : 1 + self._lengths.sum()][np.repeat(which, self._lengths)]
        starts = np.cumsum(self._lengths[which]) - self._lengths[which]
        letters[starts[:, None] + np.arange(len(word))] = _SPACE
        rest = letters.tobytes()
        return _COMMENT.sub(b"", rest) if b"#" in rest else rest


def _numbers(lines: bytes, width: int, what: str) -> npt.NDArray[np.float64]:
    found = numbers_of_lines(lines, width)
    # one by one, to say which is wrong, or to read what only Python reads
    return numbers(lines.splitlines(), width, what) if found is None else found


def _corners(lines: _Lines) -> tuple[Integers, Integers]:
    """Return (v, vt, vn) of each corner, counted from 0, -1 for none, (K, 3); and faces' sizes."""
    faces = lines.behind(b"f")
    letters = np.frombuffer(faces, np.uint8)
    words, line = words_of_lines(letters)
    found = whole_numbers_of_words(letters, words, 3)
    if found is None:
        raise ValueError("a face's corners are no whole numbers")
    corners, negative = found
    if negative.any():
        # counted from the last of the lines before each face
        is_face = lines.beginning(b"f")
        for column, word in enumerate((b"v", b"vt", b"vn")):
            so_far = np.cumsum(lines.beginning(word))[is_face][line] + 1
            corners[:, column] = np.where(
                negative[:, column], so_far - corners[:, column], corners[:, column]
            )
    return corners - 1, np.bincount(line, minlength=faces.count(b"\n"))


def _is_usable(what: str, indices: Integers, array: Floats, dropped: Counter[str]) -> bool:
    """Return whether every corner has an entry; note those that are no use."""
    if not indices.size or (indices.max() < 0 and not len(array)):
        return False
    if 0 <= indices.min() <= indices.max() < len(array):
        return True
    if len(array) or indices.max() >= 0:
        dropped[f"{what}, as not every corner has them"] += len(array)
    return False
