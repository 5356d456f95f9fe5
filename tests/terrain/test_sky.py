"""Light of the sky on the ground: whole on a plain, half at a wall, and found once."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import rough
from terrain_lod.reference.terrain.sky import sky_seen as expected_sky


def test_a_plain_sees_all_of_it_and_the_foot_of_a_wall_half():
    flat = tl.Terrain(tl.Heightmap(np.full((40, 50), 8.0)))
    np.testing.assert_array_equal(flat.sky, np.ones((40, 50)))
    wall = np.zeros((40, 60))
    wall[:, 30:] = 1e6
    sky = tl.Terrain(tl.Heightmap(wall)).sky
    # of twelve directions five go into the wall, two along it
    assert sky[20, 29] == pytest.approx(7 / 12, abs=1e-3)
    assert sky[20, 40] == 1.0


def test_a_pit_sees_less_the_deeper_it_is_and_holes_are_low():
    pit = np.zeros((21, 21))
    found = []
    for depth in (0.0, 1.0, 5.0):
        pit[10, 10] = -depth
        found.append(tl.Terrain(tl.Heightmap(pit)).sky[10, 10])
    assert found[0] == 1.0
    assert found[0] > found[1] > found[2]
    hole = np.zeros((60, 45), bool)
    hole[20:30, 10:20] = True
    ground = rough(60, 45, mask=hole)
    np.testing.assert_allclose(tl.Terrain(ground).sky, expected_sky(ground), atol=2e-6)


def test_it_is_kept_until_the_ground_changes():
    terrain = tl.Terrain(rough(33, 33))
    first = terrain.sky
    assert terrain.sky is first
    terrain.update(slice(10, 12), slice(10, 12), np.full((2, 2), 500.0))
    assert terrain.sky is not first
    np.testing.assert_allclose(terrain.sky, expected_sky(terrain.ground), atol=2e-6)
