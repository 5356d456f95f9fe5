"""Meshes drawn: the right pixels at the right places, and no crash where nothing can be drawn."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from terrain_lod.camera.camera import Camera
from terrain_lod.camera.viewpoint import default_camera
from terrain_lod.drawing.colours import LOD_STOPS, sun_direction
from terrain_lod.drawing.graphics import INSTALL_COMMAND, graphics_problem, require_graphics
from terrain_lod.drawing.picture import SHADE, draw, require_png, save_png
from terrain_lod.errors import FileError, GraphicsError, InputError
from terrain_lod.ground.grid import TileGrid
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.mesh.mesh import Mesh, Patches

needs_graphics = pytest.mark.skipif(
    graphics_problem() is not None, reason=f"no 3-D pictures tested: {graphics_problem()}"
)

# where UTM coordinates are: float32 alone would be off by half a metre here
ORIGIN = (500_000.0, 4_000_000.0, 2_000.0)
TILE = 10.0  # metres


def tiles_of(factors, *, height=0.0, origin=ORIGIN):
    """Two triangles a tile, level ground; a factor of 0 leaves a hole.

    ::

        x0, y0 ---> columns, east
          |  a---b
          v  | \\ |
        rows c---d      triangles a c d, a d b
    """
    factors = np.asarray(factors, np.float32)
    corner = np.array([[0, 0], [0, 1], [1, 1], [0, 0], [1, 1], [1, 0]])  # column, row
    drawn = factors.ravel() > 0
    index = np.argwhere(np.ones(factors.shape))[:, ::-1][drawn]
    flat = (index[:, None] + corner).reshape(-1, 2) * TILE * [1, -1]
    vertices = np.column_stack([flat, np.full(len(flat), height)]).astype(np.float32)
    offsets = np.concatenate([[0], np.cumsum(drawn)])
    inside = np.repeat(factors.reshape(-1, 1), 2, axis=1)
    return Mesh(
        vertices,
        np.tile(np.float32([0, 0, 1]), (len(vertices), 1)),
        np.arange(len(vertices), dtype=np.int32).reshape(-1, 3),
        np.array(origin),
        patches=Patches(
            grid=TileGrid(15 * factors.shape[0] + 1, 15 * factors.shape[1] + 1, 15, (1.0, 1.0)),
            areas=np.array(
                [(15 * row, 15 * column, 15, 15) for row, column in np.ndindex(factors.shape)],
                np.int32,
            ),
            edge_factors=np.ones((factors.size, 4), np.float32),
            inside_factors=inside,
            point_offsets=offsets * 6,
            triangle_offsets=offsets * 2,
            deviation=np.zeros(factors.size, np.float32),
        ),
    )


def over(x, y, z=30.0, size=(200, 160), **options):
    """A camera south of a point on the ground, looking down on it."""
    target = np.add(ORIGIN, (x, y, 0.0))
    eye = np.add(target, (4.0, -25.0, z))
    return Camera(tuple(eye), tuple(target), size=size, **options)


def tile_centre(row, column):
    return np.add(ORIGIN, ((column + 0.5) * TILE, -(row + 0.5) * TILE, 0.0))


def pixel_at(picture, camera, point):
    (x, y), _ = (values[0] for values in camera.project([point]))
    return picture[int(y), int(x)].astype(int)


@needs_graphics
def test_lod_colours_stand_where_their_patches_project():
    factors = np.array([[15.0, 8.0, 4.5], [1.0, 0.0, 15.0]])
    mesh, camera = tiles_of(factors), over(15.0, -10.0)
    picture = draw(mesh, camera, style="factor", colour_range=(1.0, 15.0))
    assert picture.shape == (160, 200, 3)
    assert picture.dtype == np.uint8

    # viridis, darkened by as much light as level ground has under that sun
    light = SHADE + (1 - SHADE) * np.sin(np.radians(40))
    for (row, column), position in (((0, 0), 1.0), ((0, 1), 0.5), ((0, 2), 0.25), ((1, 0), 0.0)):
        stop = next(stop for stop in LOD_STOPS if stop[0] == position)
        seen = pixel_at(picture, camera, tile_centre(row, column))
        assert seen == pytest.approx(255 * light * np.array(stop[1:]), abs=1.0)
    # the culled patch shows what is behind the ground
    assert (pixel_at(picture, camera, tile_centre(1, 1)) == picture[0, 0]).all()


@needs_graphics
def test_plain_has_one_colour_whatever_the_height():
    mesh, camera = tiles_of([[15.0, 15.0]]), over(15.0, -10.0)
    picture = draw(mesh, camera, style="plain")
    low, high = (pixel_at(picture, camera, tile_centre(0, column)) for column in range(2))
    assert (low == high).all()
    assert (low != picture[0, 0]).all()
    # below zero it is no sea
    sunk = replace(mesh, origin=mesh.origin - (0, 0, 500))
    below = replace(
        camera,
        eye=tuple(np.subtract(camera.eye, (0, 0, 500))),
        target=tuple(np.subtract(camera.target, (0, 0, 500))),
    )
    np.testing.assert_array_equal(draw(sunk, below, style="plain"), picture)


@needs_graphics
@pytest.mark.parametrize("size", [(200, 160), (160, 200), (64, 64), (301, 77)])
@pytest.mark.parametrize("fov", [5.0, 60.0, 120.0, "parallel"])
def test_outline_is_where_the_camera_projects_it(size, fov):
    parallel = fov == "parallel"
    distance = 12.0 if parallel else 12.0 / np.tan(np.radians(fov) / 2)
    target = tile_centre(0, 0)
    eye = target + distance * np.array([0.3, -0.6, 0.75])
    view = {"height": 23.0} if parallel else {"fov": fov}
    camera = Camera(tuple(eye), tuple(target), size=size, **view)
    picture = draw(tiles_of([[15.0]]), camera, style="factor")
    red, background = pixel_at(picture, camera, target)[0], int(picture[0, 0, 0])
    assert red < 0.5 * background
    coverage = (picture[..., 0].astype(float) - background) / (red - background)

    reach = TILE / 2 * np.array([[-1, 1, 0], [-1, -1, 0], [1, -1, 0], [1, 1, 0]])
    corners, _ = camera.project(target + reach)
    expected = coverage_of_polygon(corners, size)
    outline = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).sum()
    assert expected.sum() > 100
    # a shift by a tenth of a pixel would change some 0.06 pixels of coverage a pixel of outline
    assert np.abs(coverage - expected).sum() < 0.02 * outline


def coverage_of_polygon(corners, size):
    """Share of the four middles of each pixel's quarters that lie in a convex polygon; (H, W)."""
    width, height = size
    x, y = np.meshgrid(np.arange(2 * width) / 2 + 0.25, np.arange(2 * height) / 2 + 0.25)
    sides = np.array(
        [
            (x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)
            for (x0, y0), (x1, y1) in zip(corners, np.roll(corners, -1, axis=0), strict=True)
        ]
    )
    inside = (sides <= 0).all(axis=0) | (sides >= 0).all(axis=0)
    return inside.reshape(height, 2, width, 2).mean(axis=(1, 3))


