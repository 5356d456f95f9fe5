"""Meshes that move: the same as smoothing each pose anew, and closed in every one."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.curved_meshes import CLOSED, cube, torus
from terrain_lod.curved.posed import PosedMesh


def bent(mesh, time):
    """Return vertices and normals twisted about z, more so higher up."""
    angle = time * mesh.vertices[:, 2].astype(float)
    sine, cosine = np.sin(angle), np.cos(angle)
    return (
        np.stack([x * cosine - y * sine, x * sine + y * cosine, z], axis=1)
        for x, y, z in (mesh.vertices.T, mesh.normals.T)
    )


@pytest.mark.parametrize("name", CLOSED)
def test_a_pose_is_the_mesh_smoothed_anew_and_closed(name):
    mesh = CLOSED[name]()
    figure = PosedMesh(mesh, factor=4.3)
    for time in (0.0, 0.3, -1.0):
        vertices, normals = bent(mesh, time)
        found = figure.pose(vertices, normals)
        moved = tl.Mesh(vertices.astype(np.float32), normals.astype(np.float32), mesh.triangles)
        anew = tl.pn_triangles(moved, 4.3)
        assert not tl.crack_report(found, closed=True)
        np.testing.assert_array_equal(found.triangles, anew.triangles)
        np.testing.assert_allclose(found.vertices, anew.vertices, atol=1e-6)
        np.testing.assert_allclose(found.normals, anew.normals, atol=1e-5)


def test_vertices_in_one_place_stay_in_one_place():
    mesh = cube()
    apart = mesh.vertices + np.random.default_rng(1).normal(size=mesh.vertices.shape) * 0.1
    found = PosedMesh(mesh, factor=3).pose(apart, mesh.normals)
    assert not tl.crack_report(found, closed=True)


def test_only_nets_and_points_are_made_again():
    mesh = torus(24, 12)
    found = PosedMesh(mesh).pose(mesh.vertices, mesh.normals)
    assert set(found.timings) == {"pn_hull", "pn_domain"}


@pytest.mark.parametrize(
    ("vertices", "message"),
    [
        (np.zeros((5, 3)), r"vertices of shape \(\d+, 3\), got \(5, 3\)"),
        (np.full(cube().vertices.shape, np.nan), "finite vertices, got nan"),
        (np.full(cube().vertices.shape, 1e39), r"vertices that float32 can hold, got 1e\+39"),
    ],
)
def test_poses_that_do_not_fit_are_refused_in_one_line(vertices, message):
    with pytest.raises(tl.InputError, match=message):
        PosedMesh(cube()).pose(vertices, cube().normals)
