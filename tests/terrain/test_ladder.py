"""The error ladder: against the triangles that come of it, and kept in a file."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import rough
from terrain_lod.reference.terrain import domain
from terrain_lod.terrain.ladder import cheapest_first, tile_groups
from terrain_lod.tessellation.tessellator import tessellate


def measured(ground: tl.Heightmap, tile: int):
    terrain = tl.Terrain(ground, tile=tile)
    return terrain.grid, terrain._with_ladder().ladder


@pytest.mark.parametrize("tile", [7, 15])
def test_is_the_error_of_the_triangles_that_come_of_it(tile: int) -> None:
    # one tile, so that edges match: the mesh is the lattice, diagonals included
    ground = rough(tile + 1, tile + 1)
    grid, found = measured(ground, tile)
    errors = found.tiles.host()[0]
    for v, u in np.ndindex(errors.shape):
        fu, fv = 2 * u + 1, 2 * v + 1
        pattern = tessellate("quad", [[fv, fu, fv, fu]], [[fu, fv]])
        patch = np.zeros(len(pattern.points), int)
        positions, normals = domain.displace(ground, grid, pattern.points, patch)
        origin = np.array([0.0, 0.0, ground.base])
        mesh = tl.Mesh(positions.astype("f4"), normals.astype("f4"), pattern.triangles, origin)
        # points are rounded to 1/65536 of the tile, which a steep slope shows
        assert tl.vertical_error(mesh, ground).maximum == pytest.approx(errors[v, u], abs=0.02)


def test_full_resolution_has_no_error_but_rounding() -> None:
    ground = rough()
    rounding = np.spacing(np.float32(np.abs(ground.heights).max()))
    for tile in (7, 15, 31):
        _, found = measured(ground, tile)
        assert found.tiles.host()[:, -1, -1].max() <= rounding
        assert found.across.host()[:, -1].max() <= rounding
        assert found.down.host()[:, -1].max() <= rounding


def test_insides_are_tried_in_the_order_of_their_triangles() -> None:
    order = cheapest_first(8)
    assert sorted(order) == list(range(64))
    pairs = [(2 * (pair % 8) + 1, 2 * (pair // 8) + 1) for pair in order]
    # edges are the same for all
    patterns = (tessellate("quad", [[9, 3, 5, 7]], [pair]) for pair in pairs)
    counts = [len(pattern.triangles) for pattern in patterns]
    assert counts == sorted(counts)


def test_groups_hold_every_tile_and_only_tiles_of_one_size() -> None:
    grid = tl.Terrain(rough(100, 77), tile=7).grid
    groups = tile_groups(grid, np.arange(grid.count, dtype=np.int32), 8)
    assert set(groups.ravel()) == set(range(grid.count))
    down, across = np.diff(grid.corner_rows), np.diff(grid.corner_columns)
    for group in groups:
        row, column = np.divmod(group, grid.shape[1])
        assert len(set(zip(down[row], across[column], strict=True))) == 1
