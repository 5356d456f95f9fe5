"""Which points of a line are kept."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from terrain_lod.tilesets.borders import kept_points


def test_a_straight_line_keeps_its_ends():
    assert kept_points(np.linspace(3, 90, 50), 1e-9).tolist() == [0, 49]


def test_a_bend_is_kept_where_it_is_too_high():
    heights = np.array([0.0, 1, 2, 1, 0])
    assert kept_points(heights, 0.5).tolist() == [0, 2, 4]
    assert kept_points(heights, 2.0).tolist() == [0, 4]


@given(
    heights=st.lists(st.floats(-500, 500), min_size=2, max_size=60),
    tolerance=st.floats(0.01, 100),
)
def test_no_point_is_farther_than_allowed(heights, tolerance):
    heights = np.array(heights)
    kept = kept_points(heights, tolerance)
    line = np.interp(np.arange(len(heights)), kept, heights[kept])
    assert abs(line - heights).max() <= tolerance * (1 + 1e-9) + 1e-9
