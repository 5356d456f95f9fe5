"""All that the device knows of a terrain, against a terrain made anew of the same ground."""

from __future__ import annotations

import numpy as np

import terrain_lod as tl


def everything(terrain: tl.Terrain) -> dict[str, np.ndarray]:
    """Return all that the device knows of a terrain, ladder included."""
    tiles = terrain._with_ladder()
    return {
        "heights": tiles.ground.heights.host(),
        "holes": tiles.ground.holes.host(),
        "planes": tiles.analysis.planes.host(),
        "details": tiles.analysis.details.host(),
        "control points": tiles.patches.control_points.host(),
        **{name: array.host() for name, array in tiles.ladder.measured().items()},
    }


def assert_as_made_anew(terrain: tl.Terrain, **options: object) -> None:
    anew = tl.Terrain(terrain.ground, **options)
    for name, expected in everything(anew).items():
        found = everything(terrain)[name]
        np.testing.assert_array_equal(found.view(np.uint8), expected.view(np.uint8), err_msg=name)
    assert terrain.scene == anew.scene
    np.testing.assert_array_equal(terrain.analysis.deviation, anew.analysis.deviation)
