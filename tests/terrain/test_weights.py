"""Weights on levels of detail: on both sides, kept promises, skylines."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.cameras import cameras_over
from support.grounds import rough
from terrain_lod.terrain.weights import weights_on_device

ORIGIN = (500_000.0, 4_000_000.0)


def ridges() -> tl.Heightmap:
    """Return three ridges across the way, the middle one the highest, the last one hidden."""
    row = np.mgrid[:301, :301][0]
    heights = sum(
        top * np.exp(-(((row - at) / 12.0) ** 2)) for at, top in ((230, 100), (120, 600), (60, 200))
    )
    return tl.Heightmap(heights + rough(301, 301).heights * 0.02, spacing=30.0)


def test_the_ridge_against_the_sky_weighs_most() -> None:
    # from the south, looking north: nothing but the middle ridge is the horizon
    ground = ridges()
    terrain = tl.Terrain(ground, tile=15)
    x = ground.centre[0]
    camera = tl.Camera((x, -10_500.0, 300.0), (x, 0.0, 250.0))
    weights = weights_on_device(terrain._tiles, camera, horizon=4.0, silhouette=1.0)
    found = weights.host().reshape(terrain.grid.shape)
    middle = found[:, 8:12].max(axis=1)
    crest = 120 // 15
    assert middle[crest - 1 : crest + 1].max() > 3.9
    hidden, near = 60 // 15, 230 // 15
    assert (middle[hidden - 2 : hidden + 2] == 1).all()
    assert (middle[near - 1 : near + 2] == 1).all()


@pytest.mark.parametrize("edges", ["min", "max"])
def test_both_sides_of_an_edge_find_the_same_bits(edges: str) -> None:
    ground = rough(200, 170, spacing=30.0, origin=ORIGIN)
    terrain = tl.Terrain(ground)
    lod = tl.Weighted(tl.DistanceLod(), horizon=3.0, silhouette=2.0)
    for camera in cameras_over(ground, 5):
        mesh = terrain.mesh(camera, lod=lod, edge_rule=edges, cull=False)
        edge = mesh.patches.edge_factors.reshape(*terrain.grid.shape, 4)
        west, north, east, south = np.moveaxis(edge, -1, 0)
        np.testing.assert_array_equal(east[:, :-1], west[:, 1:])
        np.testing.assert_array_equal(south[:-1], north[1:])
        assert not tl.crack_report(mesh)


@pytest.mark.parametrize("name", ["ridge", "islands"])
def test_a_better_skyline_for_as_many_triangles(name: str) -> None:
    ground = tl.sample(name)
    terrain, camera = tl.Terrain(ground, levels=1), tl.default_camera(ground)
    plain = terrain.mesh(camera, lod=tl.DistanceLod(maximum=10))
    low, high = 1.0, 20.0
    for _ in range(8):
        middle = (low * high) ** 0.5
        mesh = terrain.mesh(camera, lod=tl.Weighted(tl.DistanceLod(maximum=middle), horizon=4.0))
        if len(mesh.triangles) > len(plain.triangles):
            high = middle
        else:
            low, weighted = middle, mesh
    assert 0.9 * len(plain.triangles) < len(weighted.triangles) <= len(plain.triangles)
    _, before = tl.silhouette_error(plain, ground, camera)
    _, after = tl.silhouette_error(weighted, ground, camera)
    assert after < before / 2


def test_promises_are_kept_under_weights() -> None:
    ground = rough(130, 110, spacing=30.0, origin=ORIGIN)
    terrain = tl.Terrain(ground)
    for camera in cameras_over(ground, 6):
        plain = terrain.mesh(camera, lod=tl.ScreenErrorLod(2.0))
        mesh = terrain.mesh(camera, lod=tl.Weighted(tl.ScreenErrorLod(2.0), silhouette=2.0))
        assert len(mesh.triangles) >= len(plain.triangles)
        found = tl.screen_error(mesh, ground, camera)
        assert mesh.achieved.kept
        assert not found.maximum > mesh.achieved.pixels + 1e-4
        assert mesh.achieved.pixels <= 2.0
    budget = terrain.mesh(camera, lod=tl.Weighted(tl.BudgetLod(5000)))
    assert len(budget.triangles) <= 5000
    assert not tl.screen_error(budget, ground, camera).maximum > budget.achieved.pixels + 1e-4
    metres = terrain.mesh(camera, lod=tl.Weighted(tl.MaxErrorLod(3.0)))
    assert tl.vertical_error(metres, ground).maximum <= metres.achieved.metres <= 3.0


def test_weights_of_one_change_nothing() -> None:
    ground = rough(130, 110, spacing=30.0)
    terrain, camera = tl.Terrain(ground), cameras_over(ground, 1)[0]
    for lod in (tl.DistanceLod(), tl.ScreenErrorLod(2.0)):
        plain = terrain.mesh(camera, lod=lod)
        same = terrain.mesh(camera, lod=tl.Weighted(lod, horizon=1.0))
        np.testing.assert_array_equal(plain.triangles, same.triangles)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: tl.Weighted(tl.DistanceLod(), horizon=0.5), "horizon >= 1, got 0.5"),
        (lambda: tl.Weighted(tl.DistanceLod(), silhouette=float("nan")), "finite silhouette"),
        (lambda: tl.Weighted("distance"), "expected a level of detail, such as .*, got 'distance'"),
        (lambda: tl.Terrain(rough()).mesh(lod=tl.Weighted(tl.UniformLod(3))), "needs a camera"),
    ],
)
def test_wrong_weights(make, message: str) -> None:
    with pytest.raises(tl.InputError, match=message):
        make()
