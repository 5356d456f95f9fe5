"""Vertical error: exact on drawn meshes, and as the float64 reference has it on random ones."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from support.drawn_meshes import grid_mesh, joined, mesh_of, unwelded
from terrain_lod.device.device import Device
from terrain_lod.errors import InputError
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.measure.error import vertical_error
from terrain_lod.reference.measure.error import error_field


def plane(rows, columns, east=2.0, south=-3.0):
    """Return heights that rise `east` a column and `south` a row."""
    row, column = np.mgrid[:rows, :columns]
    return column * east + row * south


def two_triangles(ground, **fields):
    """Return the raster's rectangle, corner to corner."""
    return grid_mesh(ground, step=10**6)


def agrees(mesh, ground, slack=1.0):
    """Assert that every sample agrees with the reference to `slack` ulp of the height range."""
    field = vertical_error(mesh, ground, field=True).field
    expected = error_field(mesh, ground)
    np.testing.assert_array_equal(np.isnan(field), np.isnan(expected))
    extremes = [*mesh.vertices[:, 2], *ground.heights[ground.valid]]
    atol = slack * np.spacing(np.float32(np.ptp(extremes)))
    np.testing.assert_allclose(field, expected, rtol=0, atol=atol)
    return field


def test_every_sample_a_vertex_is_no_error_at_all():
    ground = Heightmap(np.random.default_rng(1).normal(0, 100, (40, 33)), spacing=(0.1, 30.0))
    error = vertical_error(grid_mesh(ground), ground)
    assert (error.maximum, error.rms, error.mean) == (0, 0, 0)
    assert (error.samples, error.uncovered) == (40 * 33, 0)


def test_heights_of_very_different_size_are_met_exactly():
    exponents = np.random.default_rng(11).integers(-120, 120, (20, 20))
    ground = Heightmap(np.exp2(exponents, dtype=np.float32))
    assert vertical_error(grid_mesh(ground), ground).maximum == 0


def test_a_plane_needs_two_triangles():
    ground = Heightmap(plane(65, 33), spacing=(3.0, 5.0))
    assert vertical_error(two_triangles(ground), ground).maximum < 1e-13


def test_a_spike_is_found_where_it_is():
    heights = plane(9, 17)
    heights[4, 11] += 7.5
    ground = Heightmap(heights, spacing=(10.0, 20.0), origin=(500_000, 4_000_000), base=1000.0)
    error = vertical_error(two_triangles(ground), ground, field=True)
    assert error.maximum == 7.5
    assert error.where == (4, 11)
    assert error.point == (500_110, 3_999_920)
    assert error.mean == pytest.approx(-7.5 / (9 * 17))
    assert error.rms == pytest.approx(7.5 / np.sqrt(9 * 17))
    # the mesh runs below the spike
    assert error.field[4, 11] == -7.5
    assert np.count_nonzero(error.field) == 1


def test_two_triangles_over_many_samples():
    ground = Heightmap(np.random.default_rng(2).normal(0, 50, (700, 900)))
    field = vertical_error(two_triangles(ground), ground, field=True).field
    # the plane through north-west, south-west, north-east, and that through the other three
    row, column = np.mgrid[:700, :900] / np.reshape([699, 899], (2, 1, 1))
    (nw, ne), (sw, se) = ground.heights[::699, ::899].astype(np.float64)
    upper = nw + (ne - nw) * column + (sw - nw) * row
    lower = se + (sw - se) * (1 - column) + (ne - se) * (1 - row)
    expected = np.where(row + column <= 1, upper, lower) - ground.heights
    np.testing.assert_allclose(field, expected, atol=1e-4)


def test_winding_and_order_do_not_matter():
    ground = Heightmap(np.random.default_rng(3).normal(0, 50, (50, 60)))
    mesh = grid_mesh(ground, step=7)
    expected = vertical_error(mesh, ground, field=True).field
    order = np.random.default_rng(4).permutation(len(mesh.triangles))
    shuffled = replace(mesh, triangles=mesh.triangles[order, ::-1])
    np.testing.assert_array_equal(vertical_error(shuffled, ground, field=True).field, expected)
    np.testing.assert_array_equal(
        vertical_error(unwelded(mesh), ground, field=True).field, expected
    )


@pytest.mark.parametrize("shift", [0.0, 1e6, 123_456_789.0])
def test_the_origin_does_not_matter(shift):
    heights = np.random.default_rng(5).normal(0, 50, (30, 30))
    here = Heightmap(heights, spacing=(30.0, 10.0))
    there = Heightmap(heights, spacing=(30.0, 10.0), origin=(shift, -shift), base=shift)
    expected = vertical_error(grid_mesh(here, 4), here)
    error = vertical_error(grid_mesh(there, 4), there)
    assert (error.maximum, error.rms, error.where) == (
        expected.maximum,
        expected.rms,
        expected.where,
    )


