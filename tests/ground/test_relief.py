"""Ground with detail: nowhere stored, and to the bit what the stored sum would be."""

from __future__ import annotations

import numpy as np
import pytest

import terrain_lod as tl
from support.anew import assert_as_made_anew, everything
from support.grounds import holed, rough
from terrain_lod.ground.grid import TileGrid
from terrain_lod.ground.relief import Relief
from terrain_lod.reference.ground import relief as reference

SPACING, ORIGIN = (30.0, 20.0), (500_000.0, 4_000_000.0)
STEPS = [(1, 1), (3, 2), (8, 5)]
GROUNDS = {"rough": rough, "holed": holed}


def ground_of(make: str = "rough", rows: int = 45, columns: int = 38) -> tl.Heightmap:
    return GROUNDS[make](rows, columns, spacing=SPACING, origin=ORIGIN)


def detail_of(steps: tuple[int, int], rows: int = 13, columns: int = 17) -> tl.Heightmap:
    """Return detail with a base of its own, that divides neither tiles nor cells."""
    heights = np.random.default_rng(1).normal(size=(rows, columns)) * 3 + 1000.5
    return tl.Heightmap(heights, spacing=(SPACING[0] / steps[0], SPACING[1] / steps[1]))


def camera_over(ground: tl.Heightmap) -> tl.Camera:
    x, y, z = ground.centre
    return tl.Camera((x - 300, y - 400, z + 200), (x, y, z), size=(1280, 720))


def test_a_small_sum_by_hand() -> None:
    #   0 . 4         0 2 4           0 1 repeats         0 3 4
    #   . . .   is    4 6 8   plus    2 3          is     6 9 10
    #   8 . 12        8 10 12                             8 11 12
    ground = tl.Heightmap([[0, 4], [8, 12]], spacing=(2, 6), origin=(7, 9), base=100, crs="EPSG:1")
    found = ground.with_detail(tl.Heightmap([[0, 1], [2, 3]], spacing=(1, 3), base=5))
    np.testing.assert_array_equal(found.heights, [[0, 3, 4], [6, 9, 10], [8, 11, 12]])
    assert (found.spacing, found.origin, found.base) == ((1, 3), (7, 9), 105)
    assert (found.crs, found.mask) == ("EPSG:1", None)


def test_detail_begins_again_after_its_last_sample() -> None:
    detail = tl.Heightmap(np.arange(6).reshape(2, 3), spacing=0.5)
    found = tl.Heightmap(np.zeros((5, 6))).with_detail(detail)
    np.testing.assert_array_equal(found.heights, np.tile(detail.heights, (5, 4))[:9, :11])


@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("make", GROUNDS)
def test_the_sum_is_that_of_the_reference(make: str, steps: tuple[int, int]) -> None:
    ground, detail = ground_of(make), detail_of(steps)
    found = ground.with_detail(detail)
    expected = reference.elevations(ground, detail, steps)
    assert found.shape == expected.shape
    # four roundings in float32, of heights up to some thousands
    tolerance = 4 * np.spacing(np.float32(np.abs(ground.heights).max()))
    np.testing.assert_allclose(found.elevation, expected, rtol=0, atol=tolerance)


@pytest.mark.slow
@pytest.mark.parametrize("steps", STEPS)
@pytest.mark.parametrize("tile", [4, 15, 31])
@pytest.mark.parametrize("make", GROUNDS)
def test_nothing_tells_it_from_the_stored_sum(make: str, tile: int, steps: tuple[int, int]) -> None:
    ground, detail = ground_of(make), detail_of(steps)
    stored = ground.with_detail(detail)
    found, expected = tl.Terrain(ground, detail=detail, tile=tile), tl.Terrain(stored, tile=tile)
    assert (found.scene, found.origin, found.grid) == (
        expected.scene,
        expected.origin,
        expected.grid,
    )
    wanted = everything(expected)
    for name, values in everything(found).items():
        if name not in ("heights", "holes"):
            np.testing.assert_array_equal(values, wanted[name], err_msg=name)
    camera = camera_over(stored)
    for lod in (tl.CoplanarityLod(), tl.UniformLod(5.5), tl.MaxErrorLod(2), tl.ScreenErrorLod(3)):
        mesh, other = found.mesh(camera, lod=lod), expected.mesh(camera, lod=lod)
        for part in ("vertices", "normals", "triangles", "origin"):
            values, others = getattr(mesh, part), getattr(other, part)
            np.testing.assert_array_equal(values.view(np.uint8), others.view(np.uint8), part)
        assert mesh.achieved == other.achieved


