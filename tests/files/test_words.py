"""Numbers in text, read all at once, are those that Python reads one by one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from terrain_lod.files.meshes.words import numbers, whole_numbers_of_words, words_of_lines

NUMBERS = st.one_of(
    st.integers(-(10**20), 10**20).map(str),
    st.floats().map(repr),
    st.sampled_from(["1e39", "-0", ".5", "5.", "+3", "1E-320", "nan", "inf", "007"]),
)
ODD = st.sampled_from(["1_0", "0x10", "-", "1-2", "1e", "--1", "#", "1,5", "٣", "1d3", "infinit"])
GAPS = st.sampled_from([" ", "  ", "\t", " \v"])


@given(st.lists(st.lists(st.tuples(GAPS, NUMBERS | ODD), min_size=1, max_size=5), max_size=8))
def test_numbers_are_those_that_python_reads(drawn: list[list[tuple[str, str]]]) -> None:
    rows = ["".join(gap + word for gap, word in row).encode() for row in drawn]
    try:
        expected = np.array([[float(word) for word in row.split()[:3]] for row in rows])
        expected = expected.reshape(len(rows), 3)
    except ValueError:
        with pytest.raises(ValueError, match="expected 3 numbers of a row, got "):
            numbers(rows, 3, "a row")
        return
    np.testing.assert_array_equal(numbers(rows, 3, "a row"), expected)


PARTS = st.one_of(st.just(""), st.integers(0, 10**18 - 1).map(str), st.sampled_from(["-1", "-20"]))
CORNERS = st.lists(PARTS, min_size=1, max_size=4).map("/".join).filter(bool)


@given(st.lists(st.lists(CORNERS, max_size=4), min_size=1, max_size=6))
def test_corners_are_those_that_python_reads(lines: list[list[str]]) -> None:
    text = "".join(" " + " ".join(words) + " \n" for words in lines)
    letters = np.frombuffer(text.encode(), np.uint8)
    words, line = words_of_lines(letters)
    assert line.tolist() == [number for number, words in enumerate(lines) for _ in words]
    found = whole_numbers_of_words(letters, words, 3)
    assert found is not None
    expected = [[*word.split("/"), "", ""][:3] for words in lines for word in words]
    assert found[0].tolist() == [[abs(int(part or 0)) for part in parts] for parts in expected]
    assert found[1].tolist() == [[part.startswith("-") for part in parts] for parts in expected]


@pytest.mark.parametrize("word", ["-", "1-2", "--1", "1.5", "a", "+1", "1_0", "1/-", "9" * 19])
def test_what_is_no_corner_is_none(word: str) -> None:
    letters = np.frombuffer(f"1 {word} 2\n".encode(), np.uint8)
    assert whole_numbers_of_words(letters, words_of_lines(letters)[0], 3) is None
