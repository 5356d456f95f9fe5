"""Promises kept by patches of every size: errors, joints, budgets, updates."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.anew import everything
from support.cameras import cameras_over
from support.grounds import holed, plane, rough


def fractal(samples: int, roughness: float = 0.9) -> tl.Heightmap:
    """Return rugged ground whose spectrum falls with a power of the frequency."""
    frequency = np.hypot(*np.meshgrid(np.fft.rfftfreq(samples), np.fft.fftfreq(samples)))
    frequency[0, 0] = 1.0
    noise = np.fft.rfft2(np.random.default_rng(0).normal(size=(samples, samples)))
    heights = np.fft.irfft2(noise * frequency ** -(1 + roughness), s=(samples, samples))
    return tl.Heightmap(heights * (800 / np.ptp(heights)), spacing=30.0)


GROUNDS = {
    "rough": rough(90, 77, spacing=30.0),
    "holed": holed(90, 77, spacing=30.0),
    "fractal": fractal(130),
    "plane": plane(90, 77, spacing=30.0),
}


def whole(terrain: tl.Terrain, lod: object, camera: tl.Camera | None = None) -> tl.Mesh:
    return terrain.mesh(camera, lod=lod)


def sizes_of(mesh: tl.Mesh) -> set[int]:
    """Return how many cells of the raster patches have along their longer side."""
    return set(mesh.patches.areas[:, 2:].max(axis=1).tolist())


def assert_sound(mesh: tl.Mesh, ground: tl.Heightmap, *, all_of_it: bool = True) -> None:
    """No crack, no triangle without an area, no patch over another."""
    assert not tl.crack_report(mesh)
    a, b, c = (mesh.vertices[mesh.triangles[:, corner], :2].astype(float) for corner in range(3))
    (x1, y1), (x2, y2) = (b - a).T, (c - a).T
    areas = x1 * y2 - x2 * y1
    assert (areas > 0).all()
    assert mesh.patches.areas[:, 2:].prod(axis=1).sum() <= np.prod(np.subtract(ground.shape, 1))
    if all_of_it and ground.mask is None:
        assert areas.sum() / 2 == pytest.approx(np.prod(ground.extent), rel=1e-6)


@pytest.mark.parametrize("tile", [1, 4, 6, 8, 15])
@pytest.mark.parametrize("name", GROUNDS)
def test_an_error_in_metres_is_kept(name: str, tile: int) -> None:
    ground = GROUNDS[name]
    terrain = tl.Terrain(ground, tile=tile)
    low, high = ground.height_range
    for share in (1e-3, 1e-2, 0.1, 0.6):
        metres = max((high - low) * share, 1e-3)
        mesh = whole(terrain, tl.MaxErrorLod(metres))
        assert mesh.achieved.kept
        measured = tl.vertical_error(mesh, ground).maximum
        assert measured <= mesh.achieved.metres <= metres
        assert_sound(mesh, ground)


@pytest.mark.parametrize("tile", [4, 8])
@pytest.mark.parametrize("name", ["holed", "fractal"])
def test_an_error_in_pixels_is_kept(name: str, tile: int) -> None:
    ground = GROUNDS[name]
    terrain = tl.Terrain(ground, tile=tile)
    for index, camera in enumerate(cameras_over(ground, 12)):
        pixels = (0.5, 2.0, 8.0)[index % 3]
        mesh = whole(terrain, tl.ScreenErrorLod(pixels), camera)
        if len(mesh.triangles):
            found = tl.screen_error(mesh, ground, camera)
            assert not found.samples or found.maximum <= pixels
            assert_sound(mesh, ground, all_of_it=False)


def test_coarse_patches_are_bounded_by_all_their_samples() -> None:
    # so large a tolerance that patches are looked at on lattices of every eighth sample
    ground = fractal(520, roughness=1.5)
    terrain = tl.Terrain(ground, tile=4)
    for metres in (5.0, 20.0, 60.0):
        mesh = whole(terrain, tl.MaxErrorLod(metres))
        assert max(sizes_of(mesh)) >= 32
        measured = tl.vertical_error(mesh, ground).maximum
        assert 0.5 * metres < measured <= mesh.achieved.metres <= metres
        assert_sound(mesh, ground)


def test_level_ground_is_two_triangles() -> None:
    mesh = whole(tl.Terrain(GROUNDS["plane"], tile=8), tl.MaxErrorLod(0.5))
    assert len(mesh.triangles) == 2
    assert mesh.patches.count == 1


def test_one_level_is_the_flat_grid() -> None:
    ground = GROUNDS["fractal"]
    flat = whole(tl.Terrain(ground, tile=8, levels=1), tl.MaxErrorLod(80))
    tree = whole(tl.Terrain(ground, tile=8), tl.MaxErrorLod(80))
    assert max(sizes_of(flat)) <= 8 < max(sizes_of(tree))
    assert flat.patches.count == flat.patches.grid.count
    assert len(tree.triangles) < 0.9 * len(flat.triangles)


def test_whole_factors_have_fewer_triangles_than_odd_ones() -> None:
    terrain = tl.Terrain(GROUNDS["fractal"], tile=7, levels=1)
    odd = terrain.mesh(lod=tl.MaxErrorLod(10), partitioning="fractional_odd")
    assert len(whole(terrain, tl.MaxErrorLod(10)).triangles) < 0.9 * len(odd.triangles)


@pytest.mark.parametrize("triangles", [2, 3, 50, 777])
def test_any_budget_from_two_triangles_up(triangles: int) -> None:
    ground = GROUNDS["fractal"]
    mesh = whole(tl.Terrain(ground, tile=4), tl.BudgetLod(triangles))
    assert 2 <= len(mesh.triangles) <= triangles
    assert tl.vertical_error(mesh, ground).maximum <= mesh.achieved.metres


def test_detail_is_kept_as_the_sum_is() -> None:
    detail = tl.Heightmap(np.random.default_rng(1).normal(size=(9, 11)), spacing=10.0)
    ground = rough(40, 33, spacing=30.0)
    mesh = whole(tl.Terrain(ground, detail=detail, tile=6), tl.MaxErrorLod(20))
    same = whole(tl.Terrain(ground.with_detail(detail), tile=6), tl.MaxErrorLod(20))
    np.testing.assert_array_equal(mesh.vertices, same.vertices)
    np.testing.assert_array_equal(mesh.triangles, same.triangles)


def test_weights_make_more_of_the_horizon_and_keep_the_promise() -> None:
    ground = GROUNDS["fractal"]
    terrain, camera = tl.Terrain(ground, tile=4), tl.default_camera(ground)
    lod = tl.ScreenErrorLod(2.0)
    plain, weighted = (whole(terrain, each, camera) for each in (lod, tl.Weighted(lod, horizon=8)))
    assert len(weighted.triangles) > len(plain.triangles)
    assert tl.screen_error(weighted, ground, camera).maximum <= 2.0


@pytest.mark.parametrize("make", [rough, holed])
def test_updated_ground_is_meshed_as_if_made_anew(make) -> None:
    terrain = tl.Terrain(make(90, 77, spacing=30.0), tile=4)
    whole(terrain, tl.MaxErrorLod(30))
    random = np.random.default_rng(2)
    for rows, columns in (((3, 9), (60, 77)), ((40, 41), (32, 33)), ((0, 90), (16, 20))):
        heights = random.normal(scale=200, size=(np.ptp(rows), np.ptp(columns)))
        terrain.update(slice(*rows), slice(*columns), heights)
        anew = tl.Terrain(terrain.ground, tile=4)
        for metres in (5, 30, 300):
            one, other = (whole(each, tl.MaxErrorLod(metres)) for each in (terrain, anew))
            np.testing.assert_array_equal(one.vertices, other.vertices)
            np.testing.assert_array_equal(one.triangles, other.triangles)
        everything(terrain)


def test_what_is_remembered_changes_nothing() -> None:
    ground = GROUNDS["fractal"]
    terrain = tl.Terrain(ground, tile=6)
    for metres in (50, 5, 20, 50, 1, 20):
        again, first = (
            whole(each, tl.MaxErrorLod(metres)) for each in (terrain, tl.Terrain(ground, tile=6))
        )
        np.testing.assert_array_equal(again.vertices, first.vertices)
        np.testing.assert_array_equal(again.triangles, first.triangles)


def test_errors_of_patches_of_every_size() -> None:
    ground = GROUNDS["holed"]
    mesh = whole(tl.Terrain(ground, tile=4), tl.MaxErrorLod(40))
    assert len(sizes_of(mesh)) > 1
    errors = tl.patch_errors(mesh, ground)
    assert errors.shape == (mesh.patches.count,)
    assert np.nanmax(errors) == pytest.approx(tl.vertical_error(mesh, ground).maximum)


@pytest.mark.parametrize("levels", [0, 17, 1.5, "two"])
def test_levels_that_there_cannot_be(levels: object) -> None:
    with pytest.raises(tl.InputError, match="levels"):
        tl.Terrain(GROUNDS["rough"], levels=levels)


def test_a_mesh_out_of_rounds_is_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    # the first leaf that exceeds is split, and nothing is left to mesh its children
    monkeypatch.setattr("terrain_lod.terrain.promise._MOST_ROUNDS", 1)
    monkeypatch.setattr("terrain_lod.terrain.leaves._LEAST_SHARE", 1.0)
    ground = GROUNDS["fractal"]
    low, high = ground.height_range
    mesh = whole(tl.Terrain(ground, tile=4), tl.MaxErrorLod((high - low) * 0.3))
    assert not mesh.achieved.kept
    assert_sound(mesh, ground)
