"""Solids are volumes by another program's word, whatever holes the ground has."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from support.drawn_meshes import grid_mesh, mesh_of
from terrain_lod.errors import InputError
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.mesh.mesh import Mesh
from terrain_lod.mesh.solid import solid
from terrain_lod.mesh.stretched import stretched
from terrain_lod.terrain.lod_promises import MaxErrorLod
from terrain_lod.terrain.terrain import Terrain


def ground_with_holes(seed: int) -> Heightmap:
    chance = np.random.default_rng(seed)
    row, column = np.mgrid[:41, :53]
    heights = 60 * np.sin(row / 8) * np.cos(column / 6) + chance.normal(0, 1, row.shape)
    mask = chance.random(row.shape) < 0.02 * seed
    return Heightmap(heights, spacing=10.0, origin=(4e5, 5e6), base=900.0, mask=mask)


def two_squares() -> Mesh:
    """Two squares that touch in one corner."""
    corners = [(0, 0, 3), (1, 0, 1), (1, 1, 2), (0, 1, 4), (2, 1, 5), (2, 2, 6), (1, 2, 7)]
    return mesh_of(corners, [(0, 1, 2), (0, 2, 3), (2, 4, 5), (2, 5, 6)])


@pytest.mark.parametrize("seed", range(10))
def test_ten_grounds_are_volumes(tmp_path: Path, seed: int) -> None:
    mesh = Terrain(ground_with_holes(seed)).mesh(lod=MaxErrorLod(3.0))
    made = solid(mesh, base=5.0, size=180.0)
    read = trimesh.load(made.save(tmp_path / "a.stl"))
    assert read.is_volume
    assert read.extents[:2].max() == pytest.approx(180.0)
    assert read.bounds[0] == pytest.approx([0, 0, 0], abs=1e-4)


def test_parts_that_touch_in_a_point_are_parted(tmp_path: Path) -> None:
    read = trimesh.load(solid(two_squares(), base=1.0).save(tmp_path / "a.stl"))
    assert read.is_volume
    assert len(read.split()) == 2


def test_a_solid_in_place_has_the_volume_below_the_surface() -> None:
    ground = Heightmap(np.zeros((4, 5)), spacing=2.0, base=7.0, crs="EPSG:32632")
    made = solid(grid_mesh(ground), base=3.0)
    read = trimesh.Trimesh(made.vertices, made.triangles)
    assert read.volume == pytest.approx(8 * 6 * 3)
    np.testing.assert_array_equal(made.origin, [0, 0, 7])


def test_what_cannot_be_a_solid_is_refused() -> None:
    with pytest.raises(InputError, match="base below the lowest point"):
        solid(two_squares(), base=0.0)
    with pytest.raises(InputError, match="size > 0"):
        solid(two_squares(), base=1.0, size=-1.0)
    with pytest.raises(InputError, match="empty mesh"):
        solid(mesh_of([], []), base=1.0)


def test_stretched_heights_and_normals() -> None:
    slope = Mesh(
        [(0, 0, 0), (1, 0, 1), (0, 1, 0)], [(-(0.5**0.5), 0, 0.5**0.5)] * 3, [(0, 1, 2)],
        origin=np.array([1.0, 2.0, 10.0]),
    )  # fmt: skip
    tall = stretched(slope, 2.0)
    np.testing.assert_array_equal(tall.vertices[:, 2], [0, 2, 0])
    np.testing.assert_array_equal(tall.origin, [1, 2, 20])
    np.testing.assert_allclose(tall.normals[0], np.array([-2, 0, 1]) / 5**0.5, atol=1e-6)
