"""Pictures laid over meshes: they show, in the file, the place that they were taken of."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from rasterio.transform import Affine
from rasterio.warp import transform

from support.drawn_meshes import grid_mesh
from support.rasters import write_tiff
from terrain_lod.errors import FileError, InputError
from terrain_lod.files.meshes.loading import load_mesh
from terrain_lod.files.rasters.loading import load
from terrain_lod.files.rasters.ortho import coordinates, read_ortho
from terrain_lod.files.rasters.place import map_of
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.mesh.mesh import Mesh

DEGREES = Affine(1 / 1200, 0, 7.0, 0, -1 / 1200, 46.05)


@pytest.fixture
def ground(tmp_path: Path) -> Heightmap:
    """Ground that was in degrees, and is in local metres."""
    rows, columns = np.mgrid[:30, :40]
    values = np.float32(500 + 10 * np.sin(rows / 5) + columns)
    return load(write_tiff(tmp_path / "g.tif", values, crs="EPSG:4326", transform=DEGREES))


@pytest.fixture
def ortho(tmp_path: Path) -> Path:
    """Longitude as red and latitude as green, on another map."""
    west, north = (part[0] for part in transform("EPSG:4326", "EPSG:32632", [6.99], [46.07]))
    affine = Affine(15, 0, west, 0, -15, north)
    columns, rows = np.meshgrid(np.arange(320), np.arange(360))
    x, y = affine.c + 15 * (columns + 0.5), affine.f - 15 * (rows + 0.5)
    moved = transform("EPSG:32632", "EPSG:4326", x.ravel(), y.ravel())
    longitude, latitude = (np.reshape(part, x.shape) for part in moved)
    red, green = (longitude - 6.99) / 0.06 * 255, (latitude - 46.0) / 0.07 * 255
    picture = np.stack([red, green, np.full_like(red, 90)]).clip(0, 255).round().astype(np.uint8)
    return write_tiff(tmp_path / "o.tif", picture, crs="EPSG:32632", transform=affine)


def draped(ground: Heightmap, ortho: Path) -> tuple[Mesh, np.ndarray]:
    mesh = grid_mesh(ground)
    textures = coordinates(mesh.vertices, mesh.origin, ground)
    return replace(mesh, textures=textures, crs=ground.crs), read_ortho(ortho, ground)


@pytest.mark.parametrize("ending", [".glb", ".obj"])
def test_vertices_have_the_colour_of_their_place(tmp_path, ground, ortho, ending) -> None:
    mesh, picture = draped(ground, ortho)
    path = mesh.save(tmp_path / f"draped{ending}", picture=picture)
    # another program finds the picture, and where each vertex is in it
    scene = trimesh.load(path, process=False)
    (body,) = scene.geometry.values() if isinstance(scene, trimesh.Scene) else [scene]
    material = body.visual.material
    image = getattr(material, "baseColorTexture", None) or material.image
    assert image.size == picture.shape[1::-1]
    u, v = body.visual.uv.T
    pixels = np.asarray(image.convert("RGB"), np.float64)
    row = ((1 - v) * len(pixels) - 0.5).round().astype(int).clip(0, len(pixels) - 1)
    column = (u * pixels.shape[1] - 0.5).round().astype(int).clip(0, pixels.shape[1] - 1)
    loaded = load_mesh(path)
    code, (east, north) = map_of(loaded.crs or "")
    assert code == "EPSG:4326"
    x, y = (loaded.vertices[:, :2] + loaded.origin[:2]).T / np.array([[east], [north]])
    if ending == ".glb":
        assert len(loaded.vertices) == len(body.vertices)
    expected = np.stack([(x - 6.99) / 0.06 * 255, (y - 46.0) / 0.07 * 255], axis=1)
    # rounding, half a pixel, and what JPEG takes
    np.testing.assert_allclose(pixels[row, column][:, :2], expected, atol=4)


def test_files_beside_an_obj(tmp_path, ground, ortho) -> None:
    mesh, picture = draped(ground, ortho)
    mesh.save(tmp_path / "a.obj", picture=picture)
    assert {"a.obj", "a.mtl", "a.jpg"} <= {path.name for path in tmp_path.iterdir()}
    assert Image.open(io.BytesIO((tmp_path / "a.jpg").read_bytes())).format == "JPEG"
    np.testing.assert_array_equal(load_mesh(tmp_path / "a.obj").origin, mesh.origin)


def test_a_picture_without_a_place_covers_the_ground(tmp_path, ground) -> None:
    Image.fromarray(np.uint8([[[9, 8, 7], [1, 2, 3]]])).save(tmp_path / "p.png")
    picture = read_ortho(tmp_path / "p.png", ground)
    assert picture.tolist() == [[[9, 8, 7], [1, 2, 3]]]


def test_pictures_that_cannot_be_are_refused(tmp_path, ground, ortho) -> None:
    elsewhere = replace_origin(ground, (0.0, 0.0))
    with pytest.raises(InputError, match="another place"):
        read_ortho(ortho, elsewhere)
    with pytest.raises(InputError, match="with a CRS"):
        read_ortho(ortho, Heightmap(ground.heights))
    with pytest.raises(FileError, match="got nothing"):
        read_ortho(tmp_path / "none.tif", ground)
    (tmp_path / "bad.tif").write_bytes(b"no picture")
    with pytest.raises(FileError, match="GDAL reads"):
        read_ortho(tmp_path / "bad.tif", ground)
    deep = write_tiff(tmp_path / "deep.tif", np.zeros((4, 4), np.float32))
    with pytest.raises(InputError, match="8 bits"):
        read_ortho(deep, ground)
    mesh, picture = draped(ground, ortho)
    with pytest.raises(InputError, match=r"\.glb or \.obj"):
        mesh.save(tmp_path / "a.stl", picture=picture)
    with pytest.raises(InputError, match="texture coordinates"):
        replace(mesh, textures=None).save(tmp_path / "a.glb", picture=picture)


def replace_origin(ground: Heightmap, origin: tuple[float, float]) -> Heightmap:
    return Heightmap(ground.heights, spacing=ground.spacing, origin=origin, crs=ground.crs)