def test_a_group_of_items_finds_the_samples_of_a_tile_together(monkeypatch) -> None:
    ground, detail = ground_of("holed"), detail_of((3, 2))
    found, expected = (
        tl.Terrain(ground, detail=detail, levels=1),
        tl.Terrain(ground.with_detail(detail), levels=1),
    )
    # PoCL's compiler does not survive groups in the kernels of the analysis and of quadtrees
    monkeypatch.setattr(tl.Device, "group_size", lambda self, wanted=64: wanted)
    lod = tl.MaxErrorLod(2.0)
    mesh, other = (each.mesh(lod=lod, partitioning="fractional_odd") for each in (found, expected))
    assert mesh.achieved == other.achieved
    np.testing.assert_array_equal(mesh.vertices, other.vertices)


@pytest.mark.parametrize("make", GROUNDS)
def test_the_error_promised_is_that_of_the_sum(make: str) -> None:
    ground, detail = ground_of(make, 60, 60), detail_of((3, 2))
    stored = ground.with_detail(detail)
    terrain = tl.Terrain(ground, detail=detail)
    for metres in (0.01, 1.0, 5.0):
        mesh = terrain.mesh(lod=tl.MaxErrorLod(metres))
        error = tl.vertical_error(mesh, stored)
        assert error.maximum <= mesh.achieved.metres <= metres
        assert not tl.crack_report(mesh)
    camera = camera_over(stored)
    mesh = terrain.mesh(camera, lod=tl.ScreenErrorLod(1.0))
    assert mesh.achieved.kept
    assert not tl.screen_error(mesh, stored, camera).maximum > 1.0
    mesh = terrain.mesh(lod=tl.BudgetLod(25_000))
    assert len(mesh.triangles) <= 25_000
    assert tl.vertical_error(mesh, stored).maximum <= mesh.achieved.metres


@pytest.mark.slow
def test_detail_alone_is_detail_that_is_meshed() -> None:
    flat = tl.Heightmap(np.zeros((20, 20)), spacing=4.0)
    bumps = tl.Heightmap(np.random.default_rng(2).normal(size=(16, 16)), spacing=1.0)
    assert len(tl.Terrain(flat).mesh(lod=tl.MaxErrorLod(0.5)).triangles) == 2
    mesh = tl.Terrain(flat, detail=bumps).mesh(lod=tl.MaxErrorLod(0.5))
    assert np.ptp(mesh.vertices[:, 2]) > 3


@pytest.mark.parametrize("make", GROUNDS)
def test_updates_reach_as_far_as_the_detail_of_their_neighbours(make: str) -> None:
    ground, detail = ground_of(make), detail_of((3, 2))
    terrain = tl.Terrain(ground, detail=detail, tile=7)
    everything(terrain)  # the ladder exists, and must follow
    for rows, columns in (
        # the last samples that change are the first of another tile: 2 * 18 - 1, 3 * 12 - 1
        (slice(17, 18), slice(9, 12)),
        (slice(0, 3), slice(0, 1)),
        (slice(44, 45), slice(30, 38)),
    ):
        before = terrain.ground.with_detail(detail)
        heights = before.base + np.random.default_rng(3).normal(
            size=(rows.stop - rows.start, columns.stop - columns.start)
        )
        heights.flat[1:2] = np.nan
        count = terrain.update(rows, columns, heights)
        after = terrain.ground.with_detail(detail)
        changed = np.argwhere((before.heights != after.heights) | (before.valid != after.valid))
        (top, left), (bottom, right) = changed.min(axis=0), changed.max(axis=0)
        touched = TileGrid.of(after, 7).touching(slice(top, bottom + 1), slice(left, right + 1))
        assert count == len(touched)
        assert_as_made_anew(terrain, detail=detail, tile=7)
    assert terrain.detail is detail


@pytest.mark.parametrize("make", GROUNDS)
def test_questions_are_answered_by_the_sum(make: str) -> None:
    ground, detail = ground_of(make), detail_of((8, 5))
    stored = ground.with_detail(detail)
    found, expected = tl.Terrain(ground, detail=detail), tl.Terrain(stored)
    (x, y), (width, depth) = ORIGIN, stored.extent
    points = np.random.default_rng(4).uniform((x - 9, y - depth - 9), (x + width + 9, y), (500, 2))
    np.testing.assert_array_equal(found.height_at(points), expected.height_at(points))
    origins = np.column_stack([points, np.full(500, 3000.0)])
    hits, others = (terrain.cast(origins, [(0.1, 0.2, -1)]) for terrain in (found, expected))
    for part in ("position", "distance", "tile", "normal"):
        np.testing.assert_array_equal(getattr(hits, part), getattr(others, part))


