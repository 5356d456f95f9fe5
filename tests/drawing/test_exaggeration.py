"""Heights drawn taller: pixels of the picture, metres of the ground."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.grounds import rough
from terrain_lod.cli.app import REFUSED, run
from terrain_lod.drawing.exaggeration import ExaggeratedTerrain
from terrain_lod.ground.exaggeration import exaggerated
from terrain_lod.measure.error import vertical_error
from terrain_lod.mesh.stretched import stretched

FACTOR = 5.0
GROUND = rough(41, 41, spacing=30.0)


def test_meshes_keep_true_metres_and_the_pixels_of_the_picture():
    terrain = ExaggeratedTerrain(tl.Terrain(GROUND), FACTOR)
    camera = tl.default_camera(GROUND, size=(320, 200), exaggeration=FACTOR)
    asked = 2.0
    mesh = terrain.mesh(camera, lod=tl.MaxErrorLod(asked), cull=False)
    off = vertical_error(mesh, GROUND).maximum
    assert off == pytest.approx(mesh.achieved.metres, rel=1e-3)
    assert 0.2 * asked < off <= asked * (1 + 1e-6)
    seen = terrain.mesh(camera, lod=tl.ScreenErrorLod(1.0))
    shown = tl.screen_error(
        stretched(seen, FACTOR), exaggerated(GROUND, FACTOR), camera.lifted(FACTOR)
    )
    assert shown.maximum <= 1.001
    assert len(seen.triangles) > len(tl.Terrain(GROUND).mesh(camera).triangles)


def test_stretched_there_and_back_is_the_same_mesh():
    mesh = tl.Terrain(GROUND).mesh(lod=tl.MaxErrorLod(2.0))
    back = stretched(stretched(mesh, 3.0), 1 / 3.0)
    np.testing.assert_allclose(back.vertices, mesh.vertices, rtol=1e-6)
    np.testing.assert_allclose(back.normals, mesh.normals, atol=1e-6)
    assert back.achieved.metres == pytest.approx(mesh.achieved.metres)
    assert stretched(mesh, 1.0) is mesh


def test_sea_level_stays_and_holes_stay():
    ground = tl.Heightmap([[0.0, 1.0], [np.nan, 4.0]], base=10.0)
    tall = exaggerated(ground, 3.0)
    np.testing.assert_array_equal(tall.elevation, 3.0 * ground.elevation)


def test_bad_exaggeration_is_one_line_and_nothing_is_written(capsys, tmp_path):
    path = tmp_path / "view.png"
    for bad in ("0", "-1", "nan"):
        assert run(["render", "ridge", "-o", str(path), "--exaggeration", bad]) == REFUSED
        error = capsys.readouterr().err
        assert error.count("\n") == 1
        assert "exaggeration" in error
    assert not path.exists()
