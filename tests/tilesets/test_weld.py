"""Outlines changed on drawn meshes: whole, without cracks, with exactly the borders asked for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from terrain_lod.tilesets.refine import insert
from terrain_lod.tilesets.weld import Outline

SIZE = 64
WHOLE = 2 * SIZE * SIZE


def grid(cells):
    """Return a square of so many cells along a side, each of two triangles."""
    step = SIZE // cells
    x, y = np.meshgrid(np.arange(cells + 1), np.arange(cells + 1))
    places = np.stack([x.ravel(), y.ravel()], axis=1).astype(np.int64) * step
    number = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    lower, upper = np.stack([a, b, c], -1), np.stack([a, c, d], -1)
    return places, np.concatenate([lower.reshape(-1, 3), upper.reshape(-1, 3)]).astype(np.int32)


def require_whole(places, triangles):
    corners = places[triangles]
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    areas = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    assert areas.min() > 0
    assert areas.sum() == WHOLE
    sides = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], -1), -1).reshape(-1, 2)
    unique, counts = np.unique(sides, axis=0, return_counts=True)
    assert counts.max() == 2
    outer = places[unique[counts == 1]]
    assert ((outer == 0) | (outer == SIZE)).all(axis=1).any(axis=1).all()


def border(places, triangles, axis, line):
    used = places[np.unique(triangles)]
    return sorted(used[used[:, 1 - axis] == line, axis].tolist())


inner = st.sets(st.integers(1, SIZE - 1), max_size=20)


@pytest.mark.slow
@given(cells=st.sampled_from([1, 2, 4, 8, 16]), sides=st.tuples(inner, inner, inner, inner))
def test_borders_become_what_is_asked_for(cells, sides):
    outline = Outline(*grid(cells), SIZE)
    wanted = [[0, *sorted(side), SIZE] for side in sides]
    lines = [(0, 0), (0, SIZE), (1, 0), (1, SIZE)]
    for (axis, line), side in zip(lines, wanted, strict=True):
        outline.fit(axis, line, side)
    places, triangles = outline.result()
    require_whole(places, triangles)
    for (axis, line), side in zip(lines, wanted, strict=True):
        assert border(places, triangles, axis, line) == side


def test_a_triangle_gives_way_to_three_around_a_point():
    places, triangles = grid(1)
    cut = insert(places, triangles, np.array([0]), np.array([[40, 10]]), SIZE)
    assert cut.triangles.tolist() == [[0, 1, 4], [0, 3, 2], [1, 3, 4], [3, 0, 4]]
    assert cut.parents.tolist() == [0, 0]
    assert cut.put.tolist() == [0]


def test_a_point_on_a_side_cuts_both_triangles_there():
    places, triangles = grid(1)
    cut = insert(places, triangles, np.array([0]), np.array([[32, 32]]), SIZE)
    assert len(cut.triangles) == 4
    require_whole(np.concatenate([places, [[32, 32]]]), cut.triangles)


def test_points_on_the_border_and_on_vertices_are_hopeless():
    places, triangles = grid(2)
    points = np.array([[10, 0], [32, 32], [20, 10]])
    cut = insert(places, triangles, np.array([0, 0, 0]), points, SIZE)
    assert cut.hopeless.tolist() == [0, 1]
    assert cut.put.tolist() == [2]


@pytest.mark.slow
@given(points=st.lists(st.tuples(st.integers(1, SIZE - 1), st.integers(1, SIZE - 1)), max_size=30))
def test_meshes_stay_whole_whatever_is_put_in(points):
    places, triangles = grid(4)
    for point in points:
        corners = places[triangles]
        inside = np.ones(len(triangles), bool)
        for i in range(3):
            a, b = corners[:, i], corners[:, (i + 1) % 3]
            inside &= (b[:, 0] - a[:, 0]) * (point[1] - a[:, 1]) >= (b[:, 1] - a[:, 1]) * (
                point[0] - a[:, 0]
            )
        owner = np.flatnonzero(inside)[:1]
        cut = insert(places, triangles, owner, np.array([point]), SIZE)
        places = np.concatenate([places, np.array([point])[cut.put]])
        triangles = cut.triangles
        require_whole(places, triangles)
