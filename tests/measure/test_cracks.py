"""Cracks: found where they are drawn, and nowhere else."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import pyvista
from hypothesis import given, settings
from hypothesis import strategies as st

from support.drawn_meshes import grid_mesh, joined, mesh_of, unwelded
from terrain_lod.errors import InputError
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.measure.cracks import crack_report
from terrain_lod.mesh.mesh import Mesh

ROUGH = Heightmap(np.random.default_rng(1).normal(0, 10, (7, 9)), spacing=(2.0, 3.0))


def patch(columns, rows, left=0.0, top=0.0, height=lambda x, y: 0 * x):
    """Return a patch of two triangles a cell; `columns` and `rows` are the lines' places."""
    x, y = np.meshgrid(np.add(columns, left), -np.add(rows, top))
    shape = Heightmap(np.zeros(x.shape))
    vertices = np.stack([x, y, height(x, y)], axis=-1)
    return mesh_of(vertices, grid_mesh(shape).triangles)


def moved(mesh: Mesh, corner: int, by) -> Mesh:
    """Return the mesh with one vertex moved."""
    vertices = mesh.vertices.copy()
    vertices[corner] += np.float32(by)
    return replace(mesh, vertices=vertices)


def vertex_at(mesh: Mesh, x, y, which=0) -> int:
    """Return the number of a vertex at x, y."""
    return int(np.flatnonzero((mesh.vertices[:, :2] == [x, y]).all(axis=1))[which])


def without(mesh: Mesh, *triangles: int) -> Mesh:
    return replace(mesh, triangles=np.delete(mesh.triangles, triangles, axis=0))


# watertight


@pytest.mark.parametrize("shared", [True, False])
def test_a_grid_is_watertight_whether_its_vertices_are_shared_or_not(shared):
    mesh = grid_mesh(ROUGH) if shared else unwelded(grid_mesh(ROUGH))
    report = crack_report(mesh)
    assert not report
    assert report.open_edges == 2 * (6 + 8)
    assert str(report) == "watertight, 28 edges on outlines"
    assert (report.largest_gap, report.places) == (0, ())


def test_minus_zero_is_zero():
    left, right = patch([-1, 0], [0, 1]), patch([0, 1], [0, 1])
    vertices = right.vertices.copy()
    vertices[vertices == 0] = -0.0
    report = crack_report(joined(left, replace(right, vertices=vertices)))
    assert not report
    assert report.open_edges == 6


def test_holes_are_no_cracks():
    # a culled patch in the middle, one at the border, and two that meet at a corner
    tiles = [
        patch(range(4), range(4), left=3 * column, top=3 * row)
        for row in range(5)
        for column in range(5)
        if (row, column) not in {(1, 1), (2, 2), (0, 4)}
    ]
    report = crack_report(joined(*tiles))
    assert not report
    assert report.open_edges == 60 + 24


def test_a_hole_of_one_triangle_and_one_of_nodata_are_no_cracks():
    mesh = grid_mesh(ROUGH)
    assert not crack_report(without(mesh, 40))
    centre = 3 * 9 + 4
    around = np.flatnonzero((mesh.triangles == centre).any(axis=1))
    assert len(around) == 6
    assert not crack_report(without(mesh, *around))


def test_a_hole_one_row_high_in_a_stretched_grid_is_no_crack():
    mesh = grid_mesh(Heightmap(np.zeros((9, 9)), spacing=(1000.0, 1.0)))
    row = np.arange(2 * 8 * 4 + 2, 2 * 8 * 4 + 14)
    report = crack_report(without(mesh, *row))
    assert not report
    assert report.open_edges == 32 + 14


@pytest.mark.parametrize("spacing", [(1e-3, 1e6), (1e6, 1e-3), (1.0, 1e6)])
def test_a_grid_with_oblong_cells_has_the_cracks_it_has(spacing):
    heights = np.random.default_rng(0).normal(size=(9, 9))
    mesh = grid_mesh(Heightmap(heights, spacing=spacing))
    assert not crack_report(mesh)
    triangles = mesh.triangles.copy()
    triangles[50] = triangles[50, ::-1]
    assert crack_report(replace(mesh, triangles=triangles)).folded == 1
    # the eastern half stands higher
    east = (mesh.vertices[mesh.triangles, 0] >= 4 * np.float32(spacing[0])).all(axis=1)
    torn = unwelded(mesh)
    vertices = torn.vertices.copy()
    vertices[np.repeat(east, 3), 2] += 0.5
    report = crack_report(replace(torn, vertices=vertices))
    assert (report.cracks, report.largest_gap) == (16, pytest.approx(0.5))


