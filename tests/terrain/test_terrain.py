"""The stages in a chain: watertight for any camera, and the same in every other way."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.cameras import cameras_over
from support.grounds import holed, rough

ORIGIN = (500_000.0, 4_000_000.0)
GROUNDS = {
    "rough": rough(200, 170, spacing=30.0, origin=ORIGIN),
    "holed": holed(150, 180, spacing=(10.0, 25.0), origin=ORIGIN),
    "canyon": tl.Heightmap(tl.sample("canyon").elevation[:400, :300], spacing=15.0, origin=ORIGIN),
}
LODS = [
    tl.DistanceLod(falloff=1.7),
    tl.CoplanarityLod(),
    tl.CoplanarityLod(pixels=9.0, minimum=2.3, maximum=40.0),
    tl.BookCoplanarityLod(minimum=2.3, maximum=40.0, far=3000.0),
    tl.ScreenErrorLod(2.0),
    tl.UniformLod(4.7),
]
PARTITIONINGS = ["fractional_odd", "fractional_even", "integer", "pow2"]


def assert_edges_are_bit_equal(mesh: tl.Mesh, terrain: tl.Terrain) -> None:
    """Assert that patches which share an edge have the same vertices on it, to the bit."""
    patches = mesh.patches
    rows, columns = patches.shape
    drawn = patches.drawn.reshape(rows, columns)
    dx, dy = terrain.ground.spacing
    xs, ys = terrain.grid.corner_columns * dx, terrain.grid.corner_rows * -dy

    def on_edge(patch: int, axis: int, place: float) -> dict[bytes, bytes]:
        """Return the vertices of a patch on a line of the grid: where along it, and the whole."""
        vertices = mesh.vertices[slice(*patches.point_offsets[patch : patch + 2])]
        there = vertices[vertices[:, axis] == np.float32(place)]
        return {vertex[1 - axis].tobytes(): vertex.tobytes() for vertex in there}

    def assert_same(one: dict[bytes, bytes], other: dict[bytes, bytes]) -> None:
        # beside a hole, a patch has no more vertices than its triangles need
        if terrain.ground.mask is None:
            assert one
            assert one.keys() == other.keys()
        assert all(one[place] == other[place] for place in one.keys() & other.keys())

    for row, column in np.argwhere(drawn):
        patch = row * columns + column
        if column + 1 < columns and drawn[row, column + 1]:
            x = xs[column + 1]
            assert_same(on_edge(patch, 0, x), on_edge(patch + 1, 0, x))
        if row + 1 < rows and drawn[row + 1, column]:
            y = ys[row + 1]
            assert_same(on_edge(patch, 1, y), on_edge(patch + columns, 1, y))


@pytest.mark.slow
@pytest.mark.parametrize("name", GROUNDS)
def test_no_cracks_in_two_hundred_cameras(name: str) -> None:
    ground = GROUNDS[name]
    terrains = [tl.Terrain(ground, tile=tile) for tile in (15, 7, 31, 10)]
    culled = 0
    for index, camera in enumerate(cameras_over(ground, 200)):
        partitioning = PARTITIONINGS[index // 5 % 4]
        terrain, lod = terrains[index % 4], LODS[index % 5]
        # promises go by the edge's own error
        rule = None if isinstance(lod, tl.PromiseLod) else ("min", "max")[index % 2]
        mesh = terrain.mesh(camera, lod=lod, edge_rule=rule, partitioning=partitioning)
        # just above an even number Direct3D's fractional_even folds triangles by 1/65536: closed
        # all the same, edge by edge, but no longer a surface seen from above
        if partitioning == "fractional_even":
            assert_edges_are_bit_equal(mesh, terrain)
        else:
            report = tl.crack_report(mesh)
            assert not report, f"camera {index}: {report}"
        culled += mesh.patches.culled_count
        if (
            index % 20 == 0 and mesh.patches.count == terrain.grid.count
        ):  # not patches of every size
            assert_edges_are_bit_equal(mesh, terrain)
    assert culled > 0


def test_vertices_are_those_of_triangles() -> None:
    ground = GROUNDS["holed"]
    low, high = ground.height_range
    terrain = tl.Terrain(ground)
    for lod in (tl.UniformLod(4.7), tl.UniformLod(15), tl.MaxErrorLod(1.0)):
        mesh = terrain.mesh(lod=lod)
        np.testing.assert_array_equal(np.unique(mesh.triangles), np.arange(len(mesh.vertices)))
        # so none stands at the height of a sample without data
        heights = mesh.vertices[:, 2] + mesh.origin[2]
        assert low <= heights.min() <= heights.max() <= high
        assert mesh.patches.point_offsets[-1] == len(mesh.vertices)
        # and each patch's triangles have corners among its own
        starts = mesh.patches.point_offsets[mesh.triangle_patches]
        ends = mesh.patches.point_offsets[mesh.triangle_patches + 1]
        assert (mesh.triangles >= starts[:, None]).all()
        assert (mesh.triangles < ends[:, None]).all()


def test_patches_without_data_are_not_meshed() -> None:
    ground = GROUNDS["holed"]
    mesh = tl.Terrain(ground).mesh(lod=tl.UniformLod(15))
    assert not mesh.patches.drawn[0]
    error = tl.vertical_error(mesh, ground)
    assert error.maximum == 0
    # uncovered are only samples that no whole cell touches
    valid = ground.valid
    cell = valid[:-1, :-1] & valid[1:, :-1] & valid[:-1, 1:] & valid[1:, 1:]
    reached = np.zeros_like(valid)
    for down in (0, 1):
        for across in (0, 1):
            reached[down : down + cell.shape[0], across : across + cell.shape[1]] |= cell
    assert error.uncovered == np.count_nonzero(valid & ~reached)


def test_the_same_question_has_the_same_answer() -> None:
    terrain, camera = tl.Terrain(GROUNDS["rough"]), cameras_over(GROUNDS["rough"], 1)[0]
    first, second = terrain.mesh(camera), terrain.mesh(camera)
    np.testing.assert_array_equal(first.vertices, second.vertices)
    np.testing.assert_array_equal(first.triangles, second.triangles)


def test_coplanarity_saves_triangles_and_has_the_smaller_error_for_as_many() -> None:
    # figures 9.22 and 9.23: 32,500 triangles become 22,232
    ground = tl.sample("islands")
    terrain, camera = tl.Terrain(ground, levels=1), tl.default_camera(ground)
    naive = terrain.mesh(camera, lod=tl.DistanceLod())
    clever = terrain.mesh(camera, lod=tl.CoplanarityLod())
    assert len(clever.triangles) < 0.7 * len(naive.triangles)
    low, high = 1.0, 15.0
    for _ in range(14):
        middle = (low + high) / 2
        equal = terrain.mesh(camera, lod=tl.DistanceLod(maximum=middle))
        low, high = (
            (middle, high) if len(equal.triangles) < len(clever.triangles) else (low, middle)
        )
    assert tl.vertical_error(clever, ground).rms < tl.vertical_error(equal, ground).rms


@pytest.mark.parametrize("shape", [(2, 2), (2, 50), (50, 2), (16, 16), (17, 17)])
def test_small_rasters(shape: tuple[int, int]) -> None:
    ground = rough(*shape)
    mesh = tl.Terrain(ground).mesh(lod=tl.UniformLod(15))
    assert tl.vertical_error(mesh, ground).maximum == 0
    assert not tl.crack_report(mesh)


def test_a_raster_larger_than_the_device_is_refused_with_both_numbers() -> None:
    ground = rough(30, 30)
    device = tl.Device.open()
    object.__setattr__(ground, "heights", np.broadcast_to(np.float32(0), (10**6, 10**6)))
    with pytest.raises(tl.DeviceMemoryError, match=r"40000000000\d\d bytes.*has .* bytes"):
        tl.Terrain(ground)
    assert device.allocated < device.info.memory


@pytest.mark.parametrize("tile", [0, 64, 2.5])
def test_wrong_tile(tile: float) -> None:
    with pytest.raises(tl.InputError, match="from 1 to 63 for tile"):
        tl.Terrain(rough(), tile=tile)


def test_unknown_partitioning_lists_what_exists() -> None:
    with pytest.raises(tl.InputError, match="fractional_odd"):
        tl.Terrain(rough()).mesh(lod=tl.UniformLod(3), partitioning="odd")


@pytest.mark.parametrize("tile", [7, 15])
@pytest.mark.parametrize("shape", [(61, 46), (100, 77)])
def test_without_camera_and_level_of_detail_every_sample_is_a_vertex(tile: int, shape) -> None:
    ground = rough(*shape, spacing=(30.0, 20.0), origin=(500_000, 4_000_000))
    mesh = tl.Terrain(ground, tile=tile).mesh()
    assert tl.vertical_error(mesh, ground).maximum == 0
    row, column = np.indices(shape).reshape(2, -1)
    places = {tuple(place) for place in mesh.vertices[:, :2].tolist()}
    assert set(zip((column * 30.0).tolist(), (row * -20.0).tolist(), strict=True)) <= places
    if tile == 15 and shape == (61, 46):  # in whole tiles: and nothing else
        assert len(mesh.triangles) == 2 * 60 * 45


def test_a_level_of_detail_that_needs_a_camera_says_so() -> None:
    with pytest.raises(tl.InputError, match="ScreenErrorLod needs a camera, got none"):
        tl.Terrain(rough()).mesh(lod=tl.ScreenErrorLod())
