"""Heights that float within the error: the promise from outside, and the same bits."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.cameras import cameras_over
from support.grounds import holed, plane, rough
from terrain_lod.terrain.floating import fit_heights
from terrain_lod.tessellation.tessellator import tessellate_device


def hills(samples: int) -> tl.Heightmap:
    """Return smooth ground whose curvature has every sign."""
    row, column = np.mgrid[:samples, :samples] / samples
    waves = np.sin(9 * column + 3 * row) + np.sin(14 * row - 4 * column) * np.cos(6 * column)
    return tl.Heightmap(200 * waves, spacing=30.0)


GROUNDS = {
    "rough": rough(50, 41, spacing=30.0),
    "holed": holed(50, 41, spacing=30.0),
    "hills": hills(97),
    "odd sizes": rough(34, 61, spacing=(30.0, 20.0)),
    "two samples wide": rough(2, 40, spacing=30.0),
    "plane": plane(0.3, 0.1),
}


def fitted(terrain: tl.Terrain, lod: object, camera: tl.Camera | None = None) -> tl.Mesh:
    return terrain.mesh(camera, lod=lod, heights="fitted")


def grounded(terrain: tl.Terrain, lod: object) -> tl.Mesh:
    return terrain.mesh(lod=lod)


def assert_same(one: tl.Mesh, other: tl.Mesh) -> None:
    """Equal to the bit."""
    np.testing.assert_array_equal(one.triangles, other.triangles)
    for first, second in ((one.vertices, other.vertices), (one.normals, other.normals)):
        np.testing.assert_array_equal(first.view(np.uint32), second.view(np.uint32))


def errors_off(mesh: tl.Mesh, ground: tl.Heightmap) -> float:
    """Return the largest height of a vertex above or below the ground."""
    heights = tl.Terrain(ground).height_at(mesh.vertices[:, :2] + mesh.origin[:2])
    return float(np.nanmax(np.abs(mesh.vertices[:, 2] + mesh.origin[2] - heights)))


@pytest.mark.parametrize(
    ("name", "tile"),
    [
        *((name, 4) for name in GROUNDS),
        # kernels of their own
        pytest.param("odd sizes", 1, marks=pytest.mark.slow),
        pytest.param("holed", 7, marks=pytest.mark.slow),
    ],
)
def test_an_error_in_metres_is_kept_from_outside(name: str, tile: int) -> None:
    ground = GROUNDS[name]
    terrain = tl.Terrain(ground, tile=tile)
    low, high = ground.height_range
    for share in (2e-3, 2e-2, 0.15):
        metres = (high - low) * share
        mesh = fitted(terrain, tl.MaxErrorLod(metres))
        assert mesh.achieved.kept
        assert tl.vertical_error(mesh, ground).maximum <= mesh.achieved.metres <= metres
        assert not tl.crack_report(mesh)


def test_fewer_triangles_than_on_the_ground() -> None:
    terrain = tl.Terrain(GROUNDS["hills"], tile=4)
    lod = tl.MaxErrorLod(4.0)
    floating, standing = fitted(terrain, lod), grounded(terrain, lod)
    assert len(floating.triangles) < 0.7 * len(standing.triangles)
    assert errors_off(standing, GROUNDS["hills"]) < 1e-3
    assert 1.0 < errors_off(floating, GROUNDS["hills"]) <= 4.0


def test_what_is_measured_are_the_floating_triangles() -> None:
    mesh = fitted(tl.Terrain(GROUNDS["hills"], tile=4), tl.MaxErrorLod(4.0))
    assert errors_off(mesh, GROUNDS["hills"]) > 1.0
    outside = tl.vertical_error(mesh, GROUNDS["hills"]).maximum
    np.testing.assert_allclose(mesh.achieved.metres, outside, rtol=1e-3)


@pytest.mark.slow
def test_detail_is_kept_as_the_sum_is() -> None:
    detail = tl.Heightmap(np.random.default_rng(1).normal(size=(9, 11)), spacing=10.0)
    ground = rough(40, 33, spacing=30.0)
    mesh = fitted(tl.Terrain(ground, detail=detail, tile=4), tl.MaxErrorLod(20))
    assert mesh.achieved.kept
    assert tl.vertical_error(mesh, ground.with_detail(detail)).maximum <= 20
    assert not tl.crack_report(mesh)


@pytest.mark.parametrize("name", ["holed", "hills"])
def test_an_error_in_pixels_is_kept_from_outside(name: str) -> None:
    ground = GROUNDS[name]
    terrain = tl.Terrain(ground, tile=4)
    for index, camera in enumerate(cameras_over(ground, 6)):
        pixels = (0.5, 2.0, 8.0)[index % 3]
        mesh = fitted(terrain, tl.ScreenErrorLod(pixels), camera)
        if len(mesh.triangles):
            found = tl.screen_error(mesh, ground, camera)
            assert not found.samples or found.maximum <= mesh.achieved.pixels <= pixels
            assert not tl.crack_report(mesh)


def test_weights_are_kept() -> None:
    ground = GROUNDS["hills"]
    terrain, camera = tl.Terrain(ground, tile=4), tl.default_camera(ground)
    lod = tl.ScreenErrorLod(2.0)
    plain, weighted = (fitted(terrain, each, camera) for each in (lod, tl.Weighted(lod, horizon=8)))
    assert len(weighted.triangles) > len(plain.triangles)
    assert tl.screen_error(weighted, ground, camera).maximum <= 2.0


@pytest.mark.slow
def test_a_budget_has_less_error_than_on_the_ground() -> None:
    ground = GROUNDS["hills"]
    terrain = tl.Terrain(ground, tile=4)
    floating, standing = fitted(terrain, tl.BudgetLod(800)), grounded(terrain, tl.BudgetLod(800))
    assert len(floating.triangles) <= 800
    assert floating.achieved.metres < 0.75 * standing.achieved.metres
    assert tl.vertical_error(floating, ground).maximum <= floating.achieved.metres


def test_every_run_gives_the_same_bits() -> None:
    def meshes() -> list[tl.Mesh]:
        terrain = tl.Terrain(GROUNDS["hills"], tile=4)
        return [fitted(terrain, tl.MaxErrorLod(metres)) for metres in (8.0, 3.0, 8.0)]

    first, second = meshes(), meshes()
    assert_same(first[0], first[2])
    for one, other in zip(first, second, strict=True):
        assert_same(one, other)


def test_every_order_of_work_gives_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    tiles = tl.Terrain(GROUNDS["rough"], tile=4)._tiles
    device, count = tiles.device, tiles.grid.count
    factors = (device.array(np.full((count, width), 2.0, np.float32)) for width in (4, 2))
    pattern = tessellate_device("quad", *factors, "integer", clockwise=False)
    allowed = device.array(np.linspace(0.5, 4.0, count, dtype=np.float32))

    def lifts() -> np.ndarray:
        _, patches = fit_heights(tiles.patch_set, pattern, allowed)
        return patches.arguments["lifts"].host().view(np.uint32)

    alone = lifts()
    assert len(np.unique(alone)) > 100
    # many share a patch, as on a GPU
    monkeypatch.setattr(tl.Device, "is_gpu", property(lambda _: True))
    np.testing.assert_array_equal(alone, lifts())


def test_updated_ground_is_meshed_as_if_made_anew() -> None:
    terrain = tl.Terrain(GROUNDS["holed"], tile=4)
    fitted(terrain, tl.MaxErrorLod(30))
    heights = np.random.default_rng(2).normal(scale=200, size=(6, 17))
    terrain.update(slice(3, 9), slice(24, 41), heights)
    one, other = (
        fitted(each, tl.MaxErrorLod(30)) for each in (terrain, tl.Terrain(terrain.ground, tile=4))
    )
    assert_same(one, other)


@pytest.mark.slow
def test_large_patches_are_fitted() -> None:
    row, column = np.mgrid[:300, :300] / 300
    waves = 400 * np.sin(4 * column + row) + 5 * np.sin(90 * row * column)
    ground = tl.Heightmap(waves, spacing=9.0)
    terrain = tl.Terrain(ground, tile=4)
    for metres in (12.0, 30.0):
        mesh, standing = (make(terrain, tl.MaxErrorLod(metres)) for make in (fitted, grounded))
        assert mesh.patches.areas[:, 2:].max() >= 64
        assert len(mesh.triangles) < 0.9 * len(standing.triangles)
        assert tl.vertical_error(mesh, ground).maximum <= mesh.achieved.metres <= metres
        assert not tl.crack_report(mesh)


@pytest.mark.parametrize("share", [1e-6, 0.4, 2.0])
def test_there_are_never_more_triangles_than_on_the_ground(share: float) -> None:
    for name in ("rough", "hills", "plane"):
        low, high = GROUNDS[name].height_range
        terrain, lod = tl.Terrain(GROUNDS[name], tile=4), tl.MaxErrorLod((high - low) * share)
        assert len(fitted(terrain, lod).triangles) <= len(grounded(terrain, lod).triangles)


def test_what_is_out_of_view_is_nothing() -> None:
    terrain = tl.Terrain(GROUNDS["rough"], tile=4)
    away = tl.Camera((0.0, 0.0, 9e3), (0.0, 0.0, 2e4), up=(0, 1, 0))
    assert len(fitted(terrain, tl.ScreenErrorLod(1.0), away).triangles) == 0


def test_normals_are_the_grounds() -> None:
    ground = GROUNDS["hills"]
    mesh = fitted(tl.Terrain(ground, tile=4), tl.MaxErrorLod(4.0))
    standing = grounded(tl.Terrain(ground, tile=4), tl.MaxErrorLod(1.0))
    normals = {
        tuple(at): normal
        for at, normal in zip(standing.vertices[:, :2], standing.normals, strict=True)
    }
    shared = [index for index, at in enumerate(mesh.vertices[:, :2]) if tuple(at) in normals]
    assert len(shared) > 50
    for index in shared:
        np.testing.assert_array_equal(mesh.normals[index], normals[tuple(mesh.vertices[index, :2])])


def test_level_ground_is_two_triangles() -> None:
    mesh = fitted(tl.Terrain(GROUNDS["plane"], tile=4), tl.MaxErrorLod(0.5))
    assert len(mesh.triangles) == 2


def test_what_rounds_do_not_settle_stands_on_the_ground(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("terrain_lod.terrain.fitted._MOST_ROUNDS", 1)
    terrain, lod = tl.Terrain(GROUNDS["hills"], tile=4), tl.MaxErrorLod(4.0)
    mesh = fitted(terrain, lod)
    assert mesh.achieved.kept
    assert_same(mesh, grounded(terrain, lod))


@pytest.mark.parametrize(
    ("wanted", "message"),
    [
        ({"lod": tl.UniformLod(3), "partitioning": "integer"}, "expected a promise .*UniformLod"),
        ({"lod": tl.Weighted(tl.UniformLod(3)), "partitioning": "integer"}, "got UniformLod"),
        ({"lod": tl.MaxErrorLod(3), "partitioning": "pow2"}, "'integer' .*'pow2'"),
        ({"lod": tl.MaxErrorLod(3), "steady": tl.Steady()}, "expected heights='ground' .*Steady"),
    ],
)
def test_what_cannot_be_fitted(wanted: dict[str, object], message: str) -> None:
    with pytest.raises(tl.InputError, match=message) as error:
        tl.Terrain(GROUNDS["rough"]).mesh(heights="fitted", **wanted)
    assert "\n" not in str(error.value)


def test_unknown_heights() -> None:
    with pytest.raises(tl.InputError, match="heights"):
        tl.Terrain(GROUNDS["rough"]).mesh(heights="floating")