def test_a_narrow_hole_between_coarse_and_fine_is_no_crack():
    coarse = [patch([0, 10], [0, 10], left=10 * column) for column in range(20)]
    fine = patch(range(11), range(3), left=90, top=11)
    assert not crack_report(joined(*coarse, fine))


def test_a_skirt_is_no_crack():
    mesh = grid_mesh(ROUGH)
    rim = mesh.vertices[:9]
    wall = np.stack([rim, rim - np.float32([0, 0, 50])], axis=1)
    quads = 2 * np.arange(8)[:, None] + np.array([0, 2, 1, 1, 2, 3])
    skirt = mesh_of(wall, quads)
    report = crack_report(joined(mesh, skirt))
    assert not report
    # on two sides meshes with skirts look closed and are not
    assert report.open_edges == 28 + 2


def test_winding_does_not_matter():
    mesh = grid_mesh(ROUGH)
    assert not crack_report(replace(mesh, triangles=mesh.triangles[:, ::-1]))


def test_an_empty_mesh_has_no_cracks():
    assert not crack_report(mesh_of(np.zeros((0, 3)), []))
    assert not crack_report(mesh_of(np.eye(3), []))
    assert not crack_report(mesh_of(np.eye(3), []), closed=True)


# cracked


@pytest.mark.parametrize("gap", [1e-6, 0.7, 1e4])
def test_a_vertex_at_another_height_is_found_and_measured(gap):
    left = patch([0, 1, 2], [0, 1, 2])
    right = patch([0, 1, 2], [0, 1, 2], left=2)
    broken = moved(right, vertex_at(right, 2, -1), (0, 0, gap))
    report = crack_report(replace(joined(left, broken), origin=np.array([500_000.0, 4e6, 100.0])))
    assert report
    # both edges on both sides
    assert (report.cracks, report.t_junctions) == (4, 0)
    assert report.open_edges == 12 + 4
    assert report.largest_gap == pytest.approx(gap)
    (crack,) = report.places
    assert crack.gap == report.largest_gap
    assert crack.point[:2] == (500_002, 3_999_999)
    assert crack.point[2] in (100.0, pytest.approx(100 + gap))


@pytest.mark.parametrize("by", [(0.15, 0, 0), (0, 0.2, 0), (-0.1, 0.1, 0), (1e-5, 0, 0)])
def test_a_vertex_moved_aside_is_found_and_measured(by):
    left = patch([0, 1, 2], [0, 1, 2])
    right = patch([0, 1, 2], [0, 1, 2], left=2)
    report = crack_report(joined(left, moved(right, vertex_at(right, 2, -1), by)))
    assert report.cracks == 4
    assert report.largest_gap == pytest.approx(np.linalg.norm(by), rel=0.05)


def test_a_t_junction_without_a_gap():
    #   +---+---+
    #   |   |   |     the large cell has no vertex at x
    #   +---x---+
    #   |       |
    #   +-------+
    fine = patch([0, 1, 2], [0, 1])
    coarse = patch([0, 2], [0, 2], top=1)
    report = crack_report(joined(fine, coarse))
    assert (report.cracks, report.t_junctions, report.largest_gap) == (3, 1, 0)
    assert str(report).startswith("3 cracked edges, 1 T-junction, largest gap 0 at (")


def test_a_t_junction_with_a_gap():
    # heights bend at the vertex that the other side lacks
    fine = patch([0, 1, 2], [0, 1], height=lambda x, y: np.where(x == 1, 0.25, 0.0))
    coarse = patch([0, 2], [0, 2], top=1)
    report = crack_report(joined(fine, coarse))
    assert (report.cracks, report.t_junctions, report.largest_gap) == (3, 1, 0.25)
    assert report.places[0].point[:2] == (1, -1)


def test_a_t_junction_on_a_slanting_edge():
    #  two triangles along y = -x, the lower with a vertex in the middle of it
    upper = mesh_of([(0, 0, 0), (7, -7, 7), (7, 0, 0)], [(0, 1, 2)])
    lower = mesh_of([(0, 0, 0), (0, -7, 0), (3, -3, 3.5), (7, -7, 7)], [(0, 1, 2), (2, 1, 3)])
    report = crack_report(joined(upper, lower))
    assert (report.cracks, report.t_junctions) == (3, 1)
    assert report.largest_gap == pytest.approx(0.5)


