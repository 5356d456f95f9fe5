"""``tl.render``: the same picture of ground, of its terrain and of its mesh."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import terrain_lod as tl
from support.grounds import rough
from terrain_lod.camera.viewpoint import camera_around
from terrain_lod.drawing.drape import Drape
from terrain_lod.drawing.graphics import graphics_problem
from terrain_lod.drawing.picture import draw

pytestmark = pytest.mark.skipif(
    graphics_problem() is not None, reason=f"no 3-D pictures tested: {graphics_problem()}"
)


def test_ground_terrain_and_mesh_are_drawn_alike(tmp_path: Path) -> None:
    ground = rough()
    camera = tl.default_camera(ground, size=(160, 90))
    mesh = tl.Terrain(ground).mesh(camera, lod=tl.DistanceLod())
    expected = draw(mesh, camera, height_range=ground.height_range)
    path = tmp_path / "view.png"
    for what, more in (
        (ground, {"lod": tl.DistanceLod()}),
        (tl.Terrain(ground), {"lod": tl.DistanceLod()}),
        (mesh, {"height_range": ground.height_range}),
    ):
        picture = tl.render(what, path, camera=camera, **more)  # type: ignore[arg-type]
        np.testing.assert_array_equal(picture, expected)
        np.testing.assert_array_equal(np.asarray(Image.open(path)), expected)
        path.unlink()
    lined = tl.render(mesh, camera=camera, wireframe=True)
    assert lined.mean() < expected.mean() - 2
    assert not list(tmp_path.iterdir())


@pytest.mark.slow
def test_without_a_camera_all_is_in_view() -> None:
    ground = rough()
    seen = tl.render(ground, lod=tl.UniformLod(1), style="lod")
    camera = tl.default_camera(ground)
    assert seen.shape == (camera.size[1], camera.size[0], 3)
    # what no terrain made is no ground: plain, around its middle
    ring = tl.curved.surface("torus")
    camera = camera_around(ring.vertices)
    np.testing.assert_array_equal(tl.render(ring), draw(ring, camera, style="plain", sun=(200, 40)))
    pixels, depth = camera.project(ring.vertices)
    assert (depth > 0).all()
    assert ((pixels > 0) & (pixels < camera.size)).all()


def test_a_texture_lies_over_the_ground(tmp_path: Path) -> None:
    ground, red = rough(), np.zeros((8, 8, 3), np.uint8)
    red[..., 0] = 200
    Image.fromarray(red).save(tmp_path / "red.png")
    camera = tl.default_camera(ground, size=(160, 90))
    found = tl.render(ground, camera=camera, texture=tmp_path / "red.png", lod=tl.UniformLod(3))
    mesh = tl.Terrain(ground).mesh(camera, lod=tl.UniformLod(3))
    np.testing.assert_array_equal(found, draw(mesh, camera, drape=Drape(red, ground)))


def test_what_does_not_fit_is_refused_before_any_work(tmp_path: Path) -> None:
    ground = rough()
    mesh = tl.Terrain(ground).mesh(lod=tl.UniformLod(1))
    for what, options, message in (
        (ground.heights, {}, "expected ground, a terrain or a mesh, got an array of shape"),
        (mesh, {"lod": tl.UniformLod(1)}, "expected ground with lod="),
        (mesh, {"texture": "red.png"}, "expected ground with texture="),
        (mesh, {"device": tl.Device.open()}, "expected ground with device="),
        (tl.Terrain(ground), {"device": tl.Device.open()}, "expected ground with device="),
        (ground, {"path": "view.gif"}, r"ends in \.png"),
        (ground, {"style": "cubist"}, "unknown style"),
    ):
        with pytest.raises(tl.InputError, match=message):
            tl.render(what, **options)  # type: ignore[arg-type]
    with pytest.raises(tl.FileError, match=r"none\.png"):
        tl.render(ground, texture=tmp_path / "none.png")
    with pytest.raises(tl.FileError, match="expected a folder"):
        tl.render(ground, tmp_path / "nowhere" / "view.png")