@needs_graphics
def test_near_plane_hides_only_what_is_nearer():
    mesh, camera = tiles_of(np.full((4, 4), 15.0)), over(20.0, -20.0)
    whole = draw(mesh, camera, style="factor")
    _, depth = camera.project(mesh.vertices + mesh.origin)
    cut = draw(mesh, replace(camera, near=float(np.median(depth))), style="factor")
    background = whole[0, 0]
    assert (cut[:80] == whole[:80]).all()  # far half
    assert (cut[90:] == background).all()  # near half
    beyond = draw(mesh, replace(camera, far=float(np.median(depth))), style="factor")
    assert (beyond[90:] == whole[90:]).all()
    assert (beyond[:70] == background).all()


@needs_graphics
def test_far_ground_hides_what_is_behind_it():
    # 20 km off, yellow 60 m in front of a green wall; and something behind the eye, so that
    # the ground as a whole begins at no distance at all
    upright = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]], np.float32)
    wall = 50 * tiles_of([[1.0]]).vertices @ upright
    walls = [wall, wall + np.float32([0, 60, 0]), wall - np.float32([0, 40_000, 0])]
    mesh = Mesh(
        np.concatenate(walls),
        np.tile(np.float32([0, -1, 0]), (18, 1)),
        np.arange(18, dtype=np.int32).reshape(-1, 3),
        np.array(ORIGIN),
        patches=replace(
            tiles_of([[15.0, 8.0, 1.0]]).patches, triangle_offsets=np.array([0, 2, 4, 6])
        ),
    )
    middle = wall.mean(axis=0) + mesh.origin
    camera = Camera(tuple(middle - [0, 20_000, 0]), tuple(middle), fov=2.0, size=(100, 100))
    picture = draw(mesh, camera, style="factor").astype(int)
    red, green, blue = picture[50, 50]
    assert red > green > 3 * blue


