"""Numbers of formulas: what they may be, where their sliders end, what a viewer begins with."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pytest

import terrain_lod as tl
from terrain_lod.numbered import TILE, Number, begin, checked_numbers, numbers_of, with_number


@pytest.mark.parametrize(
    ("number", "value", "message"),
    [
        (Number(1.0), 0, "expected size > 0, got 0"),
        (Number(1.0, high=9), 10, "expected size above 0, at most 9, got 10"),
        (Number(1.0, low=0.5), 0.25, "expected size >= 0.5, got 0.25"),
        (Number(1.0, low=0.5, high=2), 3, "expected size from 0.5 to 2, got 3"),
        (Number(1.0, low=0, step=0.5), 0.75, "expected a multiple of 0.5 for size, got 0.75"),
        (Number(1, low=1, high=9, step=1), 1.5, "a whole number from 1 to 9 for size, got 1.5"),
        (Number(1.0), math.nan, "expected a finite size, got nan"),
        (Number(1.0), "1", "expected a number for size, got '1'"),
        (Number(1.0), None, "expected a number for size, got None"),
    ],
)
def test_a_number_out_of_its_range_is_told_the_range(number, value, message) -> None:
    with pytest.raises(tl.InputError) as caught:
        number.checked("size", value)
    assert message in str(caught.value)


def test_numbers_at_the_ends_of_their_range() -> None:
    assert Number(1.0, low=0.5, high=2).checked("size", 0.5) == 0.5
    assert Number(1.0, low=0.5, high=2).checked("size", 2) == 2.0
    assert isinstance(Number(1, low=1, high=9, step=1).checked("size", 3.0), int)
    assert isinstance(Number(1.0).checked("size", 3), float)


def test_lengths_are_in_diagonals() -> None:
    length = Number(None, unit="m", shown=(0.01, 2.0), start=0.5)
    assert length.slider(200.0) == (2.0, 400.0)
    assert length.begin(200.0, 7) == 100.0
    assert Number(3.0, shown=(1, 4)).slider(200.0) == (1, 4)
    assert Number(3.0, low=0, high=9).slider(200.0) == (0, 9)
    assert Number(3.0).slider(200.0) is None


def test_what_a_viewer_begins_with() -> None:
    @dataclass(frozen=True)
    class OwnLod(tl.Lod):
        ranged: float = tl.number(low=2, high=5)
        tilewise: float = tl.number(15.0, low=1, high=63, start=TILE)
        plain: float = 3.5

    assert begin(OwnLod, 100.0, 7) == OwnLod(ranged=2, tilewise=7, plain=3.5)
    assert begin(OwnLod, 100.0) == OwnLod(ranged=2, tilewise=15, plain=3.5)
    assert list(numbers_of(OwnLod)) == ["ranged", "tilewise", "plain"]

    @dataclass(frozen=True)
    class UnknownLod(tl.Lod):
        steep: float

    with pytest.raises(tl.InputError, match="a start or a range for steep of UnknownLod"):
        begin(UnknownLod, 100.0)


def test_a_number_moves_its_opposite_out_of_the_way() -> None:
    lod = tl.DistanceLod(near=10, far=50, minimum=2, maximum=9)
    assert with_number(lod, "minimum", 12, diagonal=100) == tl.DistanceLod(10, 50, 12, 12)
    assert with_number(lod, "maximum", 1, diagonal=100) == tl.DistanceLod(10, 50, 1, 1)
    assert with_number(lod, "near", 60, diagonal=100) == tl.DistanceLod(60, 61, 2, 9)
    assert with_number(lod, "far", 5, diagonal=100) == tl.DistanceLod(4, 5, 2, 9)
    assert with_number(lod, "falloff", 2, diagonal=100) == tl.DistanceLod(10, 50, 2, 9, 2)


def test_a_class_must_be_a_dataclass() -> None:
    class PlainLod(tl.Lod):
        steep: float = 3.0

    with pytest.raises(tl.InputError, match="above class PlainLod, got none"):
        PlainLod().numbers()


def test_unknown_numbers_are_refused() -> None:
    with pytest.raises(tl.InputError, match="unknown tube= for egg: expected radius"):
        checked_numbers("egg", {"radius": Number(1.0)}, {"tube": 1})
