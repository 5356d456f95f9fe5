"""The domain stage: exact on samples and planes, the same bits wherever the ground stands."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import holed, plane, rough
from terrain_lod.device.layout import FIXED_ONE
from terrain_lod.reference.terrain import domain


@pytest.mark.parametrize("tile", [7, 15, 31, 63])
@pytest.mark.parametrize("size", [2, 16, 17, 20, 31, 46, 50, 70])
def test_factors_of_a_cell_each_reproduce_the_raster(size: int, tile: int) -> None:
    ground = rough(size, size + 3, spacing=30.0)
    mesh = tl.Terrain(ground, tile=tile).mesh(lod=tl.UniformLod(tile))
    # a single cell beside several has points at its thirds; all others stand on samples
    thirds = 3 * mesh.vertices[:, :2] / (30, -30)
    np.testing.assert_allclose(thirds, np.rint(thirds), atol=1e-3)
    on_sample = (np.rint(thirds) % 3 == 0).all(axis=1)
    assert on_sample.mean() > 0.5
    column, row = (np.rint(thirds[on_sample]) / 3).astype(int).T
    np.testing.assert_array_equal(mesh.vertices[on_sample, 2], ground.heights[row, column])
    error = tl.vertical_error(mesh, ground)
    assert error.maximum == 0
    assert error.uncovered == 0


@pytest.mark.parametrize("factor", [1, 4.2, 15])
@pytest.mark.parametrize("slopes", [(0.0, 0.0), (0.5, -2.0), (1000.0, 300.0)])
def test_a_plane_has_its_normal_everywhere(factor: float, slopes: tuple[float, float]) -> None:
    # the book's Sobel has neither spacing nor a true third component
    mesh = tl.Terrain(plane(*slopes, spacing=(30, 7))).mesh(lod=tl.UniformLod(factor))
    expected = np.array([-slopes[0] / 30, slopes[1] / 7, 1.0])
    expected /= np.linalg.norm(expected)
    np.testing.assert_allclose(mesh.normals, np.tile(expected, (len(mesh.normals), 1)), atol=1e-6)


def test_a_plane_with_holes_has_its_normal_everywhere() -> None:
    ground = plane(2.0, 1.0)
    mask = np.random.default_rng(0).random(ground.shape) < 0.2
    mesh = tl.Terrain(tl.Heightmap(ground.heights, mask=mask)).mesh(lod=tl.UniformLod(15))
    used = np.unique(mesh.triangles)
    expected = np.array([-2.0, 1.0, 1.0]) / np.sqrt(6)
    np.testing.assert_allclose(mesh.normals[used], np.tile(expected, (len(used), 1)), atol=1e-6)


def test_normals_have_unit_length_however_steep() -> None:
    cliffs = np.where(np.random.default_rng(0).random((40, 40)) > 0.5, 1e20, -1e20)
    for ground in (rough(spacing=0.01), tl.Heightmap(cliffs.astype(np.float32))):
        mesh = tl.Terrain(ground).mesh(lod=tl.UniformLod(7.3))
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-6)


def test_slopes_beyond_float32_have_the_normals_that_they_should() -> None:
    # 1e40 a unit to the east, 2e40 to the north
    ground = plane(1e28, -4e28, spacing=(1e-12, 2e-12))
    mesh = tl.Terrain(ground).mesh(lod=tl.UniformLod(7.3))
    expected = np.tile(np.array([-1.0, -2.0, 0.0]) / np.sqrt(5), (len(mesh.vertices), 1))
    np.testing.assert_allclose(mesh.normals, expected, atol=1e-6)


def test_points_beyond_32_bits_of_fixed_point_stand_where_they_should() -> None:
    # 65536 samples x 65536 units a cell is 2^32
    ground = tl.Heightmap(np.tile(np.arange(70_000, dtype=np.float32), (2, 1)))
    mesh = tl.Terrain(ground).mesh(lod=tl.UniformLod(1))
    np.testing.assert_array_equal(mesh.vertices[:, 0], mesh.vertices[:, 2])
    assert mesh.vertices[:, 0].max() == 69_999


def test_moving_the_origin_changes_nothing_but_the_origin() -> None:
    near, far = rough(), rough(origin=(1e6, 1e6), base=1e6)
    camera = tl.Camera((30, -30, 200), (60, -60, 0))
    moved = tl.Camera((1e6 + 30, 1e6 - 30, 1e6 + 200), (1e6 + 60, 1e6 - 60, 1e6))
    first, second = tl.Terrain(near).mesh(camera), tl.Terrain(far).mesh(moved)
    np.testing.assert_array_equal(first.vertices, second.vertices)
    np.testing.assert_array_equal(first.triangles, second.triangles)
    np.testing.assert_array_equal(second.origin - first.origin, [1e6, 1e6, 1e6])


def test_triangles_face_up() -> None:
    mesh = tl.Terrain(rough(spacing=30.0)).mesh(lod=tl.UniformLod(4.4))
    corners = mesh.vertices[mesh.triangles].astype(float)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (normals[:, 2] >= 0).all()
    assert (normals[:, 2] > 0).mean() > 0.9


@pytest.mark.parametrize("factor", [1, 3, 15])
def test_no_triangle_reaches_into_a_hole_and_all_other_cells_are_covered(factor: float) -> None:
    ground = holed(92, 77)
    mesh = tl.Terrain(ground).mesh(lod=tl.UniformLod(factor))
    corners = mesh.vertices[mesh.triangles].astype(np.float64)
    edges = corners[:, 1:, :2] - corners[:, :1, :2]
    area = np.abs(np.linalg.det(edges)) / 2
    corners = corners[area > 0]
    # sample each triangle well inside; no sample may fall into a cell that lacks a corner
    mix = 0.01 + 0.97 * np.random.default_rng(0).dirichlet([1, 1, 1], 40)
    inside = np.einsum("kc,tcx->tkx", mix, corners).reshape(-1, 3)
    column, row = np.floor(inside[:, 0]).astype(int), np.floor(-inside[:, 1]).astype(int)
    valid = ground.valid
    cell_valid = valid[:-1, :-1] & valid[1:, :-1] & valid[:-1, 1:] & valid[1:, 1:]
    assert cell_valid[row, column].all()
    # and the area of the triangles is that of the cells with data
    assert area.sum() == pytest.approx(cell_valid.sum(), rel=1e-6)


@pytest.mark.parametrize("cells", [1, 2, 3, 4, 7, 8, 15, 16, 31, 62, 63])
def test_rulers_put_as_many_segments_on_the_samples_and_keep_the_order(cells: int) -> None:
    u = np.arange(FIXED_ONE + 1, dtype=np.uint32)
    offsets = domain.cell_offsets(cells, u)
    assert (np.diff(offsets) >= 0).all()
    # both directions of an edge agree
    np.testing.assert_array_equal(offsets + offsets[::-1], cells * FIXED_ONE)
    # nothing moves by more than the tessellator's own rounding adds up to
    assert np.abs(offsets - u.astype(int) * cells).max() <= cells**2 // 4 + 1
    partitioning = "fractional_odd" if cells % 2 else "fractional_even"
    edges = tl.tessellate("quad", [[cells] * 4], [[cells] * 2], partitioning=partitioning)
    assert (offsets[edges.points] % FIXED_ONE == 0).all()
