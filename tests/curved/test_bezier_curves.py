"""Bézier curves of any degree, and how smoothly pieces and patches are joined."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from terrain_lod.curved.catmull_clark import catmull_clark_patches
from terrain_lod.reference.curved.bezier import curve_of_any_degree

K = 0.5522847498307936  # of a quarter circle
QUARTER = np.array([(1, 0, 0), (1, K, 0), (K, 1, 0), (0, 1, 0)])


@pytest.mark.parametrize("degree", [1, 2, 3, 5, 32])
def test_points_and_tangents_are_those_of_the_definition(degree):
    points = np.random.default_rng(degree).normal(size=(degree + 1, 3))
    found = tl.curved.bezier_curve(points, factor=16, partitioning="integer")
    t = np.arange(17) / 16
    at, along = curve_of_any_degree(np.tile(points, (17, 1, 1)), t)
    np.testing.assert_allclose(found.points, at, atol=2e-5)
    np.testing.assert_allclose(found.tangents, along, atol=2e-4)
    np.testing.assert_array_equal(found.points[[0, -1]], points[[0, -1]].astype(np.float32))


def test_pieces_are_laid_end_to_end():
    turn = np.array([(0, 1, 0), (-1, 0, 0), (0, 0, 1)])
    pieces = [QUARTER]
    for _ in range(3):
        pieces.append(pieces[-1] @ turn)
    circle = tl.curved.bezier_curve(pieces, factor=7)
    assert len(circle.points) == 4 * 7 + 1
    assert circle.closed
    joints = tl.curved.curve_continuity(pieces, closed=True)
    assert len(joints.gaps) == 4
    assert joints.gaps.max() < 1e-15
    assert joints.angles.max() < 1e-6
    # all four ends bend alike, towards the middle
    assert joints.curvatures.max() < 1e-12


def test_a_gap_an_angle_and_a_jump_of_curvature_are_told():
    line = np.array([(0, 1 - t, 0) for t in (0, -1, -2, -3)]) * (1, 1, 1)
    straight = np.array([(-t, 1, 0) for t in range(4)])
    joints = tl.curved.curve_continuity([QUARTER, straight])
    # from an arc into a line: G1, and all of the curvature lost
    bend = 2 / 3 * (1 - K) / K**2
    assert (joints.gaps[0], joints.angles[0]) == (0, pytest.approx(0, abs=1e-6))
    assert joints.curvatures[0] == pytest.approx(bend)
    corner = tl.curved.curve_continuity([QUARTER, line + np.array([0, 0, 0.5])])
    assert corner.gaps[0] == pytest.approx(0.5)
    assert corner.angles[0] == pytest.approx(90)
    assert "gaps up to 0.5, angles up to 90" in repr(corner)


def test_b_splines_are_joined_with_curvature_and_their_halves_without():
    points = np.random.default_rng(3).normal(size=(6, 6, 3)) + np.mgrid[0:6, 0:6, 0:1].T[0] * 4
    nets = tl.curved.b_spline(points)
    joints = tl.curved.patch_continuity(nets)
    assert len(joints.gaps) == 12
    assert joints.gaps.max() < 1e-12
    assert joints.angles.max() < 1e-5
    assert joints.curvatures.max() < 1e-6
    moved = nets.copy()
    moved[0, 2, 2] += (0, 0, 1)  # no edge, but the tangents across two
    bent = tl.curved.patch_continuity(moved)
    touched = (bent.pieces == 0).any(axis=1)
    assert bent.gaps.max() < 1e-12
    assert (bent.angles[touched] > 0.1).all()
    assert bent.curvatures[~touched].max() < 1e-6


@pytest.mark.parametrize("transposed", [False, True])
def test_a_plane_beside_a_parabola_loses_its_curvature_across_the_edge(transposed):
    # z = c y^2 from y = 0 on, by its Bezier points; plane before
    c, i, j = 0.25, *np.meshgrid(np.arange(4.0), np.arange(4.0), indexing="ij")
    plane = np.stack([i, j - 3, 0 * i], axis=-1)
    bent = np.stack([i, j, c * np.array([0, 0, 3, 9]) + 0 * i], axis=-1)
    nets = np.array([plane, bent])
    joints = tl.curved.patch_continuity(nets.transpose(0, 2, 1, 3) if transposed else nets)
    assert joints.angles == pytest.approx(0, abs=1e-6)
    assert joints.curvatures == pytest.approx(2 * c)


def test_orientation_does_not_count_and_collapsed_edges_are_none():
    nets = tl.curved.b_spline(np.stack(np.meshgrid(*2 * [np.arange(5.0)], [0.0]), -1)[:, :, 0])
    turned = nets.copy()
    turned[0] = turned[0].transpose(1, 0, 2)
    for each in (nets, turned):
        joints = tl.curved.patch_continuity(each)
        assert len(joints.gaps) == 4
        assert joints.angles.max() < 1e-6
    point = nets[:1].copy()
    point[0, 0] = point[0, 0, 0]
    assert len(tl.curved.patch_continuity(np.concatenate([point, point])).gaps) == 3


def test_approximating_patches_are_closed_and_nearly_smooth():
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    box = tl.curved.ControlMesh(corners, sides)
    joints = tl.curved.patch_continuity(catmull_clark_patches(box).nets)
    assert len(joints.gaps) == 12
    assert joints.gaps.max() == 0
    assert 1 < joints.angles.max() < 20


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: tl.curved.bezier_curve(np.zeros((1, 3))), "degrees 1 to 32"),
        (lambda: tl.curved.bezier_curve(np.zeros((40, 3))), "degrees 1 to 32"),
        (
            lambda: tl.curved.bezier_curve([(0, 0, np.nan), (1, 1, 1)]),
            "finite control points, got nan",
        ),
        (lambda: tl.curved.bezier_curve(QUARTER, factor=0), "factor > 0"),
        (lambda: tl.curved.curve_continuity(np.zeros((2, 2))), "control points"),
        (lambda: tl.curved.patch_continuity(np.zeros((2, 2))), "16 control points"),
    ],
)
def test_bad_input_is_one_line(make, message):
    with pytest.raises(tl.InputError, match=message):
        make()
