"""The error ladder: against the triangles that come of it, and kept in a file."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import holed, rough
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


def test_a_saved_ladder_is_the_ladder(tmp_path) -> None:
    ground, lod = holed(60, 47), tl.MaxErrorLod(2.0)
    terrain = tl.Terrain(ground, tile=7)
    expected = terrain.mesh(lod=lod)
    path = terrain.save_ladder(tmp_path / "ground.npz")
    again = tl.Terrain(ground, tile=7)
    again.load_ladder(path)
    found = again.mesh(lod=lod)
    np.testing.assert_array_equal(found.vertices, expected.vertices)
    np.testing.assert_array_equal(found.triangles, expected.triangles)
    # not measured a second time
    assert "ladder" in tl.Terrain(ground, tile=7).mesh(lod=lod).timings
    assert "ladder" not in found.timings
    # and it follows an update as its own would
    for each in (terrain, again):
        each.update(slice(3, 9), slice(5, 8), np.full((6, 3), 50.0))
    np.testing.assert_array_equal(again.mesh(lod=lod).vertices, terrain.mesh(lod=lod).vertices)


def test_a_ladder_of_something_else_is_refused(tmp_path) -> None:
    ground = rough(40, 40)
    path = tl.Terrain(ground).save_ladder(tmp_path / "ground.npz")
    heights = np.array(ground.heights)
    heights[20, 20] += 1e-3
    for other in (
        tl.Terrain(tl.Heightmap(heights, base=ground.base)),
        tl.Terrain(ground, tile=7),
        tl.Terrain(ground, detail=tl.Heightmap(np.eye(4), spacing=0.5 * ground.spacing[0])),
    ):
        with pytest.raises(tl.FileError, match="of this ground and tile size"):
            other.load_ladder(path)
    terrain = tl.Terrain(ground)
    with pytest.raises(tl.FileError, match="No such file"):
        terrain.load_ladder(tmp_path / "none.npz")
    for content in (b"", b"no ladder", path.read_bytes()[:200]):
        (tmp_path / "bad.npz").write_bytes(content)
        with pytest.raises(tl.FileError, match="expected an error ladder"):
            terrain.load_ladder(tmp_path / "bad.npz")
    with pytest.raises(tl.FileError, match="none"):
        terrain.save_ladder(tmp_path / "none" / "ground.npz")
    assert sorted(each.name for each in tmp_path.iterdir()) == ["bad.npz", "ground.npz"]
