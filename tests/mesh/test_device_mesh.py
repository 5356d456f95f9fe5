"""Meshes that stay on the device: the same as others, and shared without a copy."""

from __future__ import annotations

import gc
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

import terrain_lod as tl

ARRAYS = ("vertices", "normals", "triangles")


@pytest.fixture(scope="module")
def terrain() -> tl.Terrain:
    rows, columns = np.indices((70, 90))
    waves = 9 * np.sin(rows / 5) * np.cos(columns / 7)
    return tl.Terrain(tl.Heightmap(waves.astype(np.float32), spacing=2.0))


def pointer(values: np.ndarray) -> int:
    return int(values.__array_interface__["data"][0])


@pytest.mark.parametrize("lod", [None, tl.MaxErrorLod(0.5)], ids=["full", "promise"])
def test_it_is_the_mesh_that_the_host_gets(terrain: tl.Terrain, lod) -> None:
    mesh, there = terrain.mesh(lod=lod), terrain.mesh_on_device(lod=lod)
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(there, name).host(), getattr(mesh, name))
    np.testing.assert_array_equal(there.origin, mesh.origin)
    assert (there.achieved, there.crs) == (mesh.achieved, mesh.crs)


def test_views_are_the_memory_itself(terrain: tl.Terrain) -> None:
    vertices = terrain.mesh_on_device().vertices
    view = vertices.view()
    assert pointer(view) == pointer(np.asarray(vertices)) == pointer(np.from_dlpack(vertices))
    view[0] = 7.0
    assert (vertices.host()[0] == 7.0).all()
    assert not np.shares_memory(vertices.host(), view)


def test_a_view_outlives_the_mesh_and_all_that_comes_after(terrain: tl.Terrain) -> None:
    mesh = terrain.mesh_on_device()
    before = terrain.device.allocated
    view, taken = mesh.vertices.view(), np.from_dlpack(mesh.triangles)
    expected, corners = view.copy(), taken.copy()
    del mesh
    gc.collect()
    for scale in (2.0, 3.0):
        terrain.device.zeros(view.shape, np.float32).fill(scale)
        terrain.mesh()
    np.testing.assert_array_equal(view, expected)
    np.testing.assert_array_equal(taken, corners)
    del view, taken
    gc.collect()
    assert terrain.device.allocated < before


def test_a_mesh_of_nothing_has_views_of_nothing(terrain: tl.Terrain) -> None:
    x, y, z = terrain.ground.centre
    away = tl.Camera((x, y, z + 50), (x, y + 1, z + 60), up=(0, 1, 0), fov=20)
    mesh = terrain.mesh_on_device(away)
    assert [getattr(mesh, name).view().shape for name in ARRAYS] == [(0, 3)] * 3


def test_kernels_of_others_take_the_buffer(terrain: tl.Terrain) -> None:
    mesh = terrain.mesh_on_device()
    program = """
import numpy as np, pyopencl as cl, terrain_lod as tl
mesh = tl.Terrain(tl.Heightmap(np.ones((9, 9), np.float32), spacing=1.0)).mesh_on_device()
text = "__kernel void lift(__global float *v) { v[3 * get_global_id(0) + 2] += 1.0f; }"
lift = cl.Kernel(cl.Program(mesh.device.context, text).build(), "lift")
lift(mesh.device.queue, (mesh.vertices.shape[0],), None, mesh.vertices.buffer)
print(set(mesh.vertices.view()[:, 2].tolist()), mesh.origin[2])
"""
    child = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    height, base = child.stdout.strip().split("} ")
    assert float(height.strip("{")) + float(base) == 2.0, child.stderr
    assert mesh.device is terrain.device


def test_pytorch_takes_it_without_a_copy(terrain: tl.Terrain) -> None:
    torch = pytest.importorskip("torch")
    vertices = terrain.mesh_on_device().vertices
    tensor = torch.from_dlpack(vertices)
    assert tensor.data_ptr() == pointer(vertices.view())


def test_memory_of_a_gpu_has_no_view(terrain: tl.Terrain, monkeypatch) -> None:
    vertices = terrain.mesh_on_device().vertices
    gpu = SimpleNamespace(is_gpu=True, info=terrain.device.info, memory=terrain.device.memory)
    monkeypatch.setattr(vertices, "device", gpu)
    with pytest.raises(tl.DeviceError, match=r"copy it with host\(\)"):
        vertices.view()
    assert not hasattr(vertices, "__array_interface__")
    with pytest.raises(tl.DeviceError):
        np.from_dlpack(vertices)
