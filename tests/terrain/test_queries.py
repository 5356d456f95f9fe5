"""Heights and rays: the kernels' walks against every cell and every triangle tried."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import terrain_lod as tl
from support.grounds import holed, plane, rough
from terrain_lod.mesh.queries import MeshQueries
from terrain_lod.reference.mesh import queries as queries_mesh
from terrain_lod.reference.terrain import queries as queries_ground

# two roundings of UTM coordinates, over slopes of some hundred to one
TOLERANCE = 1e-6
PLACES = {
    "home": {},
    "utm": {
        "origin": (500_000.3, 4_000_000.7),
        "spacing": (30.0, 20.0),
        "base": 2000.0,
    },
    "fine": {"origin": (-3e5, 7e6), "spacing": (0.1, 0.3)},
}


def rays_over(ground: tl.Heightmap, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return rays from above, below and beside; some upright, level, along cells' borders."""
    random = np.random.default_rng(seed)
    width, depth = ground.extent
    low, high = ground.height_range
    origins = random.uniform(-0.2, 1.2, (count, 3)) * (width, -depth, 2 * (high - low))
    origins += (*ground.origin, low - (high - low) / 2)
    directions = random.normal(size=(count, 3)) * (width, depth, 2 * (high - low))
    directions[::11, :2] = 0
    directions[1::11, 2] = 0
    directions[2::11, 0] = 0
    directions[3::11, 1] = 0
    # from a sample along its row, column or straight down
    row, column = random.integers(0, ground.shape[0]), random.integers(0, ground.shape[1])
    origins[::3, 0] = ground.origin[0] + column * ground.spacing[0]
    origins[::3, 1] = ground.origin[1] - row * ground.spacing[1]
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


@pytest.mark.parametrize("place", PLACES)
def test_on_samples_both_are_the_samples(place: str) -> None:
    ground = holed(66, 50, **PLACES[place])
    terrain = tl.Terrain(ground)
    row, column = np.indices(ground.shape)
    x = ground.origin[0] + column.ravel() * ground.spacing[0]
    y = ground.origin[1] - row.ravel() * ground.spacing[1]
    points = np.stack([x, y], axis=1)
    np.testing.assert_array_equal(terrain.height_at(points), ground.elevation.ravel())
    # of the mesh, the outline as well, wherever float32 puts it
    whole = rough(66, 50, **PLACES[place])
    found = MeshQueries(tl.Terrain(whole).mesh(lod=tl.UniformLod(15))).height_at(points)
    np.testing.assert_allclose(found, whole.elevation.ravel(), atol=1e-2)


@pytest.mark.slow
@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    place=st.sampled_from(list(PLACES)),
    make=st.sampled_from([rough, holed]),
    tile=st.sampled_from([7, 15, 31]),
)
def test_rays_against_the_ground(seed: int, place: str, make, tile: int) -> None:
    ground = make(52, 45, seed=seed, **PLACES[place])
    origins, directions = rays_over(ground, 120, seed)
    terrain = tl.Terrain(ground, tile=tile)
    hits = terrain.cast(origins, directions)
    expected = queries_ground.distances(ground, origins, directions)
    assert hits.hit.any()
    assert_same_distances(hits, expected, hits.distance, ground)
    # the hit is on the ground, in the tile that it names
    there = hits.position[hits.hit]
    cells = (there[:, :2] - ground.origin) / (ground.spacing[0], -ground.spacing[1])
    for corners, along, tiles in (
        (terrain.grid.corner_columns, cells[:, 0], hits.tile[hits.hit] % terrain.grid.shape[1]),
        (terrain.grid.corner_rows, cells[:, 1], hits.tile[hits.hit] // terrain.grid.shape[1]),
    ):
        assert (along >= corners[tiles] - 1e-6).all()
        assert (along <= corners[tiles + 1] + 1e-6).all()


@pytest.mark.parametrize("place", PLACES)
def test_straight_down_on_a_sample_any_cell_around_it_is_met(place: str) -> None:
    ground = holed(66, 50, **PLACES[place])
    row, column = np.indices(ground.shape)
    x = ground.origin[0] + column.ravel() * ground.spacing[0]
    y = ground.origin[1] - row.ravel() * ground.spacing[1]
    origins = np.stack([x, y, np.full(x.size, ground.height_range[1] + 10)], axis=1)
    hits = tl.Terrain(ground).cast(origins, [(0, 0, -1)])
    valid = ground.valid
    cells = np.pad(valid[1:, 1:] & valid[1:, :-1] & valid[:-1, 1:] & valid[:-1, :-1], 1)
    around = cells[1:, 1:] | cells[1:, :-1] | cells[:-1, 1:] | cells[:-1, :-1]
    np.testing.assert_array_equal(hits.hit, around.ravel())
    expected = ground.elevation[around]
    np.testing.assert_allclose(hits.position[hits.hit, 2], expected, rtol=0, atol=1e-9)


def assert_same_distances(hits, expected, found, ground: tl.Heightmap) -> None:
    """Assert equal distances; rays that touch the outline or a tangent may go either way."""
    differ = np.isnan(found) != np.isnan(expected)
    assert differ.sum() <= 1
    both = ~(np.isnan(found) | np.isnan(expected))
    # roundings of coordinates of millions, and where the ground is nearly along the ray
    close = np.abs(found - expected)[both] <= 1e-5 * np.hypot(*ground.extent)
    assert np.count_nonzero(~close) <= 1


def test_rays_against_the_ground_by_steps() -> None:
    # nothing but heights is used: the first of many small steps that is on the other side
    ground = rough(52, 45, **PLACES["utm"])
    terrain = tl.Terrain(ground)
    origins, directions = rays_over(ground, 40, seed=3)
    distance = terrain.cast(origins, directions).distance
    steps = np.linspace(0, 3 * np.hypot(*ground.extent), 40_001)
    for origin, direction, found in zip(origins, directions, distance, strict=True):
        points = origin + steps[:, None] * direction
        above = np.sign(points[:, 2] - terrain.height_at(points[:, :2]))
        change = np.flatnonzero(above[1:] * above[:-1] == -1)
        if not np.isnan(found):
            assert not len(change) or found <= steps[change[0] + 1] + 1e-6
        else:
            assert not len(change)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000), place=st.sampled_from(["home", "utm"]))
