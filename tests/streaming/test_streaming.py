"""A terrain over a pyramid keeps what it promises, has no cracks, and holds a bounded part."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest

import terrain_lod as tl
from support.pyramids import rugged

pytest.importorskip("zarr")

CHUNK = 32
# no multiple of any level's step: coarse levels reach beyond the raster
SHAPE = 150, 203


def heights(holes: bool = False) -> np.ndarray[tuple[int, int], np.dtype[np.float32]]:
    found = rugged(*SHAPE) * 10
    if holes:
        found[60:75, 100:140] = np.nan
        found[:4, :4] = np.nan
    return found


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("pyramids") / "a.tlod"
    return tl.build(heights(), path, chunk=CHUNK, spacing=30.0)


@pytest.fixture(scope="module")
def ground() -> tl.Heightmap:
    return tl.Heightmap(heights(), spacing=30.0)


@pytest.fixture(scope="module")
def terrain(store: Path) -> tl.StreamingTerrain:
    return tl.open(store, memory="200MB")


@pytest.mark.parametrize("metres", [200.0, 50.0, 10.0, 2.0])
def test_metres_are_kept_at_every_sample(
    terrain: tl.StreamingTerrain, ground: tl.Heightmap, metres: float
) -> None:
    mesh = terrain.mesh(lod=tl.MaxErrorLod(metres))
    assert mesh.achieved is not None
    assert mesh.achieved.kept
    # measured from outside, by code that knows neither levels nor chunks
    worst = tl.vertical_error(mesh, ground)
    assert worst.maximum <= mesh.achieved.metres <= metres
    assert (worst.samples, worst.uncovered) == (ground.heights.size, 0)
    assert not tl.crack_report(mesh)
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    np.testing.assert_allclose((high - low)[:2], ground.extent)


@pytest.mark.slow
@pytest.mark.parametrize("pixels", [3.0, 0.5])
def test_pixels_are_kept_where_levels_meet(
    terrain: tl.StreamingTerrain, ground: tl.Heightmap, pixels: float
) -> None:
    sizes = set()
    for eye in ((3000.0, -5200.0, 1500.0), (500.0, -300.0, 900.0), (3000.0, -2000.0, 9000.0)):
        camera = tl.Camera(eye, (4000.0, -1500.0, 0.0), size=(640, 360))
        mesh = terrain.mesh(camera, lod=tl.ScreenErrorLod(pixels))
        assert mesh.achieved is not None
        assert mesh.achieved.kept
        assert tl.screen_error(mesh, ground, camera).maximum <= pixels
        assert not tl.crack_report(mesh)
        assert mesh.patches is not None
        sizes |= set(mesh.patches.areas[:, 2].tolist())
    assert len(sizes) >= 3


@pytest.mark.slow
def test_it_costs_little_more_than_in_memory(
    terrain: tl.StreamingTerrain, ground: tl.Heightmap
) -> None:
    lod = tl.MaxErrorLod(10.0)
    whole = tl.Terrain(ground, tile=8).mesh(lod=lod, partitioning="integer")
    assert len(terrain.mesh(lod=lod).triangles) < 1.5 * len(whole.triangles)


@pytest.mark.slow
def test_holes_stay_holes(tmp_path: Path) -> None:
    ground = tl.Heightmap(heights(holes=True), spacing=30.0)
    tl.build(heights(holes=True), tmp_path / "a.tlod", chunk=CHUNK, spacing=30.0)
    terrain = tl.open(tmp_path / "a.tlod", memory="200MB")
    mesh = terrain.mesh(lod=tl.MaxErrorLod(20.0))
    assert mesh.achieved is not None
    assert mesh.achieved.kept
    assert tl.vertical_error(mesh, ground).maximum <= 20.0
    assert not tl.crack_report(mesh)
    x, y = 30.0 * 120, -30.0 * 67
    assert np.isnan(terrain.height_at([[x, y]])).all()


@pytest.mark.slow
def test_memory_is_never_passed(store: Path) -> None:
    with pytest.raises(tl.InputError, match=r"expected memory of at least 0\.209 MB"):
        tl.open(store, memory="0.1MB")
    terrain = tl.open(store, memory="0.3MB")
    mesh = terrain.mesh(lod=tl.MaxErrorLod(2.0))
    assert mesh.achieved is not None
    # what is not kept is said, and what was measured holds
    assert not mesh.achieved.kept
    ground = tl.Heightmap(heights(), spacing=30.0)
    assert 2.0 < tl.vertical_error(mesh, ground).maximum <= mesh.achieved.metres
    assert not tl.crack_report(mesh)
    for x in range(0, 6000, 500):
        terrain.mesh(tl.Camera((x, -3000.0, 500.0), (x, 0.0, 0.0)), lod=tl.ScreenErrorLod(5.0))
        assert terrain.held <= terrain.memory


def test_without_waiting_the_nearest_ancestors_answer(store: Path, ground: tl.Heightmap) -> None:
    terrain, lod = tl.open(store, memory="200MB"), tl.MaxErrorLod(5.0)
    first = terrain.mesh(lod=lod, wait=False)
    assert first.achieved is not None
    assert not first.achieved.kept
    assert tl.vertical_error(first, ground).maximum <= first.achieved.metres
    levels = [level for level, _, _ in terrain.missing]
    assert levels
    assert levels == sorted(levels, reverse=True)
    errors = [first.achieved.metres]
    for _ in range(100):
        while terrain.in_flight:
            time.sleep(0.01)
        mesh = terrain.mesh(lod=lod, wait=False)
        assert mesh.achieved is not None
        errors.append(mesh.achieved.metres)
        if mesh.achieved.kept:
            break
    assert not terrain.missing
    assert errors[-1] <= 5.0 < errors[0]


def test_heights_and_rays_are_those_of_the_ground(
    terrain: tl.StreamingTerrain, ground: tl.Heightmap
) -> None:
    whole, random = tl.Terrain(ground), np.random.default_rng(1)
    points = random.uniform((-100, -4600), (6200, 100), (300, 2))
    corners = np.array([[0.0, 0.0], [202 * 30.0, -149 * 30.0], [960.0, -960.0]])
    points = np.concatenate([points, corners])
    np.testing.assert_allclose(
        terrain.height_at(points), whole.height_at(points), rtol=0, atol=1e-6
    )
    starts = random.uniform((-500, -5000, -500), (6500, 500, 2500), (200, 3))
    ways = random.normal(size=(200, 3)) * [1, 1, 0.3]
    ways[:3] = [[0, 0, -1], [1, 0, 0], [0, 1, 0]]
    found, expected = terrain.cast(starts, ways), whole.cast(starts, ways)
    np.testing.assert_array_equal(found.hit, expected.hit)
    assert 30 < found.hit.sum() < 200
    np.testing.assert_allclose(found.position, expected.position, atol=1e-5)
    np.testing.assert_allclose(found.normal, expected.normal, atol=1e-5)


def test_a_camera_on_its_way_is_read_ahead(store: Path) -> None:
    terrain = tl.open(store, memory="200MB")
    for x in (0.0, 400.0):
        camera = tl.Camera((x, -2000.0, 700.0), (x + 500, -2000.0, 300.0), size=(640, 360))
        terrain.mesh(camera)
    while terrain.in_flight:
        time.sleep(0.01)
    ahead = tl.Camera((800.0, -2000.0, 700.0), (1300.0, -2000.0, 300.0), size=(640, 360))
    terrain.mesh(ahead, wait=False)
    assert terrain.missing == ()


def test_a_damaged_chunk_is_named(tmp_path: Path) -> None:
    path = tl.build(heights(), tmp_path / "a.tlod", chunk=CHUNK, spacing=30.0)
    (path / "heights/0/c/0/0/0/0").unlink()
    terrain = tl.open(path, memory="200MB")
    assert terrain.mesh(lod=tl.MaxErrorLod(200.0)).achieved is not None
    with pytest.raises(tl.FileError, match=r"expected heights/0 chunk \[0, 0\]"):
        terrain.height_at([[10.0, -10.0]])


def test_what_is_not_to_be_had_is_said(store: Path, terrain: tl.StreamingTerrain) -> None:
    with pytest.raises(tl.InputError, match="expected MaxErrorLod or ScreenErrorLod"):
        terrain.mesh(lod=tl.UniformLod(3))  # type: ignore[arg-type]
    with pytest.raises(tl.InputError, match="ScreenErrorLod needs a camera"):
        terrain.mesh()
    for wrong in ("lots", "12 XB", ""):
        with pytest.raises(tl.InputError, match='memory such as "512MB"'):
            tl.open(store, memory=wrong)
    assert tl.open(store, memory="1.5 GB").memory == 1_500_000_000
    assert tl.open(store, memory=10**9).memory == 10**9
