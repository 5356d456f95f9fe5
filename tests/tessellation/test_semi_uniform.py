"""Semi-uniform tessellation: what moves, what stays, and that nothing cracks."""

from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from terrain_lod.device.device import Device
from terrain_lod.device.layout import FIXED_ONE
from terrain_lod.errors import DeviceMemoryError, InputError
from terrain_lod.measure.cracks import crack_report
from terrain_lod.mesh.mesh import Mesh
from terrain_lod.tessellation.semi_uniform import lattice, semi_uniform

M = 5
ALL = np.array(list(product(range(M + 1), repeat=3)))


def corners_of(pattern, patch):
    """Return the triangles of a patch as barycentric coordinates in 16.16, (T, 3, 3)."""
    begin, end = pattern.triangle_offsets[patch : patch + 2]
    uv = pattern.points[pattern.triangles[begin:end]].astype(np.int64)
    return np.concatenate([uv, FIXED_ONE - uv.sum(axis=-1, keepdims=True)], axis=-1)


def boundary_points(pattern, patch):
    begin, end = pattern.point_offsets[patch : patch + 2]
    points = pattern.points[begin:end].astype(np.int64)
    return np.concatenate([points, FIXED_ONE - points.sum(axis=-1, keepdims=True)], axis=-1)


# what is promised of phi, for all 216 combinations