def test_heights_and_rays_of_a_mesh(seed: int, place: str) -> None:
    ground = rough(52, 45, seed=seed, **PLACES[place])
    mesh = tl.Terrain(ground).mesh(lod=tl.MaxErrorLod(3.0))
    surface = MeshQueries(mesh)
    origins, directions = rays_over(ground, 80, seed)
    # away from the outline, where a tolerance decides
    points = origins[np.arange(len(origins)) % 3 > 0, :2]
    np.testing.assert_allclose(
        surface.height_at(points), queries_mesh.heights(mesh, points), atol=1e-4
    )
    hits = surface.cast(origins, directions)
    expected = queries_mesh.distances(mesh, origins, directions)
    assert_same_distances(hits, expected, hits.distance, ground)
    corners = mesh.vertices[mesh.triangles[hits.triangle[hits.hit]]].astype(float) + mesh.origin
    off = ((hits.position[hits.hit] - corners[:, 0]) * hits.normal[hits.hit]).sum(axis=1)
    assert np.abs(off).max() < 1e-5
    np.testing.assert_array_equal(
        hits.tile[hits.hit], mesh.triangle_patches[hits.triangle[hits.hit]]
    )
    np.testing.assert_array_equal(
        hits.factor[hits.hit], mesh.patches.inside_factors[hits.tile[hits.hit]]
    )


def test_no_ray_falls_between_triangles_or_cells() -> None:
    # straight at vertices, along edges and borders of cells: a crack of one bit would show
    ground = rough(61, 46, **PLACES["utm"])
    terrain = tl.Terrain(ground)
    surface = MeshQueries(terrain.mesh(lod=tl.UniformLod(4.7)))
    vertices = surface.mesh.vertices.astype(float) + surface.mesh.origin
    random = np.random.default_rng(1)
    eye = np.array([*ground.centre[:2], ground.height_range[1] + 5000.0])
    inner = vertices[np.abs(vertices - ground.centre)[:, 0] < 0.49 * ground.extent[0]]
    inner = inner[np.abs(inner - ground.centre)[:, 1] < 0.49 * ground.extent[1]]
    targets = np.concatenate(
        [inner, (inner[1:] + inner[:-1]) / 2, inner + random.normal(size=inner.shape)]
    )
    assert surface.cast(eye, targets - eye).hit.all()
    assert terrain.cast(eye, targets - eye).hit.all()
    down = np.array([0.0, 0.0, -1.0])
    above = targets * (1, 1, 0) + (0, 0, eye[2])
    assert surface.cast(above, down).hit.all()
    assert not np.isnan(surface.height_at(above[:, :2])).any()
    assert terrain.cast(above, down).hit.all()


def test_a_plane_is_hit_where_it_is() -> None:
    #   z = 0.5 per cell east; a ray from (10, -20, 100) straight down meets 5
    ground = plane(0.5, 0.0)
    terrain = tl.Terrain(ground, tile=15)
    surface = MeshQueries(terrain.mesh(lod=tl.UniformLod(1)))
    for hits in (
        terrain.cast([10, -20, 100], [0, 0, -9]),
        surface.cast([10, -20, 100], [0, 0, -9]),
    ):
        np.testing.assert_allclose(hits.position, [[10, -20, 5]])
        np.testing.assert_allclose(hits.distance, [95])
        np.testing.assert_allclose(
            hits.normal, np.array([[-0.5, 0, 1]]) / np.hypot(0.5, 1), atol=1e-7
        )
        assert hits.tile[0] == 3
    assert hits.triangle[0] in (6, 7)
    np.testing.assert_array_equal(hits.factor, [[1, 1]])
    missed = surface.cast([10, -20, 100], [0, 0, 1])
    assert repr(missed) == "Hits(0 of 1 rays)"
    assert missed.tile[0] == missed.triangle[0] == -1
    assert np.isnan(missed.position).all()
    assert np.isnan(missed.factor).all()


