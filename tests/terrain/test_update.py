"""Ground that moves: a terrain that was updated is, to the bit, a terrain made anew."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import terrain_lod as tl
from support.anew import assert_as_made_anew, everything
from support.grounds import holed, rough
from terrain_lod.ground.grid import TileGrid

ORIGIN = (500_000.0, 4_000_000.0)


@st.composite
def updates(draw: st.DrawFn, rows: int = 66, columns: int = 50) -> tuple[slice, slice, np.ndarray]:
    first, left = draw(st.integers(0, rows - 1)), draw(st.integers(0, columns - 1))
    last, right = draw(st.integers(first + 1, rows)), draw(st.integers(left + 1, columns))
    random = np.random.default_rng(draw(st.integers(0, 99)))
    heights = random.normal(scale=300, size=(last - first, right - left))
    heights[random.random(heights.shape) < draw(st.sampled_from([0, 0, 0.1]))] = np.nan
    return slice(first, last), slice(left, right), heights


@settings(max_examples=15, deadline=None)
@given(update=updates(), make=st.sampled_from([rough, holed]), tile=st.sampled_from([7, 15, 31]))
def test_updated_is_made_anew(update, make, tile: int) -> None:
    terrain = tl.Terrain(make(66, 50, spacing=30.0, origin=ORIGIN), tile=tile)
    everything(terrain)  # the ladder exists, and must follow
    terrain.scene  # noqa: B018
    count = terrain.update(*update)
    assert_as_made_anew(terrain, tile=tile)
    rows, columns, heights = update
    assert count == len(touched(terrain.grid, rows, columns))
    found = terrain.ground.elevation[rows, columns]
    np.testing.assert_allclose(found, heights, rtol=1e-6, atol=1e-4)


def touched(grid: TileGrid, rows: slice, columns: slice) -> list[tuple[int, int]]:
    """Return the tiles that hold one of the samples, looked for one by one."""

    def hold(corners: np.ndarray, part: slice) -> list[int]:
        samples = set(range(part.start, part.stop))
        return [
            tile
            for tile in range(len(corners) - 1)
            if samples & set(range(corners[tile], corners[tile + 1] + 1))
        ]

    return [
        (row, column)
        for row in hold(grid.corner_rows, rows)
        for column in hold(grid.corner_columns, columns)
    ]


@pytest.mark.parametrize("plane", ["least_squares", "corners"])
def test_many_small_updates_one_after_the_other(plane: str) -> None:
    terrain = tl.Terrain(rough(66, 50), plane=plane)
    random = np.random.default_rng(0)
    for _ in range(20):
        row, column = random.integers(0, 60), random.integers(0, 45)
        terrain.update(
            slice(row, row + 5), slice(column, column + 4), random.normal(size=(5, 4)) * 50
        )
    assert_as_made_anew(terrain, plane=plane)


def test_inside_a_tile_one_is_touched_and_on_a_corner_four() -> None:
    terrain = tl.Terrain(rough(61, 61), tile=15)
    one = np.ones((1, 1))
    assert terrain.update(slice(7, 8), slice(20, 21), one) == 1
    assert terrain.update(slice(15, 16), slice(20, 21), one) == 2
    assert terrain.update(slice(15, 16), slice(30, 31), one) == 4
    assert terrain.update(slice(None), slice(None), np.ones((61, 61))) == 16


def test_ground_gains_its_first_hole_and_loses_its_last() -> None:
    before = rough(61, 61, base=100.0)
    terrain = tl.Terrain(before)
    part = slice(20, 23), slice(31, 33)
    terrain.update(*part, np.full((3, 2), np.nan))
    assert terrain.ground.mask is not None
    assert terrain.ground.mask.sum() == 6
    assert before.mask is None
    assert_as_made_anew(terrain)
    mesh = terrain.mesh(lod=tl.MaxErrorLod(1.0))
    assert tl.vertical_error(mesh, terrain.ground).maximum <= 1.0
    terrain.update(*part, before.elevation[part])
    assert terrain.ground.mask is None
    np.testing.assert_array_equal(terrain.ground.heights, before.heights)
    assert_as_made_anew(terrain)


def test_the_mesh_follows_the_ground_and_stays_whole() -> None:
    terrain = tl.Terrain(rough(66, 50, spacing=30.0, origin=ORIGIN))
    terrain.mesh(lod=tl.MaxErrorLod(3.0))
    terrain.update(slice(10, 40), slice(12, 33), np.random.default_rng(5).normal(size=(30, 21)))
    mesh = terrain.mesh(lod=tl.MaxErrorLod(3.0))
    assert tl.vertical_error(mesh, terrain.ground).maximum <= 3.0
    assert not tl.crack_report(mesh)


def test_masked_elements_and_whole_numbers_are_taken() -> None:
    terrain = tl.Terrain(rough(31, 31))
    given_heights = np.ma.masked_equal(np.array([[1, 2], [3, -9]]), -9)
    terrain.update(slice(0, 2), slice(0, 2), given_heights)
    elevation = terrain.ground.elevation[:2, :2]
    np.testing.assert_array_equal(elevation, [[1, 2], [3, np.nan]])


@pytest.mark.parametrize(
    ("rows", "columns", "heights", "message"),
    [
        (slice(30, 32), slice(0, 1), np.ones((2, 1)), r"rows within slice\(0, 31\), got slice\(30"),
        (slice(0, 1), slice(-2, 3), np.ones((1, 5)), "columns within"),
        (slice(0, 9, 2), slice(0, 1), np.ones((5, 1)), "rows within"),
        (slice(5, 5), slice(0, 1), np.ones((0, 1)), "rows within"),
        (3, slice(0, 1), np.ones((1, 1)), "a slice for rows, got 3"),
        (slice(0, 2), slice(0, 2), np.ones((2, 3)), r"shape \(2, 2\), got \(2, 3\)"),
        (slice(0, 1), slice(0, 2), [[1.0, -np.inf]], "finite heights, got -inf"),
        (slice(0, 1), slice(0, 1), [[1e39]], "float32"),
        (slice(0, 1), slice(0, 1), [["high"]], "heights as real numbers"),
        (slice(None), slice(None), np.full((31, 31), np.nan), "data to be left"),
    ],
)
def test_a_wrong_update_is_one_clear_line_and_changes_nothing(
    rows, columns, heights, message: str
) -> None:
    terrain = tl.Terrain(rough(31, 31))
    before, ground = everything(terrain), terrain.ground
    with pytest.raises(tl.InputError, match=message) as error:
        terrain.update(rows, columns, heights)
    assert "\n" not in str(error.value)
    assert terrain.ground is ground
    for name, values in everything(terrain).items():
        np.testing.assert_array_equal(values, before[name])


@pytest.mark.slow
def test_an_update_that_the_device_has_no_room_for_changes_nothing() -> None:
    device = tl.Device(tl.Device.open().queue.device)  # one of the test's own, to be filled
    terrain = tl.Terrain(rough(130, 110), tile=15, device=device)
    lod = tl.MaxErrorLod(1.0)
    before, ground, mesh = everything(terrain), terrain.ground, terrain.mesh(lod=lod)
    part = slice(40, 60), slice(35, 70)
    heights = np.full((20, 35), np.nan)  # the first holes: more arrays are new
    refused = []
    for spare in range(0, 2**20, 2**9):  # fails at the first array, at the second ...
        hog = hogged(device, spare)
        try:
            terrain.update(*part, heights)
            break
        except tl.DeviceMemoryError as error:
            refused.append(str(error))
        finally:
            hog.clear()
        assert terrain.ground is ground
        for name, values in everything(terrain).items():
            np.testing.assert_array_equal(values, before[name])
        again = terrain.mesh(lod=lod)
        np.testing.assert_array_equal(again.vertices, mesh.vertices)
    # copies of what would be overwritten, holes, and control points when heights were new already
    for shape in ("(20, 110)", "(18, 8, 8)", "(130, 110)", "(10, 10, 4)"):
        assert any(f"array of {shape}" in line for line in refused), shape
    assert_as_made_anew(terrain, tile=15)
    assert terrain.ground.mask.sum() == heights.size


def hogged(device: tl.Device, spare: int) -> list[object]:
    """Allocate all of a device's memory but `spare` bytes."""
    arrays = []
    while (left := device.info.memory - device.allocated - spare) > 0:
        arrays.append(device.empty(min(left, device.info.largest_buffer), np.uint8))
    return arrays
