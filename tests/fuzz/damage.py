"""Bytes with a thing wrong, or two."""

from __future__ import annotations

import random
from typing import Final

_HOSTILE: Final = (
    b"0", b"-1", b"1e39", b"nan", b"inf", b"1e999", b"99999999999", b"4294967295", b"2147483648",
    b"1e-320", b"1_0", b"\xd9\xa3", b"", b"\0",
)  # fmt: skip
_WORDS: Final = (b"\xff" * 4, b"\0" * 4, b"\0\0\xc0\x7f", b"\0\0\x80\x7f", b"\xff\xff\xff\x7f")


def damaged(content: bytes, chance: random.Random) -> bytes:
    """Return a file's bytes, changed in one place or two."""
    data = bytearray(content)
    for _ in range(chance.randint(1, 2)):
        # headers are where files are understood
        end = len(data) if chance.random() < 0.5 else min(len(data), 600)
        place = chance.randrange(end + 1)
        kind = chance.randrange(7)
        if kind == 0 and place < len(data):
            data[place] = chance.randrange(256)
        elif kind == 1 and place < len(data):
            data[place] ^= 1 << chance.randrange(8)
        elif kind == 2:
            del data[place : place + chance.choice((1, 2, 4, 40))]
        elif kind == 3:
            data[place:place] = data[place : place + chance.choice((1, 4, 40))]
        elif kind == 4:
            del data[place:]
        elif kind == 5:
            word = chance.choice(_WORDS)
            data[place : place + len(word)] = word
        else:
            data = _with_hostile_number(data, place, chance)
    return bytes(data)


def _with_hostile_number(data: bytearray, place: int, chance: random.Random) -> bytearray:
    """Return data with the next of its numbers in text replaced."""
    starts = (i for i in range(place, len(data)) if chr(data[i]) in "0123456789-")
    start = end = next(starts, len(data))
    while end < len(data) and chr(data[end]) in "0123456789.-+e":
        end += 1
    return data[:start] + chance.choice(_HOSTILE) + data[end:]