def test_mesh_and_ground_may_have_different_origins():
    ground = Heightmap(plane(20, 20), origin=(1000.0, 2000.0), base=10.0)
    mesh = grid_mesh(ground, step=5)
    moved = replace(
        mesh, vertices=mesh.vertices + np.float32([64, -32, 8]), origin=mesh.origin - [64, -32, 8]
    )
    assert vertical_error(moved, ground) == vertical_error(mesh, ground)
    raised = replace(mesh, origin=np.add(mesh.origin, [0, 0, 2.5]))
    assert vertical_error(raised, ground).mean == 2.5


def test_samples_outside_the_mesh_are_counted_and_not_measured():
    ground = Heightmap(np.zeros((5, 6)))
    #  column 0 1 2 3          the closed footprint has 10 samples
    #  row 0  *-*-*-*
    #      1  *-*-*
    #      2  *-*
    #      3  *
    mesh = mesh_of([(0, 0, 1), (3, 0, 1), (0, -3, 1)], [(0, 2, 1)])
    error = vertical_error(mesh, ground, field=True)
    assert (error.maximum, error.rms, error.mean) == (1, 1, 1)
    assert (error.samples, error.uncovered) == (10, 20)
    row, column = np.mgrid[:5, :6]
    np.testing.assert_array_equal(np.isnan(error.field), row + column > 3)


def test_nodata_is_not_measured():
    heights = plane(8, 8)
    heights[3, 4] = np.nan
    ground = Heightmap(heights)
    error = vertical_error(two_triangles(ground), ground, field=True)
    assert (error.maximum, error.samples, error.uncovered) == (0, 63, 0)
    assert np.isnan(error.field[3, 4])


def test_an_empty_mesh_measures_nothing():
    ground = Heightmap(np.zeros((3, 4)))
    error = vertical_error(mesh_of(np.zeros((0, 3)), []), ground)
    assert error.where is None
    assert np.isnan([error.maximum, error.rms, error.mean]).all()
    assert (error.samples, error.uncovered) == (0, 12)
    assert str(error) == "no sample measured, 12 samples not covered"


def test_a_mesh_larger_than_the_raster_is_clipped():
    ground = Heightmap(plane(20, 30, 1, 0))
    mesh = mesh_of([(-1e6, 1e6, -1e6), (-1e6, -1e7, -1e6), (1e7, 1e6, 1e7)], [(0, 1, 2)])
    error = vertical_error(mesh, ground)
    assert error.samples == 600
    # 1e7 in float32 is a whole number, so the plane is z = x but for the grid's own rounding
    assert error.maximum < 1e-4


def test_the_worst_of_two_surfaces_counts_whichever_is_first():
    ground = Heightmap(np.zeros((4, 4)))
    near = two_triangles(ground)
    far = replace(near, vertices=near.vertices - np.float32([0, 0, 3]))
    for pair in (joined(near, far), joined(far, near)):
        assert vertical_error(pair, ground).mean == -3
    # of equals, the one above
    above = replace(near, vertices=near.vertices + np.float32([0, 0, 3]))
    for pair in (joined(above, far), joined(far, above)):
        assert vertical_error(pair, ground).mean == 3


def test_the_worst_of_many_surfaces_counts():
    ground = Heightmap(np.zeros((4, 4)))
    heights = np.random.default_rng(12).permutation(5000)
    flat = two_triangles(ground).vertices
    vertices = flat + heights[:, None, None] * np.float32([0, 0, 1])
    triangles = [(0, 2, 1), (1, 2, 3)] + 4 * np.arange(5000)[:, None, None]
    assert vertical_error(mesh_of(vertices, triangles), ground).mean == 4999


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(0, 60), st.integers(0, 60)), min_size=3, max_size=3))
@example([(0, 0), (49, 49), (0, 49)])  # 1 / 49 * 49 < 1 in 64 bits
def test_a_triangle_covers_its_closed_footprint(corners):
    (ax, ay), (bx, by), (cx, cy) = corners
    y, x = np.mgrid[:61, :61]
    sides = [
        (bx - ax) * (y - ay) - (by - ay) * (x - ax),
        (cx - bx) * (y - by) - (cy - by) * (x - bx),
        (ax - cx) * (y - cy) - (ay - cy) * (x - cx),
    ]
    inside = (np.min(sides, axis=0) >= 0) | (np.max(sides, axis=0) <= 0)
    inside &= sum(sides) != 0  # a triangle without area covers nothing
    mesh = mesh_of([(x, -y, 0) for x, y in corners], [(0, 1, 2)])
    field = vertical_error(mesh, Heightmap(np.zeros((61, 61))), field=True).field
    np.testing.assert_array_equal(~np.isnan(field), inside)


def test_a_shared_edge_leaves_no_sample_out():
    # many triangles about one point, with edges in all directions
    angle = np.linspace(0, 2 * np.pi, 50)
    rim = np.stack([32 + 60 * np.cos(angle), -32 + 60 * np.sin(angle), np.zeros(50)], axis=1)
    hub = [[32.03, -31.97, 0]]
    mesh = mesh_of([*hub, *rim], [(0, i, i + 1) for i in range(1, 50)])
    ground = Heightmap(np.zeros((65, 65)))
    assert vertical_error(mesh, ground).uncovered == 0


