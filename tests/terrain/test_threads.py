"""Threads that share a device and a terrain: the bits that one alone finds, and its own times."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import partial
from threading import Barrier, Event
from time import perf_counter

import numpy as np
import pytest

import terrain_lod as tl
from support.cameras import cameras_over
from support.grounds import holed, rough

LODS = (tl.CoplanarityLod(), tl.ScreenErrorLod(4.0), tl.MaxErrorLod(3.0), tl.UniformLod(4.5))
PART = slice(20, 50), slice(30, 44)


def bits(mesh: tl.Mesh) -> tuple[bytes, ...]:
    patches = mesh.patches
    arrays = mesh.vertices, mesh.normals, mesh.triangles, patches.edge_factors, patches.deviation
    return *(array.tobytes() for array in arrays), mesh.achieved


def ground_of(make=rough) -> tl.Heightmap:
    return make(130, 110, spacing=30.0, origin=(500_000.0, 4_000_000.0))


def together(*works):
    """Run each of `works` in a thread of its own, all begun at once, and return what they give."""
    begin = Barrier(len(works))

    def run(work):
        begin.wait()
        return work()

    with ThreadPoolExecutor(len(works)) as pool:
        return [future.result() for future in [pool.submit(run, work) for work in works]]


# what is made when the first mesh wants it
ONCE = {"tree", "control_points"}


@pytest.mark.parametrize("make", [rough, holed])
def test_two_threads_on_one_terrain_find_what_one_finds(make) -> None:
    ground = ground_of(make)
    asked = [(camera, lod) for camera in cameras_over(ground, 4) for lod in LODS]
    alone = tl.Terrain(ground)
    expected = [alone.mesh(camera, lod=lod) for camera, lod in asked]

    def meshes(terrain: tl.Terrain, order: int):
        found = {}
        for index in range(len(asked))[::order]:
            camera, lod = asked[index]
            begin = perf_counter()
            found[index] = terrain.mesh(camera, lod=lod), perf_counter() - begin
        return found

    # two on one terrain, a third beside them on the same device
    shared, other = tl.Terrain(ground), tl.Terrain(ground)
    threads = together(
        partial(meshes, shared, 1), partial(meshes, shared, -1), partial(meshes, other, 1)
    )
    for found in threads:
        for index, one in enumerate(expected):
            mesh, wall = found[index]
            assert bits(mesh) == bits(one), asked[index]
            # its own launches, each once: no more time than there was
            assert mesh.timings.keys() - ONCE == one.timings.keys() - ONCE
            assert 0 < sum(mesh.timings.values()) < wall
    # the first to want the quadtree makes it, for both
    made = ["tree" in found[i][0].timings for found in threads[:2] for i in found]
    assert sum(made) == 1


def test_heights_and_rays_are_those_of_one_thread() -> None:
    ground = ground_of()
    random = np.random.default_rng(0)
    points = random.uniform((0, -3870), (3270, 0), (500, 2)) + ground.origin
    eye = (*np.add(ground.origin, (1600, -1900)), ground.height_range[1] + 200)
    ways = random.normal(size=(500, 3)) - (0, 0, 1)
    terrain = tl.Terrain(ground)
    heights, hits = terrain.height_at(points), terrain.cast(eye, ways)

    def ask():
        return [(terrain.height_at(points), terrain.cast(eye, ways).position) for _ in range(5)]

    for found in together(ask, ask):
        for got, positions in found:
            np.testing.assert_array_equal(got, heights)
            np.testing.assert_array_equal(positions, hits.position)


@pytest.mark.parametrize("lod", [tl.MaxErrorLod(3.0), tl.UniformLod(4.5)], ids=repr)
def test_an_update_is_seen_whole_or_not_at_all(lod) -> None:
    ground = ground_of()
    terrain = tl.Terrain(ground)
    before = ground.elevation[PART]
    after = before + np.random.default_rng(1).normal(scale=200, size=before.shape)
    expected = {}
    for heights in (after, before):
        terrain.update(*PART, heights)
        expected[bits(terrain.mesh(lod=lod))] = heights is after

    seen = Event()

    def update():
        while not seen.is_set():
            terrain.update(*PART, after)
            terrain.update(*PART, before)

    def look():
        try:
            return [bits(terrain.mesh(lod=lod)) for _ in range(40)]
        finally:
            seen.set()

    _, found = together(update, look)
    assert set(found) <= expected.keys()
    assert not expected[bits(terrain.mesh(lod=lod))]


def test_two_threads_that_update_both_do() -> None:
    terrain = tl.Terrain(ground_of())
    terrain.mesh(lod=tl.MaxErrorLod(3.0))

    def fill(rows: slice, value: float):
        for column in range(0, 100, 10):
            terrain.update(rows, slice(column, column + 10), np.full((20, 10), value))

    together(partial(fill, slice(0, 20), 7.0), partial(fill, slice(10, 30), 7.0))
    assert (terrain.ground.elevation[:30, :100] == 7.0).all()
    anew = tl.Terrain(terrain.ground)
    lod = tl.MaxErrorLod(1.0)
    assert bits(terrain.mesh(lod=lod)) == bits(anew.mesh(lod=lod))
