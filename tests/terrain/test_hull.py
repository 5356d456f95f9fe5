"""The hull stage: the same bits on shared edges, ranges, culling."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import rough
from terrain_lod.terrain.control_points import patch_indices
from terrain_lod.terrain.hull import hull_on_device

LODS = [
    tl.UniformLod(5.5),
    tl.DistanceLod(near=100, far=3000),
    tl.DistanceLod(falloff=2.5, maximum=63),
    tl.CoplanarityLod(),
    tl.CoplanarityLod(pixels=100.0, minimum=2.0, maximum=40.0),
    tl.BookCoplanarityLod(),
    tl.BookCoplanarityLod(full_deviation=30.0, flat_weight=0.0, minimum=2.0),
    tl.ScreenAreaLod(),
    tl.ScreenAreaLod(pixels=25.0, minimum=1.5, maximum=40.0),
]


def camera_over(ground: tl.Heightmap) -> tl.Camera:
    x, y, z = ground.centre
    return tl.Camera((x - 300, y - 400, z + 500), (x + 500, y + 700, z), far=5e4)


def factors(terrain: tl.Terrain, camera: tl.Camera, lod: tl.Lod, edges: str, cull: bool):
    found = hull_on_device(terrain._tiles, lod, camera, edge_rule=edges, cull=cull)
    return found.edge.host(), found.inside.host()


@pytest.mark.parametrize("lod", LODS, ids=repr)
@pytest.mark.parametrize("edges", ["min", "max"])
def test_both_sides_of_an_edge_find_the_same_bits(lod: tl.Lod, edges: str) -> None:
    # with far corners summed in another order than near ones, half of the edges differ here
    ground = rough(200, 170, spacing=30.0, origin=(500_000, 4_000_000))
    terrain = tl.Terrain(ground)
    edge, _ = factors(terrain, camera_over(ground), lod, edges, cull=False)
    west, north, east, south = np.moveaxis(edge.reshape(*terrain.grid.shape, 4), -1, 0)
    np.testing.assert_array_equal(east[:, :-1], west[:, 1:])
    np.testing.assert_array_equal(south[:-1], north[1:])


def test_index_buffer_is_the_drawing() -> None:
    #   0   1   2   3        a 3 x 3 terrain has 4 x 4 control points; the patch in the middle
    #   4   5   6   7        is clamped nowhere
    #   8   9  10  11
    #  12  13  14  15
    indices = patch_indices(3, 3)
    assert indices.dtype == np.int32
    np.testing.assert_array_equal(indices[4], [5, 6, 9, 10, 7, 11, 13, 14, 4, 8, 1, 2])
    # the north-western patch has no neighbours to the west and north: their far corners are its own
    np.testing.assert_array_equal(indices[0], [0, 1, 4, 5, 2, 6, 8, 9, 0, 4, 0, 1])
    # a terrain of one tile has none at all
    np.testing.assert_array_equal(patch_indices(1, 1), [[0, 1, 2, 3, 1, 3, 2, 3, 0, 2, 0, 1]])


def test_no_factor_leaves_its_range() -> None:
    # listing 9.7 does not clamp: beyond the far distance factors fall to zero and cull the patch
    ground = rough(spacing=30.0)
    terrain = tl.Terrain(ground)
    x, y, z = ground.centre
    for distance in (0.5, 1e3, 1e7):
        camera = tl.Camera((x, y, z + distance), (x + 1, y, z))
        edge, inside = factors(terrain, camera, tl.DistanceLod(near=10, far=500), "min", False)
        for found in (edge, inside):
            assert found.min() >= 1
            assert found.max() <= 15


def test_a_peak_near_the_eye_is_near() -> None:
    # the book measures to the undisplaced midpoint, far below
    heights = np.zeros((61, 61))
    heights[15:31, 15:31] = 5000
    terrain = tl.Terrain(tl.Heightmap(heights, spacing=10.0), levels=1)
    camera = tl.Camera((225, -225, 5050), (225, -100, 5000))
    _, inside = factors(terrain, camera, tl.DistanceLod(far=3000), "min", False)
    assert inside.reshape(4, 4, 2)[1, 1].min() > 14


def test_nothing_in_view_is_culled_and_what_is_behind_is() -> None:
    ground = rough(150, 150, spacing=30.0)
    terrain = tl.Terrain(ground)
    rng = np.random.default_rng(4)
    x, y, z = ground.centre
    for _ in range(40):
        eye = np.array([x, y, z]) + rng.normal(size=3) * (1500, 1500, 400)
        target = eye + rng.normal(size=3)
        camera = tl.Camera(tuple(eye), tuple(target), fov=rng.uniform(1, 120), far=4000, near=1)
        mesh = terrain.mesh(camera, lod=tl.UniformLod(15))
        everything = terrain.mesh(camera, lod=tl.UniformLod(15), cull=False)
        kept = mesh.patches.drawn
        # a vertex inside the frustum belongs to a patch that is drawn
        vertices = everything.vertices.astype(float) + everything.origin
        pixels, depth = camera.project(vertices)
        inside = (depth >= camera.near) & (depth <= camera.far)
        inside &= (pixels >= 0).all(axis=1) & (pixels <= camera.size).all(axis=1)
        patch = np.repeat(np.arange(len(kept)), np.diff(everything.patches.point_offsets))
        assert kept[patch[inside]].all()
    behind = tl.Camera((x, y + 9000, z), (x, y + 9001, z))
    assert terrain.mesh(behind, lod=tl.UniformLod(3)).patches.culled_count == terrain.grid.count


def test_unknown_edge_rule() -> None:
    with pytest.raises(tl.InputError, match="min, max"):
        tl.Terrain(rough()).mesh(lod=tl.UniformLod(3), edge_rule="mean")


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: tl.UniformLod(float("nan")), "factor"),
        (lambda: tl.UniformLod(0.5), "from 1 to 63"),
        (lambda: tl.DistanceLod(near=10, far=10), "far > near"),
        (lambda: tl.DistanceLod(minimum=9, maximum=5), "maximum >= minimum"),
        (lambda: tl.DistanceLod(falloff=0), "falloff > 0"),
        (lambda: tl.ScreenAreaLod(pixels=0), "pixels > 0"),
        (lambda: tl.ScreenAreaLod(minimum=9, maximum=5), "maximum >= minimum"),
        (lambda: tl.BookCoplanarityLod(full_deviation=0), "full_deviation > 0"),
        (lambda: tl.BookCoplanarityLod(flat_weight=1.5), "from 0 to 1"),
    ],
)
def test_wrong_parameters(make, message: str) -> None:
    with pytest.raises(tl.InputError, match=message):
        make()


def test_a_level_of_detail_that_needs_a_camera_says_so() -> None:
    with pytest.raises(tl.InputError, match="DistanceLod needs a camera"):
        tl.Terrain(rough()).mesh(lod=tl.DistanceLod())