def test_walls_and_slivers_cover_nothing():
    ground = Heightmap(np.zeros((5, 5)))
    flat = two_triangles(ground)
    skirt = mesh_of(
        [(0, 0, 0), (0, 0, -9), (4, 0, 0), (4, 0, -9), (0, -4, 5), (2, -2, 7), (4, 0, 9)],
        [(0, 1, 2), (2, 1, 3), (4, 5, 6), (0, 0, 1)],
    )
    assert vertical_error(joined(flat, skirt), ground).maximum == 0


def test_heights_of_a_sliver_stay_between_its_edges():
    # 1e-5 cells wide, its plane a thousand times steeper than its edges
    mesh = mesh_of(
        [(0, 0, 0), (8, 0, 8), (4, 1e-5, 4.125), (4, -1e-5, 4.125)], [(0, 1, 2), (0, 3, 1)]
    )
    error = vertical_error(mesh, Heightmap(np.zeros((3, 9))), field=True)
    np.testing.assert_allclose(error.field[0], np.arange(9), atol=0.126)
    assert error.samples == 9


def delaunay_mesh(ground, points, seed, jitter=0.0):
    """Return a Delaunay triangulation of random points and the raster's corners."""
    rng = np.random.default_rng(seed)
    rows, columns = ground.shape
    xy = rng.integers(0, (columns, rows), (points, 2)) + rng.normal(0, jitter, (points, 2))
    corners = [(0, 0), (columns - 1, 0), (0, rows - 1), (columns - 1, rows - 1)]
    xy = np.unique(np.concatenate([xy.clip(0, (columns - 1, rows - 1)), corners]), axis=0)
    z = rng.normal(0, 100, len(xy))
    dx, dy = ground.spacing
    vertices = np.column_stack([xy * (dx, -dy), z])
    return mesh_of(vertices, Delaunay(xy).simplices, origin=np.array([*ground.origin, ground.base]))


@pytest.mark.parametrize("jitter", [0.0, 0.3])
@pytest.mark.parametrize("points", [10, 400, 4000])
def test_random_triangulations_agree_with_the_reference(points, jitter):
    ground = Heightmap(np.random.default_rng(6).normal(0, 100, (150, 201)))
    mesh = delaunay_mesh(ground, points, seed=points, jitter=jitter)
    field = agrees(mesh, ground)
    assert not np.isnan(field).any()


def test_spacing_and_origin_of_real_rasters_agree_with_the_reference():
    ground = Heightmap(
        np.random.default_rng(7).normal(3000, 100, (80, 90)),
        spacing=(0.0002777, 0.00027781),
        origin=(11.3333, 47.1),
    )
    agrees(delaunay_mesh(ground, 500, seed=8), ground)


@settings(deadline=None, max_examples=40)
@given(
    corners=st.lists(
        st.tuples(
            st.integers(-8, 30 * 8).map(lambda n: n / 8),
            st.integers(-25 * 8, 8).map(lambda n: n / 8),
            st.integers(-50, 50),
        ),
        min_size=3,
        max_size=12,
    ),
    data=st.data(),
)
def test_any_triangles_agree_with_the_reference(corners, data):
    index = st.integers(0, len(corners) - 1)
    triangles = data.draw(st.lists(st.tuples(index, index, index), min_size=1, max_size=12))
    ground = Heightmap(np.random.default_rng(9).normal(0, 10, (24, 28)))
    agrees(mesh_of(corners, triangles), ground, slack=4)


def test_without_doubles_numpy_does_the_work(monkeypatch, caplog):
    ground = Heightmap(np.random.default_rng(10).normal(0, 10, (20, 20)))
    mesh = grid_mesh(ground, 6)
    device = Device.open()
    expected = vertical_error(mesh, ground, device=device)
    monkeypatch.setattr(device, "has_doubles", False)
    with caplog.at_level(logging.INFO, "terrain_lod"):
        error = vertical_error(mesh, ground, device=device)
    assert "no 64-bit floats" in caplog.text
    assert error.maximum == pytest.approx(expected.maximum, rel=1e-6)
    assert error.where == expected.where


def test_what_cannot_be_measured_is_refused_in_one_line():
    ground = Heightmap(np.zeros((3, 3)))
    with pytest.raises(InputError, match=r"finite positions, got \(1, nan, 0\) at vertex 1"):
        vertical_error(mesh_of([(0, 0, 0), (1, np.nan, 0), (0, -1, 0)], [(0, 1, 2)]), ground)
    with pytest.raises(InputError, match=r"its 3 vertices, got \[0, 1, 3\] at triangle 1"):
        vertical_error(mesh_of(np.eye(3), [(0, 1, 2), (0, 1, 3)]), ground)


def test_reads_well():
    heights = np.zeros((9, 9))
    heights[3, 3] = 2
    ground = Heightmap(heights)
    assert str(vertical_error(two_triangles(ground), ground)) == (
        "largest error 2 at [3, 3], RMS 0.2222, mean -0.02469 over 81 samples"
    )