@needs_graphics
def test_shaded_ground_is_brighter_towards_the_sun():
    mesh = tiles_of(np.full((3, 3), 1.0))
    slope = np.tile(np.float32([0.6, 0, 0.8]), (len(mesh.normals), 1))  # falls to the east
    mesh = replace(mesh, normals=slope)
    camera = over(15.0, -15.0)
    east = draw(mesh, camera, sun=(90.0, 40.0))
    west = draw(mesh, camera, sun=(270.0, 40.0))
    centre = np.s_[75:85, 95:105]
    assert east[centre].mean() > 1.3 * west[centre].mean()


@needs_graphics
def test_wireframe_draws_the_edges_and_hides_what_lies_behind():
    mesh, camera = tiles_of([[15.0]]), over(5.0, -5.0)
    picture = draw(mesh, camera, style="wireframe").astype(int)
    paper = picture[0, 0]
    edge = np.add(ORIGIN, (0.5 * TILE, -TILE, 0.0))  # middle of the southern edge
    (x, y), _ = (values[0] for values in camera.project([edge]))
    assert picture[int(y) - 1 : int(y) + 2, int(x)].sum(axis=-1).min() < 0.7 * paper.sum()
    inside = np.add(ORIGIN, (0.75 * TILE, -0.3 * TILE, 0.0))
    assert (pixel_at(picture, camera, inside) == paper).all()
    # the same mesh again, below: hidden, so the picture stays as it was
    below = mesh.vertices * np.float32([0.4, 0.4, 1]) + np.float32([3, -1, -3])
    both = Mesh(
        np.concatenate([mesh.vertices, below]),
        np.tile(mesh.normals, (2, 1)),
        np.concatenate([mesh.triangles, mesh.triangles + 6]),
        mesh.origin,
    )
    assert (draw(both, camera, style="wireframe") == picture).all()


@needs_graphics
def test_picture_of_nothing_is_sky():
    camera = over(0.0, 0.0)
    away = replace(camera, target=tuple(np.add(camera.eye, (0.0, -1.0, 1.0))))
    empty = tiles_of([[0.0]])
    behind = tiles_of([[15.0]])
    sky = draw(empty, away)
    assert (draw(behind, away) == sky).all()
    assert np.ptp(sky.astype(int), axis=1).max() == 0  # one colour a row
    assert sky[0, 0, 2] > sky[0, 0, 0]


@needs_graphics
def test_same_picture_twice_and_as_a_file(tmp_path: Path):
    mesh, camera = tiles_of([[15.0, 8.0]]), over(10.0, -5.0)
    path = tmp_path / "view.png"
    picture = draw(mesh, camera)
    assert save_png(picture, path) == path
    written = path.read_bytes()
    assert (np.asarray(Image.open(path)) == picture).all()
    save_png(draw(mesh, camera), path)
    assert path.read_bytes() == written
    assert [entry.name for entry in tmp_path.iterdir()] == ["view.png"]