def test_tile_by_tile_skipping_misses_nothing_on_last_tiles() -> None:
    # 38 cells are tiles of 15, 15, 5 and 3
    ground = rough(39, 39)
    terrain = tl.Terrain(ground)
    row, column = np.indices((38, 38)).reshape(2, -1)
    above = np.stack([column + 0.5, -(row + 0.5), 0 * row + 1e4], axis=1)
    hits = terrain.cast(above, [0, 0, -1])
    assert hits.hit.all()
    across = np.searchsorted(terrain.grid.corner_columns, column, side="right") - 1
    down = np.searchsorted(terrain.grid.corner_rows, row, side="right") - 1
    np.testing.assert_array_equal(hits.tile, down * terrain.grid.shape[1] + across)


@pytest.mark.parametrize("seed", range(3))
def test_triangles_of_all_sizes_that_cross_each_other(seed: int) -> None:
    # a triangle over many bins is met in the first, and hit far behind nearer ones
    random = np.random.default_rng(seed)
    at = random.uniform(-100, 100, (400, 1, 3))
    corners = at + random.normal(size=(400, 3, 3)) * random.exponential(40, (400, 1, 1))
    mesh = tl.Mesh(
        corners.reshape(-1, 3).astype(np.float32),
        np.zeros((1200, 3), np.float32),
        np.arange(1200, dtype=np.int32).reshape(-1, 3),
        origin=np.array([5e5, 4e6, 100.0]),
    )
    origins = random.uniform(-150, 150, (500, 3)) + mesh.origin
    directions = random.normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    hits = MeshQueries(mesh).cast(origins, directions)
    expected = queries_mesh.distances(mesh, origins, directions)
    np.testing.assert_allclose(hits.distance, expected, rtol=1e-9, atol=1e-6)
    points = origins[:, :2]
    np.testing.assert_allclose(
        MeshQueries(mesh).height_at(points), queries_mesh.heights(mesh, points), atol=1e-6
    )


def test_any_mesh_can_be_asked() -> None:
    # an upright wall, and a mesh without triangles
    wall = tl.Mesh(
        np.array([[0, 0, 0], [0, 1, 0], [0, 0, 1]], np.float32),
        np.zeros((3, 3), np.float32),
        np.array([[0, 1, 2]], np.int32),
    )
    hits = MeshQueries(wall).cast([[1, 0.2, 0.2], [1, 0.9, 0.9]], [-1, 0, 0])
    np.testing.assert_array_equal(hits.distance, [1, np.nan])
    np.testing.assert_array_equal(hits.tile, [-1, -1])
    empty = tl.Mesh(wall.vertices, wall.normals, np.zeros((0, 3), np.int32))
    assert not MeshQueries(empty).cast([1, 0.2, 0.2], [-1, 0, 0]).hit.any()
    assert np.isnan(MeshQueries(empty).height_at([[0, 0]])).all()


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda t: t.height_at([1, 2, 3]), r"points of shape \(N, 2\), got \(3,\)"),
        (lambda t: t.height_at([[0, np.nan]]), "finite points"),
        (lambda t: t.height_at("here"), "points as real numbers"),
        (lambda t: t.cast([[0, 0, 1]], [[0, 0, 0]]), "directions, got .* for ray 0"),
        (lambda t: t.cast(np.zeros((2, 3)), np.ones((3, 3))), "got 2 and 3"),
        (lambda t: t.cast([[0, np.inf, 0]], [[0, 0, 1]]), "finite origins"),
    ],
)
def test_wrong_questions(ask, message: str) -> None:
    terrain = tl.Terrain(rough(31, 31))
    for surface in (terrain, MeshQueries(terrain.mesh(lod=tl.UniformLod(1)))):
        with pytest.raises(tl.InputError, match=message):
            ask(surface)
    assert terrain.height_at(np.zeros((0, 2))).shape == (0,)


def test_directions_of_any_length() -> None:
    terrain = tl.Terrain(rough(31, 31))
    for length in (1e-200, 1.0, 1e200):
        hits = terrain.cast([[15.3, -15.2, 1e4]], [[0.0, 0.0, -length]])
        assert hits.distance[0] == pytest.approx(1e4 - terrain.height_at([[15.3, -15.2]])[0])
