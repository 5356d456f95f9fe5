"""Polygons cut into triangles: all corners, all the area, nothing twice."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.mesh_files import COMB, CUBE, DOTTED, ELL, HEXAGON, KEYHOLE, Solid
from terrain_lod.files.meshes.polygons import cut_polygons


def cut(shape: Solid) -> tuple[np.ndarray, int]:
    corners = np.concatenate([np.array(face) for face in shape.faces])
    sizes = np.array([len(face) for face in shape.faces])
    return cut_polygons(shape.points, corners, sizes)


def areas(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(points[triangles], 1, 0)
    return np.cross(b - a, c - a) / 2


@pytest.mark.parametrize("shape", [CUBE, HEXAGON, ELL, COMB, DOTTED, KEYHOLE])
@pytest.mark.parametrize("shift", [0.0, 5e6])
def test_triangles_cover_faces_once(shape: Solid, shift: float) -> None:
    moved = Solid(shape.points + shift, shape.faces)
    triangles, crossing = cut(moved)
    assert crossing == 0
    first = 0
    for face, area in zip(shape.faces, shape.areas, strict=True):
        own = triangles[first : first + len(face) - 2]
        first += len(face) - 2
        found = areas(moved.points, own)
        # all turned alike, so that none lies on another
        assert np.linalg.norm(found.sum(axis=0)) == pytest.approx(area, rel=1e-6)
        assert np.linalg.norm(found, axis=1).sum() == pytest.approx(area, rel=1e-6)
        assert set(own.ravel()) == set(face)
    assert first == len(triangles)


def test_quads_and_pentagons_keep_their_place_among_triangles() -> None:
    #   3---2 7         the middle of a bay, 4, sees all other corners of its polygon
    #   |  /| |\
    #   | 4 | | 6
    #   |  \| |/
    #   0---1 5
    points = np.array(
        [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (1, 1, 0), (3, 0, 0), (4, 1, 0), (3, 2, 0)],
        float,
    )
    triangles, crossing = cut(Solid(points, [(5, 6, 7), (0, 1, 4, 2, 3), (7, 5, 6)]))
    assert crossing == 0
    assert triangles.tolist() == [[5, 6, 7], [4, 2, 3], [4, 3, 0], [4, 0, 1], [7, 5, 6]]


def test_what_no_triangles_cover_is_said() -> None:
    bow = np.array([(0, 0, 0), (2, 2, 0), (2, 0, 0), (0, 1, 0)], float)
    triangles, crossing = cut(Solid(bow, [(0, 1, 2, 3)]))
    assert (triangles.tolist(), crossing) == ([[0, 1, 2], [0, 2, 3]], 1)
    # without an area there is nothing to cover, but a neighbour's edge may meet it
    line = np.array([(0, 0, 0), (1, 1, 1), (2, 2, 2), (3, 3, 3)], float)
    triangles, crossing = cut(Solid(line, [(0, 1, 2, 3), (0, 0, 0, 0, 0)]))
    assert (len(triangles), crossing) == (5, 0)


@settings(deadline=None, max_examples=60)
@given(
    data=st.data(),
    count=st.integers(4, 30),
    normal=st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda n: np.linalg.norm(n) > 0.1),
)
def test_any_polygon_around_a_point_is_covered(data, count: int, normal) -> None:
    # a star: seen from its middle, its corners come one after the other
    radii = np.array(data.draw(st.lists(st.integers(1, 9), min_size=count, max_size=count)), float)
    angles = 2 * np.pi * np.arange(count) / count
    plane = np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)
    n = np.array(normal) / np.linalg.norm(normal)
    u = np.cross(n, np.eye(3)[np.argmin(abs(n))])
    u /= np.linalg.norm(u)
    points = plane @ np.stack([u, np.cross(n, u)])
    star = Solid(points, [tuple(range(count))])
    triangles, crossing = cut(star)
    assert crossing == 0
    assert np.linalg.norm(areas(points, triangles), axis=1).sum() == pytest.approx(star.areas[0])
    assert set(triangles.ravel()) == set(range(count))