def test_a_t_junction_at_slivers():
    # the vertex is off the slanting edge by rounding, more than the slivers are wide
    middle = (7 / 3, -1, 0)
    upper = mesh_of([(0, 0, 0), (7, -3, 0), (7, 0, 0)], [(0, 1, 2)])
    lower = mesh_of(
        [(0, 0, 0), middle, (1, -3 / 7 - 1e-7, 0), (7, -3, 0), (5, -15 / 7 - 3e-7, 0)],
        [(0, 2, 1), (1, 4, 3)],
    )
    assert crack_report(joined(upper, lower)).t_junctions >= 1


def test_four_corners_that_miss_each_other():
    tiles = [
        patch([0, 1, 2], [0, 1, 2], left=2 * column, top=2 * row)
        for row in range(2)
        for column in range(2)
    ]
    aside = [(0, 0, 0), (0.001, 0, 0), (0.1, 0, 0), (0.101, 0, 0)]
    apart = [moved(tile, vertex_at(tile, 2, -2), by) for tile, by in zip(tiles, aside, strict=True)]
    assert crack_report(joined(*apart)).cracks == 8


@pytest.mark.parametrize("factors", [(3, 5), (1, 15), (4, 8)])
def test_patches_with_different_factors_on_a_shared_edge(factors):
    one, two = (np.linspace(0, 60, factor + 1) for factor in factors)
    west = patch([0, 60], one)
    east = patch([60, 120], two)
    report = crack_report(joined(west, east))
    assert report.cracks == sum(factors)
    met = len(np.intersect1d(one, two)) - 2
    assert report.t_junctions == sum(factors) - 2 - 2 * met


def test_a_crack_beside_a_hole_and_not_the_hole():
    tiles = {
        (row, column): patch(range(4), range(4), left=3 * column, top=3 * row)
        for row in range(3)
        for column in range(3)
    }
    del tiles[1, 1]
    # at the hole's edge nothing is across; at the next tile's something is
    tiles[1, 0] = moved(tiles[1, 0], vertex_at(tiles[1, 0], 3, -4), (0, 0, 1))
    assert not crack_report(joined(*tiles.values()))
    tiles[1, 0] = moved(tiles[1, 0], vertex_at(tiles[1, 0], 1, -3), (0, 0, 1))
    assert crack_report(joined(*tiles.values())).cracks == 4


def test_the_widest_places_come_first():
    left = patch([0, 1], range(9))
    right = patch([0, 1], range(9), left=1)
    for row in range(1, 8):
        right = moved(right, vertex_at(right, 1, -row), (0, 0, row))
    report = crack_report(joined(left, right))
    assert [crack.gap for crack in report.places] == [7, 6, 5, 4, 3]
    assert [crack.point[1] for crack in report.places] == [-7, -6, -5, -4, -3]


def test_folds_are_found():
    # a vertex pulled over its neighbours
    mesh = grid_mesh(Heightmap(np.zeros((9, 9))))
    report = crack_report(moved(mesh, vertex_at(mesh, 4, -4), (1.5, 0, 0)))
    assert report
    assert (report.cracks, report.folded) == (0, 2)
    assert str(report) == "2 folded triangles"


def test_a_triangle_turned_over_is_found():
    mesh = grid_mesh(ROUGH)
    triangles = mesh.triangles.copy()
    triangles[50] = triangles[50, ::-1]
    report = crack_report(replace(mesh, triangles=triangles))
    assert (report.folded, report.unbalanced) == (1, 3)


def test_slivers_that_rounding_turned_over_are_no_folds():
    # the middle of the long side is 1 unit in the last place below it
    ulp = float(np.spacing(np.float32(4096)))
    corners = [(4096, -4096, 0), (4098, -4096, 0), (4097, -4096 - ulp, 0), (4097, -4090, 0)]
    mesh = mesh_of(corners, [(0, 1, 2), (1, 3, 2), (2, 3, 0)])
    assert mesh.vertices[2, 1] < -4096
    assert not crack_report(mesh)
    assert crack_report(moved(mesh, 2, (0, -0.01, 0))).folded == 1


# repetitions and degenerate triangles


def test_triangles_that_say_nothing_are_left_out():
    mesh = grid_mesh(ROUGH)
    same = mesh.triangles[[7]]
    nothing = np.int32([(3, 3, 4), (5, 5, 5)])
    report = crack_report(
        replace(mesh, triangles=np.concatenate([mesh.triangles, same, same[:, [1, 2, 0]], nothing]))
    )
    assert not report
    assert report.left_out == 4


