"""Normal maps: shaded with one, a coarse mesh looks like the fine mesh it stands for."""

from __future__ import annotations

import io
import json
import struct
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import terrain_lod as tl
from terrain_lod.mesh.tangents import with_tangents
from terrain_lod.reference.mesh.normal_map import mapped_normals


@pytest.fixture(scope="module")
def ground() -> tl.Heightmap:
    x, y = np.meshgrid(np.linspace(0, 6, 65), np.linspace(0, 5, 65))
    return tl.Heightmap(90 * np.sin(x) * np.cos(y) + 4 * np.sin(9 * x + 7 * y), spacing=10.0)


@pytest.fixture(scope="module")
def fine(ground) -> tl.Mesh:
    return tl.Terrain(ground, tile=16, levels=1).mesh(
        lod=tl.UniformLod(16), partitioning="integer", cull=False
    )


@pytest.fixture(scope="module")
def coarse(ground) -> tl.Mesh:
    return tl.Terrain(ground).mesh(lod=tl.MaxErrorLod(15.0), cull=False)


def angles_to_fine(coarse: tl.Mesh, fine: tl.Mesh, normals_of) -> np.ndarray:
    """Degrees between what a coarse mesh is shaded with and the fine mesh's normals, from above."""
    points = np.random.default_rng(3).uniform((30, -600, 2000), (600, -30, 2000), (3000, 3))
    down = np.array([[0.0, 0.0, -1.0]])
    shaded = []
    for mesh, normals in ((coarse, normals_of), (fine, blended)):
        hits = tl.MeshQueries(mesh).cast(points, down)
        corners = mesh.vertices[mesh.triangles[hits.triangle]].astype(float)
        weights = np.linalg.solve(
            np.concatenate(
                [corners[:, :, :2].transpose(0, 2, 1), np.ones((len(points), 1, 3))], axis=1
            ),
            np.column_stack([hits.position[:, :2] - mesh.origin[:2], np.ones(len(points))])[
                ..., None
            ],
        )[..., 0]
        shaded.append(normals(mesh, hits.triangle, weights))
    return np.degrees(np.arccos(np.clip((shaded[0] * shaded[1]).sum(axis=1), -1, 1)))


def blended(mesh: tl.Mesh, triangles: np.ndarray, weights: np.ndarray) -> np.ndarray:
    normals = np.einsum("nc,ncd->nd", weights, mesh.normals[mesh.triangles[triangles]])
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def test_a_coarse_mesh_is_shaded_as_the_fine_one(coarse, fine):
    mapped = tl.bake_normals(coarse, fine, (512, 512))
    assert len(mapped.triangles) < len(fine.triangles) / 5
    before = angles_to_fine(coarse, fine, blended)
    after = angles_to_fine(mapped, fine, mapped_normals)
    assert np.mean(before) > 3
    assert np.mean(after) < 0.5


def test_a_flat_map_of_a_mesh_onto_itself(fine):
    pixels = tl.bake_normals(fine, fine, (40, 40)).normal_map.pixels
    assert abs(pixels.astype(int) - (128, 128, 255)).max() <= 1


def folded() -> tl.Mesh:
    """Return two triangles whose textures are mirrored at their common edge."""
    vertices = [(-1, 0, 0), (0, 0, 0), (0, 1, 0), (1, 0, 0)]
    textures = [(0.9, 0.1), (0.1, 0.1), (0.1, 0.9), (0.9, 0.1)]
    return tl.Mesh(vertices, [(0, 0, 1)] * 4, [(0, 1, 2), (1, 3, 2)], textures=textures)


def test_mirrored_textures_split_the_vertices_between_them():
    mesh, tangents = with_tangents(folded())
    assert mesh.triangles.tolist() == [[0, 4, 5], [1, 3, 2]]
    expected = [[-1, 0, 0, -1], [1, 0, 0, 1], [1, 0, 0, 1], [1, 0, 0, 1]]
    assert tangents.tolist() == [*expected, [-1, 0, 0, -1], [-1, 0, 0, -1]]


def test_texels_of_several_triangles_are_refused():
    with pytest.raises(tl.InputError, match="no two triangles share"):
        tl.bake_normals(folded(), folded(), (64, 64))


def test_texture_coordinates_beyond_the_picture_are_refused(fine):
    beyond = replace(fine, textures=2 * fine.vertices[:, :2] / 640)
    with pytest.raises(tl.InputError, match="from 0 to 1"):
        tl.bake_normals(beyond, fine)


def test_a_glb_holds_map_and_tangents(coarse, fine, tmp_path):
    mapped = tl.bake_normals(coarse, fine, (48, 32))
    content = mapped.save(tmp_path / "mapped.glb").read_bytes()
    (length,) = struct.unpack_from("<I", content, 12)
    document, binary = json.loads(content[20 : 20 + length]), content[28 + length :]
    (primitive,) = document["meshes"][0]["primitives"]
    material = document["materials"][primitive["material"]]
    source = document["textures"][material["normalTexture"]["index"]]["source"]
    view = document["bufferViews"][document["images"][source]["bufferView"]]
    png = binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
    np.testing.assert_array_equal(Image.open(io.BytesIO(png)), mapped.normal_map.pixels)
    accessor = document["accessors"][primitive["attributes"]["TANGENT"]]
    view = document["bufferViews"][accessor["bufferView"]]
    tangents = np.frombuffer(binary, "<f4", 4 * accessor["count"], view["byteOffset"])
    np.testing.assert_array_equal(tangents.reshape(-1, 4), mapped.normal_map.tangents)
    assert tl.load_mesh(tmp_path / "mapped.glb").textures is not None
