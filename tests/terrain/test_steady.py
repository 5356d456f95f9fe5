"""Patches that change late: promises are kept, and less jumps from picture to picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import rough

GROUND = rough(130, 110, spacing=30.0)
LOD = tl.ScreenErrorLod(2.0)


@pytest.fixture(scope="module")
def terrain() -> tl.Terrain:
    return tl.Terrain(GROUND)


def flight(step: float, count: int) -> list[tl.Camera]:
    """Return cameras that move on by `step` metres from each to the next."""
    camera = tl.default_camera(GROUND, size=(640, 360))
    x, y, z = camera.eye
    return [replace(camera, eye=(x, y + index * step, z)) for index in range(count)]


def test_a_trembling_camera_changes_nothing(terrain: tl.Terrain) -> None:
    one, other = flight(15.0, 2)
    cameras = [one, other] * 3
    steady = tl.Steady()
    still = [terrain.mesh(camera, lod=LOD, steady=steady) for camera in cameras]
    plain = [terrain.mesh(camera, lod=LOD) for camera in cameras]
    assert tl.pop_metric(plain, GROUND, cameras).rms > 0.01
    assert tl.pop_metric(still[2:], GROUND, cameras[2:]).rms < 0.002


def test_what_is_promised_is_kept_along_a_flight(terrain: tl.Terrain) -> None:
    steady = tl.Steady(0.5)
    for camera in flight(60.0, 12):
        mesh = terrain.mesh(camera, lod=LOD, steady=steady)
        assert mesh.achieved.kept
        assert tl.screen_error(mesh, GROUND, camera).maximum <= 2.0
        assert not tl.crack_report(mesh)


def test_without_a_band_every_mesh_is_as_if_it_were_the_first(terrain: tl.Terrain) -> None:
    steady = tl.Steady(0.0)
    for camera in flight(40.0, 3):
        found, expected = (terrain.mesh(camera, lod=LOD, steady=each) for each in (steady, None))
        np.testing.assert_array_equal(found.vertices, expected.vertices)
        np.testing.assert_array_equal(found.triangles, expected.triangles)


def test_a_steady_begins_anew_with_another_terrain() -> None:
    camera, other = flight(100.0, 2)
    steady = tl.Steady()
    terrain = tl.Terrain(GROUND)
    first = terrain.mesh(camera, lod=LOD, steady=steady)
    terrain.mesh(other, lod=LOD, steady=steady)
    again = tl.Terrain(GROUND).mesh(camera, lod=LOD, steady=steady)
    np.testing.assert_array_equal(again.vertices, first.vertices)


@pytest.mark.parametrize("hysteresis", [float("nan"), -0.1, 11, "much"])
def test_a_band_that_there_cannot_be(hysteresis: object) -> None:
    with pytest.raises(tl.InputError, match="hysteresis") as error:
        tl.Steady(hysteresis)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("lod", "how"),
    [
        (tl.DistanceLod(), {}),
        (tl.BudgetLod(500), {}),
        (LOD, {"partitioning": "fractional_odd"}),
    ],
)
def test_what_cannot_be_steady_is_refused(terrain: tl.Terrain, lod: object, how: dict) -> None:
    with pytest.raises(tl.InputError, match="expected an error to keep by patches of every size"):
        terrain.mesh(flight(0, 1)[0], lod=lod, steady=tl.Steady(), **how)
