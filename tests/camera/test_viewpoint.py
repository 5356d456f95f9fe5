"""Default cameras: ground of any shape is in the picture, from every side of an orbit."""

from __future__ import annotations

import numpy as np
import pytest

from terrain_lod import Heightmap, InputError, default_camera
from terrain_lod.camera.path import orbit
from terrain_lod.camera.viewpoint import orbit_camera


def hills(rows, columns, spacing, relief):
    """A hill over the middle of a raster, falling to its border."""
    y, x = np.mgrid[-1 : 1 : rows * 1j, -1 : 1 : columns * 1j]
    return Heightmap(
        relief * np.exp(-3 * (x**2 + y**2)), spacing=spacing, origin=(500_000.0, 4_000_000.0)
    )


GROUNDS = {
    "tall and narrow": hills(60, 40, 10.0, 3000.0),
    "flat and wide": hills(20, 400, 30.0, 40.0),
    "flat and deep": hills(400, 20, 30.0, 40.0),
    "a needle": hills(5, 5, 1.0, 500.0),
    "level": Heightmap(np.zeros((40, 40)), spacing=10.0),
    "two samples": Heightmap([[0.0, 1.0], [2.0, 3.0]]),
}


def corners(ground, exaggeration=1.0):
    """World points of all samples, as they are drawn."""
    row, column = np.nonzero(ground.valid)
    x = ground.origin[0] + column * ground.spacing[0]
    y = ground.origin[1] - row * ground.spacing[1]
    return np.stack([x, y, ground.elevation[row, column] * exaggeration], axis=1)


def shares(camera, points):
    """Where points are across and down the picture, 0 to 1 within it; NaN behind the eye."""
    pixels, depth = camera.project(points)
    return np.where(depth[:, None] > 0, pixels / camera.size, np.nan)


@pytest.mark.parametrize("name", GROUNDS)
@pytest.mark.parametrize("size", [(1920, 1080), (400, 900)])
def test_ground_of_any_shape_is_in_the_picture_and_fills_it(name, size):
    ground = GROUNDS[name]
    at = shares(default_camera(ground, size=size), corners(ground))
    inside = (at >= 0).all(axis=1) & (at <= 1).all(axis=1)
    assert inside.mean() > 0.4
    assert not (at[:, 1] < 0).any()  # no wall: nothing above the picture
    assert np.ptp(at[inside], axis=0).max() > 0.4  # and no dot


def test_ordinary_ground_is_looked_over_from_its_southern_edge():
    ground = hills(60, 60, 30.0, 300.0)
    camera = default_camera(ground)
    x, y, _ = ground.centre
    assert camera.eye[:2] == pytest.approx((x - 0.2 * ground.extent[0], y - ground.extent[1] / 2))


@pytest.mark.parametrize("name", GROUNDS)
def test_an_orbit_has_all_of_the_ground_in_every_picture(name):
    ground = GROUNDS[name]
    for camera in orbit(ground, 9):
        at = shares(camera, corners(ground))
        assert (at > 0).all()
        assert (at < 1).all()


@pytest.mark.parametrize("view", [default_camera, orbit_camera])
def test_exaggerated_ground_is_in_the_picture_and_the_camera_in_the_true_world(view):
    ground = hills(60, 60, 10.0, 100.0)
    camera = view(ground, exaggeration=40.0)
    at = shares(camera.lifted(40.0), corners(ground, 40.0))
    assert (at > 0).all()
    assert (at < 1).all()
    # what is seen of exaggerated ground is seen of the ground itself from where the camera is
    assert camera.lifted(40.0).lifted(1 / 40).eye == pytest.approx(camera.eye)


@pytest.mark.parametrize("bad", [0.0, -2.0, float("nan")])
def test_what_is_no_exaggeration_is_refused(bad):
    with pytest.raises(InputError, match=r"exaggeration"):
        default_camera(GROUNDS["level"], exaggeration=bad)