def test_points_inside_do_not_move_and_boundary_points_stand_on_their_edges_level():
    pattern = semi_uniform(ALL, maximum=M)
    for patch, levels in enumerate(ALL):
        points = boundary_points(pattern, patch)
        steps = 2 ** levels.max()
        inside = points[3 * steps :]
        assert (inside > 0).all()
        # all of the lattice's inside, each once, where the lattice has it
        assert (inside % (FIXED_ONE // steps) == 0).all()
        assert len(np.unique(inside, axis=0)) == len(inside) == (steps - 1) * (steps - 2) // 2
        for edge, level in enumerate(levels):
            on_edge = points[: 3 * steps][points[: 3 * steps, edge] == 0]
            along = np.unique(on_edge[:, edge - 1])
            np.testing.assert_array_equal(along, np.arange(2**level + 1) * FIXED_ONE // 2**level)


def test_triangles_cover_the_domain_once_and_none_folds_over():
    for keep in (True, False):
        pattern = semi_uniform(ALL, maximum=M, keep_degenerate=keep)
        for patch, levels in enumerate(ALL):
            uv = corners_of(pattern, patch)[..., :2]
            area = np.linalg.det((uv[:, 1:] - uv[:, :1]) / FIXED_ONE)
            assert (area >= 0).all(), levels
            assert area.sum() == pytest.approx(1)
            assert keep or (area > 0).all()


def joined_to_neighbours():
    """Return a mesh of every combination, its three neighbours of every level beside it.

    Corners of the triangle in the middle: u, v, w; of the neighbour across edge e: the two others
    the other way round, and a point outside.
    """
    corners = np.array([[4, 0], [0, 4], [0, 0]]) * 4096
    middle, others = corners, []
    for edge in range(3):
        a, b = corners[edge - 1], corners[edge - 2]
        outside = a + b - corners[edge]
        others.append(np.array([outside, a, b]))
    triangles = np.array([middle, *others])
    levels, places = [], []
    for number, (own, other) in enumerate(product(ALL, range(M + 1))):
        levels.append(own)
        levels += [(own[edge], other, other) for edge in range(3)]
        shift = np.array([number % 40, number // 40]) * 2**17
        places.append(triangles + shift)
    return np.array(levels), np.concatenate(places)


def unpaired_edges(at, edges):
    """Return how many directed edges (E, 2) between the points `at` have no opposite."""
    numbers = np.unique(at[edges], return_inverse=True)[1].reshape(-1, 2)
    forth = numbers[:, 0] * len(at) + numbers[:, 1]
    back = numbers[:, 1] * len(at) + numbers[:, 0]
    assert len(np.unique(forth)) == len(forth), "two triangles on one side of an edge"
    return np.count_nonzero(~np.isin(forth, back))


@pytest.mark.parametrize("keep_degenerate", [True, False])
def test_no_combination_cracks_beside_neighbours_of_any_level(keep_degenerate):
    levels, places = joined_to_neighbours()
    pattern = semi_uniform(levels, maximum=M, keep_degenerate=keep_degenerate)
    sizes = np.diff(pattern.point_offsets)
    patch = np.repeat(np.arange(len(levels)), sizes)
    uvw = pattern.points.astype(np.int64)
    uvw = np.concatenate([uvw, FIXED_ONE - uvw.sum(axis=1, keepdims=True)], axis=1)
    # exact: whole numbers, on the lattice of level 5
    x, y = np.einsum("nk,nkc->cn", uvw, places[patch]) // (FIXED_ONE // 2**M)
    at = x * 2**32 + y
    corners = at[pattern.triangles]
    has_area = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
    assert keep_degenerate or has_area.all()
    # edges between points of a boundary; those inside a patch are paired where it is covered once
    triangles = pattern.triangles[has_area]
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    in_boundary = np.arange(len(at)) - pattern.point_offsets[patch] < 3 * 2 ** levels.max(1)[patch]
    edges = edges[in_boundary[edges].all(axis=1)]
    # all that is open is the outline of each group of four: two edges of each neighbour
    outline = (2 ** levels.reshape(-1, 4, 3)[:, 1:, 1:]).sum()
    assert unpaired_edges(at, edges) == outline


def test_the_crack_report_finds_none_either():
    levels, places = joined_to_neighbours()
    some = (np.arange(0, len(levels), 4 * 61)[:, None] + np.arange(4)).ravel()
    pattern = semi_uniform(levels[some], maximum=M)
    patch = np.repeat(some, np.diff(pattern.point_offsets))
    uvw = np.column_stack([pattern.points, FIXED_ONE - pattern.points.sum(axis=1)])
    xy = np.einsum("nk,nkc->nc", uvw.astype(np.float64), places[patch]) / 2**21
    vertices = np.column_stack([xy, np.zeros(len(xy))]).astype(np.float32)
    up = np.broadcast_to(np.float32([0, 0, 1]), vertices.shape)
    assert not crack_report(Mesh(vertices, up, pattern.triangles))


# quads, and both ways to snap

QUADS = np.array(list(product(range(4), repeat=4)))
SNAPPED = pytest.mark.parametrize("snap", ["nested", "nearest"])


@SNAPPED
def test_quads_keep_what_is_inside_and_stand_on_their_edges_levels(snap):
    pattern = semi_uniform(QUADS, snap=snap)
    for patch, levels in enumerate(QUADS):
        begin, end = pattern.point_offsets[patch : patch + 2]
        points, steps = pattern.points[begin:end].astype(np.int64), 2 ** levels.max()
        inside = points[4 * steps :]
        assert ((inside > 0) & (inside < FIXED_ONE)).all()
        assert (inside % (FIXED_ONE // steps) == 0).all()
        assert len(np.unique(inside, axis=0)) == len(inside) == (steps - 1) ** 2
        for edge, level in enumerate(levels):
            on_edge = points[points[:, edge % 2] == (FIXED_ONE if edge > 1 else 0), 1 - edge % 2]
            np.testing.assert_array_equal(
                np.unique(on_edge), np.arange(2**level + 1) * FIXED_ONE // 2**level
            )


@SNAPPED
@pytest.mark.parametrize("levels", [ALL[::5], QUADS], ids=["triangles", "quads"])
def test_either_snap_covers_the_domain_once_and_folds_nothing(snap, levels):
    for keep in (True, False):
        pattern = semi_uniform(levels, maximum=M, snap=snap, keep_degenerate=keep)
        uv = pattern.points[pattern.triangles].astype(np.int64)
        area = np.linalg.det((uv[:, 1:] - uv[:, :1]) / FIXED_ONE)
        assert (area >= 0).all()
        assert keep or (area > 0).all()
        patch = np.repeat(np.arange(len(levels)), np.diff(pattern.triangle_offsets))
        whole = 1 if levels.shape[1] == 3 else 2
        np.testing.assert_allclose(np.bincount(patch, area), whole)


@pytest.mark.slow
@SNAPPED
def test_no_combination_of_quads_cracks_beside_neighbours_of_any_level(snap):
    beside = [(-1, 0, 2), (0, -1, 3), (1, 0, 0), (0, 1, 1)]
    levels, places = [], []
    for number, (own, other) in enumerate(product(QUADS, range(4))):
        shift = 4 * np.array([number % 40, number // 40])
        levels.append(own)
        places.append(shift)
        for edge, (x, y, facing) in enumerate(beside):
            levels.append(np.where(np.arange(4) == facing, own[edge], other))
            places.append(shift + np.array([x, y]))
    levels, places = np.array(levels), np.array(places)
    pattern = semi_uniform(levels, snap=snap, keep_degenerate=False)
    patch = np.repeat(np.arange(len(levels)), np.diff(pattern.point_offsets))
    x, y = (pattern.points.astype(np.int64) // (FIXED_ONE // 8) + 8 * places[patch] + 8).T
    triangles = pattern.triangles
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    # all that is open is the outline of each group of five: three edges of each neighbour
    outline = 3 * 4 * sum(2 ** np.arange(4)) * len(QUADS)
    assert unpaired_edges(x * 2**32 + y, edges) == outline


def test_the_nearest_snap_is_equation_1_and_nested_levels_hold_the_lower_ones():
    steps = 2**M
    moved = {}
    for snap in ("nested", "nearest"):
        pattern = semi_uniform([(M, M, level) for level in range(M + 1)], maximum=M, snap=snap)
        first = pattern.point_offsets[:-1, None]
        # w = 0 is walked from u = 1
        along = pattern.points[first + 2 * steps + np.arange(steps), 1] / FIXED_ONE
        moved[snap] = along
    t, levels = np.arange(steps) / steps, np.arange(M + 1)[:, None]
    scaled = t * 2**levels
    equation = np.where(t < 0.5, np.ceil(scaled - 0.5), np.floor(scaled + 0.5)) / 2.0**levels
    np.testing.assert_array_equal(moved["nearest"], equation)
    # points that stand together on a level stand together on all lower ones: nested, not nearest
    together = {
        snap: all(
            len(np.unique(lower[upper == place])) == 1
            for lower, upper in pairwise(along)
            for place in upper
        )
        for snap, along in moved.items()
    }
    assert together == {"nested": True, "nearest": False}


# the rest


@given(st.lists(st.tuples(*[st.floats(-1, 6, width=32)] * 3), min_size=1, max_size=40))
@settings(deadline=None, max_examples=30)
def test_counts_in_closed_form(levels):
    asked = np.array(levels, np.float32)
    whole = np.ceil(asked).astype(int)
    steps = np.where((asked < 0).any(axis=1), 0, 2 ** whole.max(axis=1).clip(0))
    drawn = steps > 0
    kept, dropped = (semi_uniform(asked, maximum=6, keep_degenerate=k) for k in (True, False))
    points = np.where(drawn, (steps + 1) * (steps + 2) // 2, 0)
    np.testing.assert_array_equal(np.diff(kept.point_offsets), points)
    np.testing.assert_array_equal(np.diff(kept.triangle_offsets), steps**2)
    collapsed = drawn * (3 * steps - (2 ** whole.clip(0)).sum(axis=1))
    np.testing.assert_array_equal(np.diff(dropped.triangle_offsets), steps**2 - collapsed)


def test_counter_clockwise_is_the_mirror_image():
    levels = [(3, 1, 2), (0, 0, 0), (4, 4, 4)]
    for keep in (True, False):
        one = semi_uniform(levels, keep_degenerate=keep)
        other = semi_uniform(levels, keep_degenerate=keep, topology="counter_clockwise")
        np.testing.assert_array_equal(one.triangles, other.triangles[:, [0, 2, 1]])
        np.testing.assert_array_equal(one.points, other.points)


@pytest.mark.parametrize("keep_degenerate", [True, False])
def test_a_group_of_work_items_makes_what_one_makes(keep_degenerate, monkeypatch):
    alone = semi_uniform(ALL, keep_degenerate=keep_degenerate)
    monkeypatch.setattr(Device, "group_size", lambda self, wanted=64: wanted)
    together = semi_uniform(ALL, keep_degenerate=keep_degenerate)
    np.testing.assert_array_equal(together.points, alone.points)
    np.testing.assert_array_equal(together.triangles, alone.triangles)


def test_culled_patches_make_nothing():
    pattern = semi_uniform([(2, 2, 2), (-1, 3, 3), (np.nan, 1, 1), (1, 0, 0)])
    np.testing.assert_array_equal(np.diff(pattern.triangle_offsets), [16, 0, 0, 4])


def test_no_patches_make_an_empty_pattern():
    assert semi_uniform([]).patch_count == semi_uniform(np.empty((0, 3))).patch_count == 0


def test_the_last_level_there_is():
    pattern = semi_uniform([(10, 0, 10)], maximum=10, keep_degenerate=False)
    assert len(pattern.triangles) == 4**10 - 1023
    assert pattern.triangles.max() < len(pattern.points)


@pytest.mark.parametrize(
    ("levels", "options", "message"),
    [
        ([(1, 2)], {}, r"levels of shape \(P, 3\), got \(1, 2\)"),
        ([(1, 2, 3), (1, 2)], {}, r"levels as real numbers \(P, \.\.\.\)"),
        ([("a", "b", "c")], {}, "real numbers"),
        ([(1, 2, 6)], {}, "at most maximum=5, got 6: raise maximum"),
        ([(1, 2, 3)], {"maximum": 11}, "whole number from 0 to 10 for maximum, got 11"),
        ([(1, 2, 3)], {"topology": "left"}, "unknown topology 'left': expected one of clockwise"),
        (np.full((800, 3), 10), {"maximum": 10}, "at most 2147483648 indices, got 2516582400"),
    ],
)
def test_bad_input_is_refused_in_one_line(levels, options, message):
    with pytest.raises(InputError, match=message) as caught:
        semi_uniform(levels, **options)
    assert "\n" not in str(caught.value)


def test_more_than_the_device_holds_is_refused_with_both_numbers(monkeypatch):
    device = Device.open()
    levels = np.full((100, 3), 7)
    semi_uniform(levels[:1], maximum=7)
    monkeypatch.setattr(device.memory, "allocated", device.info.memory - 2**20)
    with pytest.raises(DeviceMemoryError, match=r"bytes\), .* has"):
        semi_uniform(levels, maximum=7)


def test_lattices_have_what_they_should():
    for level in range(7):
        base, steps = lattice(level), 2**level
        assert len(base.triangles) == steps**2
        assert len(base.inside) == (steps - 1) * (steps - 2) // 2
        assert (np.count_nonzero(base.triangles[: base.inner] < 3 * steps, axis=1) < 2).all()
