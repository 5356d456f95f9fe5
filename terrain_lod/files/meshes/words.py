"""Numbers in lines of text, all at once; one by one where that does not work, to say why."""

from __future__ import annotations

import warnings
from codecs import BOM_UTF8
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from .raw import Integers

Bytes = npt.NDArray[np.uint8]

_SPACE, _NEWLINE, _SLASH, _MINUS, _NINE = b" \n/-9"
_ZERO: Final = ord("0")
_DIGITS: Final = 18  # that 64 bits hold whatever they are
# what separates words and is no end of a line
_BLANKS: Final = bytes.maketrans(b"\t\v\f\r", b"    ")


def text_of(path: Path) -> bytes:
    """Return a file without the mark that some editors put before text."""
    return path.read_bytes().removeprefix(BOM_UTF8)


def numbers(rows: Sequence[bytes], width: int, what: str) -> npt.NDArray[np.float64]:
    """Return the first `width` numbers of each row of text, (N, width).

    Raises
    ------
    ValueError
        Names the first row that has not so many, as `what`.
    """
    text = b"\n".join(rows)
    found = None
    if text.count(b"\n") == len(rows) - 1:
        found = numbers_of_lines(text + b"\n", width)
    return _one_by_one(rows, width, what) if found is None else found


def numbers_of_lines(text: bytes, width: int) -> npt.NDArray[np.float64] | None:
    """Return the first `width` numbers of each line; None where a line has others or fewer.

    Parameters
    ----------
    text : bytes
        Lines, each with its end.
    width : int
    """
    text = text.translate(_BLANKS)
    letters = np.frombuffer(text, np.uint8)
    words, line = words_of_lines(letters)
    counts = np.bincount(line, minlength=text.count(b"\n"))
    if not counts.size:
        return np.zeros((0, width))
    if counts.min() < width:
        return None
    values = _parsed(text, np.float64)
    # a word that is no number ends it, and one that is several makes more
    if len(values) != len(words):
        return None
    firsts = np.cumsum(counts) - counts
    return np.asarray(values[firsts[:, None] + np.arange(width)])


def words_of_lines(letters: Bytes) -> tuple[Integers, Integers]:
    """Return where words begin, and the number of the line that each is in."""
    is_end = letters == _NEWLINE
    begins = _begins(~(is_end | (letters == _SPACE)))
    return np.flatnonzero(begins), _count(is_end, begins)


def whole_numbers_of_words(
    letters: Bytes, words: Integers, width: int
) -> tuple[Integers, npt.NDArray[np.bool_]] | None:
    """Return the numbers in words such as ``1/-2/3``, and which are negative; both (W, width).

    A number that is left out is 0. None where a word is something else.
    """
    is_digit = (letters >= _ZERO) & (letters <= _NINE)
    is_slash, is_minus = letters == _SLASH, letters == _MINUS
    is_between = is_slash | (letters == _SPACE) | (letters == _NEWLINE)
    begins = _begins(is_digit)
    # a minus stands between what is no digit and a digit
    minuses = np.flatnonzero(is_minus)
    is_sign = np.append(True, is_between)[minuses] & np.append(begins, False)[minuses + 1]
    if not (is_digit | is_between | is_minus).all() or not is_sign.all():
        return None
    # 19 digits may be too many for 64 bits
    places = np.flatnonzero(begins)
    lengths = np.flatnonzero(_begins(is_digit[::-1])[::-1]) + 1 - places
    plain = letters.copy()
    plain[is_slash | is_minus] = _SPACE
    values = _parsed(plain.tobytes(), np.int64)
    if len(values) != len(places) or lengths.max(initial=0) > _DIGITS:
        return None
    negative = np.append(False, is_minus)[places] if minuses.size else np.zeros(len(places), bool)
    table = np.zeros((2, len(words), width), np.int64)
    each, rest = divmod(len(places), max(len(words), 1))
    slashes = np.count_nonzero(is_slash)
    starts = places - negative
    even = each > 0 and rest == 0 and slashes == (each - 1) * len(words)
    if even and (starts[::each] == words).all():
        # as a rule: as many in every word, none left out
        few = min(each, width)
        table[..., :few] = np.stack([values, negative]).reshape(2, -1, each)[..., :few]
    else:
        is_word, is_start = (np.zeros(len(letters), np.bool_) for _ in range(2))
        is_word[words] = is_start[starts] = True
        word = _count(is_word, is_start) + is_word[starts] - 1
        number = _count(is_slash, is_start) - _count(is_slash, is_word)[word]
        kept = number < width
        table[:, word[kept], number[kept]] = values[kept], negative[kept]
    return table[0], table[1].astype(np.bool_)


def _begins(inside: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Return the first places of runs."""
    begins = inside.copy()
    begins[1:] &= ~inside[:-1]
    return begins


def _count(which: npt.NDArray[np.bool_], at: npt.NDArray[np.bool_]) -> Integers:
    """Return how many of the one are before each of the other."""
    # these few alone: arrays as long as the text take long
    places = np.flatnonzero(which | at)
    is_one = which[places]
    return (np.cumsum(is_one) - is_one)[at[places]]


def _parsed(text: bytes, dtype: Any) -> npt.NDArray[Any]:
    """Return the numbers in text, up to what is none."""
    if not text.strip():  # where NumPy finds one
        return np.zeros(0, dtype)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # that it ended early
        try:
            return np.fromstring(text, dtype, sep=" ")
        except ValueError:
            return np.zeros(0, dtype)


def _one_by_one(rows: Sequence[bytes], width: int, what: str) -> npt.NDArray[np.float64]:
    values = []
    for row in rows:
        try:
            values.append([float(word) for word in row.split()[:width]])
        except ValueError:
            values.append([])
        if len(values[-1]) != width:
            shown = row[:40].decode(errors="replace").strip()
            raise ValueError(f"expected {width} numbers of {what}, got {shown!r}")
    return np.array(values, np.float64).reshape(len(rows), width)
