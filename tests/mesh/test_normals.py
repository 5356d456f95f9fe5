"""Normals of vertices from the triangles around them."""

from __future__ import annotations

import numpy as np

from terrain_lod.mesh.normals import vertex_normals


def test_normals_are_weighted_by_area():
    # a vertex between a level face of area 2 and an upright one, facing west, of area 1
    points = np.array([(0, 0, 0), (2, 0, 0), (0, 2, 0), (0, 0, 1), (9, 9, 9)], np.float64)
    normals = vertex_normals(points, np.int32([(0, 1, 2), (0, 3, 2)]))
    expected = np.array([-1, 0, 2]) / np.sqrt(5)
    np.testing.assert_allclose(normals[0], expected)
    np.testing.assert_array_equal(normals[4], [0, 0, 1])