@needs_graphics
def test_picture_larger_than_the_window_may_be_doubled():
    mesh = tiles_of([[15.0]])
    picture = draw(mesh, over(5.0, -5.0, size=(5000, 20)), style="lod")
    assert picture.shape == (20, 5000, 3)


def test_sun_stands_clockwise_from_north():
    assert sun_direction(90.0, 0.0) == pytest.approx([1, 0, 0], abs=1e-6)
    assert sun_direction(180.0, 30.0) == pytest.approx([0, -(0.75**0.5), 0.5], abs=1e-6)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"style": "cubist"}, "expected one of shaded, plain, wireframe, lod, size, factor"),
        (
            {"style": "factor", "colour_range": (3.0, 3.0)},
            r"colour_range above 0 that rises, got \(3.0, 3.0\)",
        ),
        ({"height_range": (5.0, -5.0)}, r"height_range that rises, got \(5.0, -5.0\)"),
        ({"sun": (float("nan"), 40.0)}, "finite sun"),
        ({"exaggeration": 0.0}, "expected exaggeration > 0, got 0"),
        ({"exaggeration": float("nan")}, "finite exaggeration, got nan"),
    ],
)
def test_bad_option_is_refused(options, message):
    with pytest.raises(InputError, match=message):
        draw(tiles_of([[15.0]]), over(0.0, 0.0), **options)


def test_bad_output_is_refused_before_drawing(tmp_path: Path):
    with pytest.raises(FileError, match=r"expected a folder to write view\.png in"):
        require_png(tmp_path / "nowhere" / "view.png")
    with pytest.raises(InputError, match="at most 8192 pixels"):
        draw(tiles_of([[15.0]]), over(0.0, 0.0, size=(9000, 10)))
    with pytest.raises(InputError, match="mesh with patches"):
        draw(replace(tiles_of([[15.0]]), patches=None), over(0.0, 0.0), style="lod")


def test_default_camera_stands_above_the_ground_and_sees_it():
    heights = np.zeros((60, 90))
    heights[-12:, :40] = 700.0  # a mesa where the eye would stand
    heights[30, 40] = np.nan
    ground = Heightmap(heights, spacing=(30.0, 20.0), origin=ORIGIN[:2], base=100.0)
    camera = default_camera(ground)
    assert camera.eye[2] > 800.0
    pixels, depth = camera.project([ground.centre])
    assert depth[0] > 0
    assert np.abs(pixels[0] / camera.size - 0.5).max() < 0.2


BROKEN_DRIVER = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nonexistent", "DISPLAY": ""}
ASK = """
from terrain_lod.drawing.graphics import require_graphics
from terrain_lod.errors import GraphicsError
try:
    require_graphics()
except GraphicsError as error:
    print(error)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="breaks the driver as glvnd lets one")
def test_missing_driver_is_a_message_not_a_crash():
    """VTK itself dies of a segmentation fault here."""
    child = subprocess.run(
        [sys.executable, "-c", ASK],
        capture_output=True,
        text=True,
        env=os.environ | BROKEN_DRIVER,
        timeout=120,
    )
    assert child.returncode == 0
    assert child.stderr == ""
    assert child.stdout.count("\n") == 1
    assert INSTALL_COMMAND in child.stdout


def test_no_graphics_is_a_terrain_error(monkeypatch):
    monkeypatch.setattr(
        "terrain_lod.drawing.graphics.graphics_problem", lambda: "expected OpenGL, got none"
    )
    with pytest.raises(GraphicsError, match="expected OpenGL"):
        require_graphics()
    with pytest.raises(GraphicsError):
        draw(tiles_of([[15.0]]), over(0.0, 0.0))