def test_the_device_holds_the_parts_not_the_sum() -> None:
    device = tl.Device.open()
    ground, detail = ground_of(rows=100, columns=100), detail_of((8, 8))
    sizes = {}
    for name, make in (
        ("parts", lambda: tl.Terrain(ground, detail=detail)),
        ("sum", lambda: tl.Terrain(ground.with_detail(detail))),
    ):
        before = device.allocated
        terrain = make()
        sizes[name] = device.allocated - before
        assert terrain.grid.rows == 99 * 8 + 1
        del terrain
    heights = 4 * (99 * 8 + 1) ** 2
    assert sizes["sum"] - sizes["parts"] == heights - ground.heights.nbytes - detail.heights.nbytes


def holes_in(detail: tl.Heightmap) -> tl.Heightmap:
    heights = detail.heights.copy()
    heights[2, 3:5] = np.nan
    return tl.Heightmap(heights, spacing=detail.spacing)


@pytest.mark.parametrize(
    ("detail", "message"),
    [
        (np.zeros((5, 5)), "a Heightmap for detail, got an array of shape"),
        (tl.Heightmap(np.zeros((4, 4)), spacing=(7, 20)), r"spacing divides .* 30 x 20, .* 7 x 20"),
        (tl.Heightmap(np.zeros((4, 4)), spacing=(10, 40)), "got 10 x 40"),
        (tl.Heightmap(np.zeros((4, 4)), spacing=(30, 20.1)), "got 30 x 20.1"),
        (holes_in(detail_of((3, 2))), "data everywhere, got 2 of 221 samples without"),
        (
            tl.Heightmap(np.zeros((4, 4)), spacing=(10, 10), crs="EPSG:2056"),
            r"ground's \(None\), got EPSG:2056",
        ),
    ],
)
def test_detail_of_the_wrong_kind_is_one_clear_line(detail: object, message: str) -> None:
    ground = ground_of()
    for use in (lambda: tl.Terrain(ground, detail=detail), lambda: ground.with_detail(detail)):
        with pytest.raises(tl.InputError, match=message) as error:
            use()
        assert "\n" not in str(error.value)


def test_a_terrain_says_that_it_has_detail() -> None:
    terrain = tl.Terrain(ground_of(), detail=detail_of((3, 2)))
    assert "detail=Heightmap(13 x 17" in repr(terrain)
    assert "13 × 17" in terrain._repr_html_()


def test_more_samples_than_can_be_numbered_are_refused() -> None:
    ground = tl.Heightmap(np.zeros((2, 2)), spacing=1e6)
    for step in (1.0, 1e-5):
        with pytest.raises(tl.InputError, match="use larger tiles, a smaller raster or coarser"):
            tl.Terrain(ground, detail=tl.Heightmap(np.ones((2, 2)), spacing=step))


def test_sums_beyond_float32_are_refused() -> None:
    ground, detail = (
        tl.Heightmap(np.array([[high, -high], [0, 0]], np.float32)) for high in (1e38, 1.5e38)
    )
    with pytest.raises(tl.InputError, match=r"float32 can hold, got heights up to 1e\+38 and 1.5e"):
        ground.with_detail(detail)


def test_an_update_beyond_float32_with_its_detail_changes_nothing() -> None:
    ground, detail = ground_of(), detail_of((3, 2))
    terrain = tl.Terrain(ground, detail=detail)
    with pytest.raises(tl.InputError, match="float32 can hold"):
        terrain.update(slice(0, 1), slice(0, 1), [[2e38]])
    assert terrain.ground is ground
    assert_as_made_anew(terrain, detail=detail)


def test_a_spacing_that_a_file_rounded_still_divides() -> None:
    ground = tl.Heightmap(np.zeros((3, 3)), spacing=10.0)
    detail = tl.Heightmap(np.zeros((3, 3)), spacing=3.3333333)
    assert Relief(ground, detail).steps == (3, 3)
    # the ground stays where it is
    assert ground.with_detail(detail).extent == ground.extent
