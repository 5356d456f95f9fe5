"""Welding and pairing: against plain counting."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from terrain_lod.mesh.open_edges import topology, weld


@given(st.lists(st.tuples(*3 * [st.sampled_from([0.0, -0.0, 1.0, 1e-45, -1.0, 3e38])]), min_size=1))
def test_welding_is_equality_of_positions(positions):
    numbers = weld(np.array(positions, np.float32))
    same = {tuple(np.float32(position) + 0) for position in positions}
    assert set(numbers.tolist()) == set(range(len(same)))
    by_number = {}
    for number, position in zip(numbers.tolist(), positions, strict=True):
        assert by_number.setdefault(number, position) == position


@settings(deadline=None)
@given(st.lists(st.tuples(*3 * [st.integers(0, 6)]), max_size=30))
def test_pairing_agrees_with_counting(triangles):
    found = topology(np.array(triangles, np.int64).reshape(-1, 3))
    # what is left has three different corners and no triangle twice
    left = {min((t, t[1:] + t[:1], t[2:] + t[:2])) for t in triangles if len(set(t)) == 3}
    uses = {}
    for a, b, c in left:
        for edge, apex in (((a, b), c), ((b, c), a), ((c, a), b)):
            uses.setdefault(edge, []).append(apex)
    both = {tuple(sorted(edge)) for edge in uses}
    counts = {e: (len(uses.get(e, [])), len(uses.get(e[::-1], []))) for e in both}
    single = {e if c[0] else e[::-1] for e, c in counts.items() if sum(c) == 1}
    assert {tuple(edge) for edge in found.open_edges.tolist()} == single
    assert len(found.open_edges) == len(single)
    for edge, apex in zip(found.open_edges.tolist(), found.open_apexes.tolist(), strict=True):
        assert uses[tuple(edge)] == [apex]
    assert found.unbalanced == sum(c[0] != c[1] and sum(c) > 1 for c in counts.values())
    # repetitions are looked for where edges do not cancel: a closed one stays
    kept = len(found.triangles)
    assert len(left) <= kept <= sum(len(set(t)) == 3 for t in triangles)
    assert found.left_out == len(triangles) - kept
