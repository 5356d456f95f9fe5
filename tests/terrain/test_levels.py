"""Rasters, tiles and levels at their limits: the right mesh, or one clear line."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import rough


def assert_kept(terrain: tl.Terrain, metres: float) -> tl.Mesh:
    mesh = terrain.mesh(lod=tl.MaxErrorLod(metres))
    assert mesh.achieved.kept
    assert tl.vertical_error(mesh, terrain.ground).maximum <= mesh.achieved.metres <= metres
    assert not tl.crack_report(mesh)
    return mesh


def test_tiles_are_small_in_a_quadtree_and_the_books_in_a_flat_grid() -> None:
    ground = rough(40, 40)
    assert tl.Terrain(ground).grid.tile == tl.Terrain(ground, levels=2).grid.tile == 4
    assert tl.Terrain(ground, levels=1).grid.tile == 15
    assert tl.Terrain(ground, levels=1, tile=7).grid.tile == 7


def test_levels_beyond_the_raster_are_those_it_has() -> None:
    ground = rough(40, 33)
    most, all_of_them = (
        assert_kept(tl.Terrain(ground, levels=levels), 100.0) for levels in (16, None)
    )
    np.testing.assert_array_equal(most.vertices, all_of_them.vertices)
    np.testing.assert_array_equal(most.triangles, all_of_them.triangles)


@pytest.mark.parametrize("levels", [1, 2, 3])
def test_no_patch_is_larger_than_its_level(levels: int) -> None:
    mesh = assert_kept(tl.Terrain(tl.Heightmap(np.zeros((50, 70))), tile=4, levels=levels), 1.0)
    assert mesh.patches.areas[:, 2:].max() == 4 * 2 ** (levels - 1)


# a node more than 8 x 8 tiles of 4 has, in one direction and in both
@pytest.mark.parametrize("shape", [(2, 2), (2, 70), (70, 2), (33, 33), (34, 33), (34, 34)])
@pytest.mark.parametrize("tile", [1, 4, 63])
def test_small_and_odd_rasters_keep_their_promise(shape: tuple[int, int], tile: int) -> None:
    terrain = tl.Terrain(rough(*shape, spacing=30.0), tile=tile)
    for metres in (0.01, 20.0, 1e4):
        mesh = assert_kept(terrain, metres)
    assert len(mesh.triangles) == 2


def test_nodes_without_data_are_left_out() -> None:
    heights = np.array(rough(80, 80).heights)
    heights[16:49, 16:49] = np.nan  # 2 x 2 nodes of 4 x 4 tiles, and the borders of others
    mesh = assert_kept(tl.Terrain(tl.Heightmap(heights), tile=4), 1e4)
    top, left, down, across = mesh.patches.areas[mesh.patches.drawn].T
    inside = (top >= 16) & (left >= 16) & (top + down <= 48) & (left + across <= 48)
    assert not inside.any()


def test_a_budget_of_less_than_two_triangles_is_refused() -> None:
    terrain = tl.Terrain(rough(40, 40))
    with pytest.raises(tl.InputError, match="triangles"):
        tl.BudgetLod(0)
    with pytest.raises(tl.InputError, match="a budget of at least 2 triangles") as error:
        terrain.mesh(lod=tl.BudgetLod(1))
    assert "\n" not in str(error.value)
    assert len(terrain.mesh(lod=tl.BudgetLod(2)).triangles) == 2


def test_every_sample_is_a_vertex_of_the_raster_in_full() -> None:
    ground = rough(38, 51)
    for tile in (1, 4, 6, 15):
        mesh = tl.Terrain(ground, tile=tile).mesh()
        assert tl.vertical_error(mesh, ground).maximum == 0
        assert len(np.unique(mesh.vertices[:, :2], axis=0)) >= 38 * 51


def test_formulas_have_as_many_segments_as_a_tile_has_cells() -> None:
    ground, camera = rough(61, 61), tl.Camera((30, -90, 60), (30, -30, 0))
    for tile in (4, 15):
        terrain = tl.Terrain(ground, tile=tile, levels=1)
        own = terrain.mesh(camera, lod=tl.DistanceLod())
        same = terrain.mesh(camera, lod=tl.DistanceLod(maximum=tile))
        np.testing.assert_array_equal(own.vertices, same.vertices)