def test_a_pleat_of_upright_triangles_closes_a_gap():
    # a wall between an edge and its middle vertex at another height, as collapsed strips make
    far = mesh_of([(0, 0, 0), (2, 0, 0), (0, 2, 0), (2, 2, 0)], [(0, 1, 2), (1, 3, 2)])
    near = mesh_of([(0, 0, 0), (1, 0, 1), (2, 0, 0), (1, -2, 0)], [(0, 3, 1), (1, 3, 2)])
    wall = mesh_of([(0, 0, 0), (1, 0, 1), (2, 0, 0)], [(0, 1, 2)])
    assert crack_report(joined(far, near)).t_junctions == 1
    assert not crack_report(joined(far, near, wall))


def test_four_triangles_at_an_edge_are_balanced_and_three_are_not():
    corners = [(0, 0, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)]
    four = mesh_of(corners, [(0, 1, 2), (1, 0, 3), (0, 1, 4), (1, 0, 5)])
    assert not crack_report(four)
    three = crack_report(without(four, 3))
    assert three.unbalanced == 1
    assert str(three) == "1 unbalanced edge"


# other meshes


def tetrahedron() -> Mesh:
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    return mesh_of(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


def test_a_closed_mesh_is_closed():
    report = crack_report(unwelded(tetrahedron()), closed=True)
    assert not report
    assert report.open_edges == 0


def test_an_open_mesh_is_cracked_only_if_it_was_to_be_closed():
    mesh = without(tetrahedron(), 3)
    assert not crack_report(mesh)
    report = crack_report(mesh, closed=True)
    assert (report.open_edges, report.cracks) == (3, 3)
    assert report.largest_gap == np.inf
    assert len(report.places) == 3


def test_a_slit_in_a_closed_mesh_is_a_crack():
    mesh = unwelded(tetrahedron())
    report = crack_report(moved(mesh, 11, (0, 0, 0.01)))
    assert report.cracks == 4
    assert report.largest_gap == pytest.approx(0.01, rel=1e-3)


@pytest.mark.parametrize(
    ("surface", "closed"),
    [
        (pyvista.Sphere(), True),
        (pyvista.ParametricTorus(), True),
        (pyvista.Cube().triangulate(), True),
        (pyvista.Cylinder(capping=False).triangulate(), False),
        (pyvista.Disc(r_res=4, c_res=30).triangulate(), False),
    ],
    ids=["sphere", "torus", "cube", "tube", "disc"],
)
def test_surfaces_of_pyvista(surface, closed):
    mesh = mesh_of(surface.points, surface.regular_faces)
    assert not crack_report(mesh)
    # a seam that is closed only nearly is one of rounding: the torus's
    assert (crack_report(mesh, closed=True).open_edges == 0) == closed


@pytest.mark.slow
@settings(deadline=None, max_examples=50)
@given(st.data())
def test_any_grid_of_patches_is_watertight_until_one_vertex_moves(data):
    lines = st.lists(st.integers(1, 31), min_size=1, max_size=3, unique=True)
    rows, columns = ([0, *sorted(data.draw(lines)), 32] for _ in range(2))
    rng = np.random.default_rng(data.draw(st.integers(0, 99)))
    slopes = rng.normal(0, 10, (33, 33)).astype(np.float32)

    def height(x, y):
        return slopes[(-y).astype(int), x.astype(int)]

    tiles = [
        patch(range(left, right + 1), range(top, bottom + 1), height=height)
        for top, bottom in pairwise(rows)
        for left, right in pairwise(columns)
    ]
    whole = joined(*tiles)
    assert not crack_report(whole)
    # a vertex on a line between two patches, not on the outline
    x, y = columns[1], -data.draw(st.integers(1, 31))
    by = data.draw(st.sampled_from([(0, 0, 1), (0, 0, 1e-3), (0.1, 0, 0), (0, 0.1, 0)]))
    broken = crack_report(moved(whole, vertex_at(whole, x, y), by))
    assert broken.cracks >= 4
    assert broken.largest_gap == pytest.approx(np.linalg.norm(by), rel=0.1)


def test_what_cannot_be_followed_is_refused():
    with pytest.raises(InputError, match="finite positions"):
        crack_report(mesh_of(np.full((3, 3), np.inf), [(0, 1, 2)]))
    with pytest.raises(InputError, match="among its 3 vertices"):
        crack_report(mesh_of(np.eye(3), [(0, 1, -1)]))
