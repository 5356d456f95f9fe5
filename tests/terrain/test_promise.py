"""What is promised is what is measured, by code that shares nothing with the ladder."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.cameras import cameras_over
from support.grounds import holed, plane, rough

# tiles alone, at odd factors; tests of patches of every size stand in test_quadtree.py
ODD = {"partitioning": "fractional_odd"}
GROUNDS = {
    "rough": rough(130, 110, spacing=30.0, origin=(500_000, 4_000_000)),
    "holed": holed(130, 110, spacing=(30.0, 20.0)),
    "jacksboro": tl.sample("jacksboro"),
}


@pytest.mark.parametrize("name", GROUNDS)
@pytest.mark.parametrize("tile", [7, 15, 31, 63])
def test_metres(name: str, tile: int) -> None:
    ground = GROUNDS[name]
    terrain = tl.Terrain(ground, tile=tile)
    counts = []
    for metres in (0.01, 0.5, 3.0, 20.0, 1000.0):
        mesh = terrain.mesh(**ODD, lod=tl.MaxErrorLod(metres))
        found = tl.vertical_error(mesh, ground)
        assert found.maximum <= metres
        assert mesh.achieved.kept
        # what the mesh states is a bound, a little above what is there
        assert found.maximum <= mesh.achieved.metres <= metres
        assert not tl.crack_report(mesh)
        counts.append(len(mesh.triangles))
    assert counts == sorted(counts, reverse=True)
    # tiles with holes are meshed in full whatever is promised
    assert counts[-1] < counts[0] / 4 or name == "holed"


@pytest.mark.parametrize("name", GROUNDS)
@pytest.mark.parametrize("tile", [7, 15, 31])
def test_pixels(name: str, tile: int) -> None:
    ground = GROUNDS[name]
    terrain = tl.Terrain(ground, tile=tile)
    for index, camera in enumerate(cameras_over(ground, 10, seed=tile)):
        pixels = (0.3, 1.0, 4.0)[index % 3]
        mesh = terrain.mesh(camera, **ODD, lod=tl.ScreenErrorLod(pixels))
        found = tl.screen_error(mesh, ground, camera)
        assert not found.maximum > pixels
        assert mesh.achieved.kept
        # the bound that the mesh states holds
        assert not found.maximum > mesh.achieved.pixels + 1e-4


@pytest.mark.slow
def test_what_is_chosen_holds_when_it_is_measured() -> None:
    rounds = [
        tl.Terrain(ground, tile=tile).mesh(**ODD, lod=tl.MaxErrorLod(metres)).achieved.rounds
        for ground in GROUNDS.values()
        for tile in (7, 15, 31)
        for metres in (0.5, 3.0, 20.0)
    ]
    # but for roundings
    assert rounds.count(1) >= 0.8 * len(rounds)


def test_promises_have_no_edge_rule() -> None:
    with pytest.raises(tl.InputError, match=r"formula with edge_rule=, got MaxErrorLod"):
        tl.Terrain(GROUNDS["rough"]).mesh(lod=tl.MaxErrorLod(2.0), edge_rule="max")


def test_every_partitioning_keeps_the_promise() -> None:
    ground = GROUNDS["rough"]
    for partitioning in ("fractional_odd", "integer", "fractional_even", "pow2"):
        mesh = tl.Terrain(ground, levels=1).mesh(lod=tl.MaxErrorLod(5.0), partitioning=partitioning)
        found = tl.vertical_error(mesh, ground).maximum
        # where full resolution is out of reach, the mesh says what it came to
        assert found <= 5.0 or not mesh.achieved.kept
        assert found <= mesh.achieved.metres <= 1.01 * found + 0.01


def test_inside_factors_differ_where_the_ground_does() -> None:
    # ridges that run along one axis need segments across them alone
    row, column = np.mgrid[:121, :121]
    heights = 20 * np.sin(column / 4.0) + 0.05 * np.random.default_rng(0).normal(size=row.shape)
    mesh = tl.Terrain(tl.Heightmap(heights), levels=1).mesh(**ODD, lod=tl.MaxErrorLod(2.0))
    factors = mesh.patches.inside_factors
    assert (factors[:, 0] > factors[:, 1]).mean() > 0.9


def test_a_plane_needs_two_triangles_a_patch() -> None:
    ground = plane(0.5, 0.25, size=61)
    mesh = tl.Terrain(ground, levels=1).mesh(**ODD, lod=tl.MaxErrorLod(0.001))
    assert len(mesh.triangles) == 2 * mesh.patches.count


def test_a_budget_is_met_and_nearly_used() -> None:
    ground = GROUNDS["rough"]
    terrain, camera = tl.Terrain(ground, levels=1), cameras_over(ground, 1)[0]
    for triangles in (2000, 8000):
        mesh = terrain.mesh(**ODD, lod=tl.BudgetLod(triangles))
        assert 0.9 * triangles <= len(mesh.triangles) <= triangles
        assert mesh.achieved.metres == pytest.approx(
            tl.vertical_error(mesh, ground).maximum, rel=1e-3
        )
        seen = terrain.mesh(camera, **ODD, lod=tl.BudgetLod(triangles))
        assert len(seen.triangles) <= triangles
        assert not tl.screen_error(seen, ground, camera).maximum > seen.achieved.pixels + 1e-4


def test_both_caps_together() -> None:
    terrain = tl.Terrain(GROUNDS["rough"], levels=1)
    plenty = terrain.mesh(**ODD, lod=tl.BudgetLod(10**6, metres=5.0))
    assert len(plenty.triangles) == len(terrain.mesh(**ODD, lod=tl.MaxErrorLod(5.0)).triangles)
    short = terrain.mesh(**ODD, lod=tl.BudgetLod(2000, metres=0.1))
    assert len(short.triangles) <= 2000
    assert short.achieved.metres > 0.1


def test_a_budget_in_metres_is_one_at_a_camera_too() -> None:
    terrain, camera = tl.Terrain(GROUNDS["rough"], levels=1), cameras_over(GROUNDS["rough"], 1)[0]
    lod = tl.BudgetLod(10**6, metres=5.0)
    culled, whole = (
        terrain.mesh(camera, **ODD, lod=lod),
        terrain.mesh(camera, **ODD, lod=lod, cull=False),
    )
    assert len(culled.triangles) < len(whole.triangles)
    assert len(whole.triangles) == len(terrain.mesh(**ODD, lod=lod).triangles)
    assert tl.vertical_error(whole, GROUNDS["rough"]).maximum <= 5.0
    with pytest.raises(tl.InputError, match="needs a camera"):
        terrain.mesh(**ODD, lod=tl.BudgetLod(2000, pixels=1.0))


def test_the_smallest_budget_is_two_triangles_a_patch() -> None:
    ground = GROUNDS["rough"]
    # from among the ground, where no vertical error is within any number of pixels
    x, y, z = ground.centre
    ahead, down = (tl.Camera((x, y, z), (x + 500, y, z - fall)) for fall in (0, 2000))
    for seen in (None, ahead, down):
        terrain = tl.Terrain(ground, levels=1)
        patches = terrain.mesh(seen, lod=tl.UniformLod(1), cull=False).patches.count
        with pytest.raises(tl.InputError, match=f"at least {2 * patches} triangles"):
            terrain.mesh(seen, **ODD, lod=tl.BudgetLod(2 * patches - 1), cull=False)
        mesh = terrain.mesh(seen, **ODD, lod=tl.BudgetLod(2 * patches), cull=False)
        assert len(mesh.triangles) == 2 * patches
        assert seen is not down or mesh.achieved.pixels == np.inf


def test_more_budget_means_less_error() -> None:
    terrain = tl.Terrain(GROUNDS["rough"], levels=1)
    errors = [terrain.mesh(**ODD, lod=tl.BudgetLod(n)).achieved.metres for n in (1000, 3000, 9000)]
    assert errors == sorted(errors, reverse=True)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: tl.MaxErrorLod(0), "metres > 0"),
        (lambda: tl.MaxErrorLod(float("nan")), "finite metres"),
        (lambda: tl.ScreenErrorLod(-1), "pixels > 0"),
        (lambda: tl.BudgetLod(0), "triangles"),
        (lambda: tl.BudgetLod(100, pixels=-1), "pixels >= 0"),
        (lambda: tl.BudgetLod(100, pixels=1, metres=1), "got both"),
    ],
)
def test_wrong_parameters(make, message: str) -> None:
    with pytest.raises(tl.InputError, match=message):
        make()


def test_a_budget_that_no_mesh_fits_names_the_least() -> None:
    terrain = tl.Terrain(GROUNDS["rough"], levels=1)
    least = len(terrain.mesh(**ODD, lod=tl.MaxErrorLod(1e6)).triangles)
    with pytest.raises(tl.InputError, match=f"at least {least} triangles"):
        terrain.mesh(**ODD, lod=tl.BudgetLod(least - 1))
    assert len(terrain.mesh(**ODD, lod=tl.BudgetLod(least)).triangles) == least


def test_finer_than_the_raster_can_show_says_what_it_came_to() -> None:
    # points of even tiles stand between samples, so a little error always remains
    mesh = tl.Terrain(GROUNDS["rough"], tile=8).mesh(**ODD, lod=tl.MaxErrorLod(1e-6))
    assert not mesh.achieved.kept
    assert mesh.achieved.metres > 1e-6
