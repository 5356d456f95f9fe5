"""Errors patch by patch: against windows of the field, with detail, of the right ground only."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import holed, rough


def by_windows(mesh: tl.Mesh, ground: tl.Heightmap) -> np.ndarray:
    """Look at the samples of one tile after the other."""
    errors = np.abs(tl.vertical_error(mesh, ground, field=True).field)
    grid, found = mesh.patches.grid, []
    for row, column in np.ndindex(grid.shape):
        top, bottom = grid.corner_rows[row : row + 2]
        left, right = grid.corner_columns[column : column + 2]
        within = errors[top : bottom + 1, left : right + 1]
        found.append(np.nan if np.isnan(within).all() else np.nanmax(within))
    return np.float32(found)


@pytest.mark.parametrize("tile", [7, 15])
@pytest.mark.parametrize("make", [rough, holed])
def test_each_patch_has_the_largest_of_its_own_samples(make, tile: int) -> None:
    ground = make(100, 77, spacing=(30.0, 20.0), origin=(500_000.0, 4_000_000.0), crs="EPSG:32610")
    mesh = tl.Terrain(ground, tile=tile).mesh(lod=tl.UniformLod(3.0))
    found = tl.patch_errors(mesh, ground)
    np.testing.assert_array_equal(found, by_windows(mesh, ground))
    assert len(found) == mesh.patches.count
    surface = mesh.to_pyvista()
    surface["error"] = found[surface["patch"]]
    assert np.nanmax(surface["error"]) == tl.vertical_error(mesh, ground).maximum


def test_what_is_culled_has_no_error() -> None:
    ground = rough(100, 77, spacing=30.0)
    x, y, z = ground.centre
    camera = tl.Camera((x, y, z + 90), (x + 100, y, z))
    mesh = tl.Terrain(ground, levels=1).mesh(camera, partitioning="fractional_odd")
    found = tl.patch_errors(mesh, ground)
    away = ~mesh.patches.drawn
    assert away.any()
    # of a culled patch only the border to a drawn one is measured
    np.testing.assert_array_equal(found, by_windows(mesh, ground))
    assert np.isnan(found[away]).any()


def test_ground_with_detail_is_measured_as_the_sum() -> None:
    ground = rough(45, 38, spacing=(30.0, 20.0))
    detail = tl.Heightmap(np.random.default_rng(1).normal(size=(13, 17)), spacing=(10.0, 10.0))
    mesh = tl.Terrain(ground, detail=detail, levels=1).mesh(lod=tl.MaxErrorLod(1.0))
    stored = ground.with_detail(detail)
    found = tl.patch_errors(mesh, stored)
    np.testing.assert_array_equal(found, by_windows(mesh, stored))
    assert found.max() <= 1.0
    with pytest.raises(tl.InputError, match=r"89 x 112 .*, got 45 x 38 .*with_detail\(detail\)$"):
        tl.patch_errors(mesh, ground)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (rough(61, 61, spacing=30.0), "61 x 46 samples .*, got 61 x 61"),
        (rough(60, 46, spacing=30.0), "61 x 46 samples .*, got 60 x 46"),  # in as many tiles
        (rough(61, 46, spacing=10.0), "30 x 30 apart .*, got .* 10 x 10 apart"),
        (rough(61, 46, spacing=30.0, origin=(0.5, 0)), r"from \(0, 0\), got .* from \(0.5, 0\)"),
    ],
)
def test_another_ground_is_refused_in_one_line(other: tl.Heightmap, message: str) -> None:
    mesh = tl.Terrain(rough(61, 46, spacing=30.0)).mesh(lod=tl.UniformLod(3.0))
    with pytest.raises(tl.InputError, match=message) as error:
        tl.patch_errors(mesh, other)
    assert "\n" not in str(error.value)


def test_a_mesh_of_no_terrain_has_no_patches() -> None:
    corners = np.zeros((3, 3), np.float32)
    with pytest.raises(tl.InputError, match="without patches"):
        tl.patch_errors(tl.Mesh(corners, corners, np.int32([[0, 1, 2]])), rough())
