"""Windows of a source are what `load` has of the whole, whatever the source is."""

from __future__ import annotations

import pickle
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import terrain_lod as tl
from terrain_lod.sources.opening import source_of
from terrain_lod.sources.source import Source

rasterio = pytest.importorskip("rasterio")

SHAPE = 70, 53


def at(x: float, y: float = 5_400_000, step: float = 30) -> Any:
    return rasterio.Affine(step, 0, x, 0, -step, y)


def write(path: Path, values: npt.NDArray[Any], **profile: Any) -> Path:
    kept = {"driver": "GTiff", "count": 1, "dtype": values.dtype, "crs": "EPSG:25832",
            "transform": at(500_000)}  # fmt: skip
    rows, columns = values.shape
    with rasterio.open(path, "w", height=rows, width=columns, **(kept | profile)) as file:
        file.write(values, 1)
    return path


def heights(dtype: npt.DTypeLike = "int16") -> npt.NDArray[Any]:
    values = np.random.default_rng(5).integers(100, 2000, SHAPE)
    values[10:20, 40:] = -9999
    return values.astype(dtype)


def window(source: Source, top: int, left: int, rows: int, columns: int) -> npt.NDArray[Any]:
    return source.read(slice(top, top + rows), slice(left, left + columns))


def require_like_load(source: Source, ground: tl.Heightmap) -> None:
    reading = source.reading
    assert source.shape == ground.shape
    assert (reading.spacing, reading.origin) == (ground.spacing, ground.origin)
    assert (reading.crs, reading.units) == (ground.crs, ground.units)
    for sent in (source, pickle.loads(pickle.dumps(source))):
        for top, left, rows, columns in ((0, 0, *SHAPE), (7, 30, 20, 23), (68, 51, 2, 2)):
            found = window(sent, top, left, rows, columns)
            whole = ground.elevation[top : top + rows, left : left + columns]
            np.testing.assert_array_equal(found, whole)


@pytest.mark.parametrize("south_up", [False, True])
def test_geotiff(tmp_path: Path, south_up: bool) -> None:
    step = 30 if south_up else -30
    transform = rasterio.Affine(30, 0, 500_000, 0, step, 5_400_000)
    path = write(tmp_path / "a.tif", heights(), nodata=-9999, transform=transform)
    require_like_load(source_of(path), tl.load(path))


def test_units_scales_and_floats(tmp_path: Path) -> None:
    path = write(tmp_path / "a.tif", heights("float64"), nodata=-9999, crs="EPSG:2263")
    with rasterio.open(path, "r+") as file:
        file.scales, file.offsets, file.units = [0.5], [100.0], ["m"]
    source, ground = source_of(path), tl.load(path)
    assert not source.is_exact
    assert ground.units == ("US survey foot", "US survey foot")
    found = window(source, 0, 0, *SHAPE)
    np.testing.assert_allclose(found, ground.elevation, atol=1e-3)


def test_degrees_are_scaled_by_the_whole(tmp_path: Path) -> None:
    transform = at(10, 47, 0.001)
    path = write(tmp_path / "a.tif", heights(), crs="EPSG:4326", transform=transform, nodata=-9999)
    require_like_load(source_of(path), tl.load(path))


def test_overviews_are_not_read(tmp_path: Path) -> None:
    path = write(tmp_path / "a.tif", heights(), nodata=-9999, tiled=True, blockxsize=16,
                 blockysize=16)  # fmt: skip
    with rasterio.open(path, "r+") as file:
        file.build_overviews([2, 4], rasterio.enums.Resampling.average)
    require_like_load(source_of(path), tl.load(path))


def test_arrays_on_disk_and_images(tmp_path: Path) -> None:
    values = heights()
    np.save(tmp_path / "a.npy", values)
    ground = tl.Heightmap(values, spacing=2.0, name="a")
    require_like_load(source_of(tmp_path / "a.npy", spacing=2.0), ground)
    require_like_load(source_of(np.load(tmp_path / "a.npy", mmap_mode="r"), spacing=2.0), ground)
    require_like_load(source_of(ground), ground)


def test_a_map_is_not_sent_with_what_it_shows(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", np.zeros((1000, 1000), np.float32))
    source = source_of(np.load(tmp_path / "a.npy", mmap_mode="r"), spacing=2.0)
    assert len(pickle.dumps(source)) < 2000


def test_labelled_arrays() -> None:
    xarray = pytest.importorskip("xarray")
    values = heights("float32")
    values[values == -9999] = np.nan
    rows, columns = SHAPE
    # from south to north
    place = {"y": 5_000_000 + 30.0 * np.arange(rows), "x": 500_000 + 30.0 * np.arange(columns)}
    array = xarray.DataArray(values[::-1], place, ["y", "x"], name="dem", attrs={"units": "m"})
    ground = tl.Heightmap(
        values, spacing=30.0, origin=(500_000, 5_000_000 + 30.0 * (rows - 1)), name="dem"
    )
    require_like_load(source_of(array), ground)
    pytest.importorskip("dask.array")
    require_like_load(source_of(array.chunk({"y": 16, "x": 16})), ground)
    with pytest.raises(tl.InputError, match="even steps along x"):
        source_of(array.assign_coords(x=array.x**2))


def test_a_folder_of_tiles_is_one_raster(tmp_path: Path) -> None:
    values = heights("float32")
    whole = tl.load(write(tmp_path / "whole.tif", values, nodata=-9999))
    folder = tmp_path / "tiles"
    folder.mkdir()
    for row in (0, 30, 60):
        for column in (0, 25):
            # each with a nodata value of its own, overlapping to the east
            part = values[row : row + 30, column : column + 40].copy()
            part[part == -9999] = -1000 - row
            place = at(500_000 + 30 * column, 5_400_000 - 30 * row)
            write(folder / f"{row}_{column}.tif", part, nodata=-1000 - row, transform=place)
    require_like_load(source_of(folder), whole)


def test_tiles_that_do_not_fit_are_one_line(tmp_path: Path) -> None:
    def pair(**other: Any) -> Path:
        for number, more in enumerate(({}, other)):
            write(tmp_path / f"{number}.tif", heights("float32"), **more)
        return tmp_path

    east = 500_000 + 30 * SHAPE[1]
    assert source_of(pair(transform=at(east))).shape == (SHAPE[0], 2 * SHAPE[1])
    for more, said in (
        ({"crs": None, "transform": at(east)}, "0.tif with one and 1.tif without"),
        (
            {"crs": "EPSG:25833", "transform": at(east)},
            "0.tif in EPSG:25832 and 1.tif in EPSG:2583",
        ),
        ({"transform": at(east + 7)}, "1.tif, which is off that of 0.tif by 0.23 of a cell"),
        ({"transform": at(east + 3000)}, "1.tif, which lies apart from 0.tif"),
    ):
        with pytest.raises(tl.InputError, match=said):
            source_of(pair(**more))


def test_a_fingerprint_tells_sources_apart(tmp_path: Path) -> None:
    path = write(tmp_path / "a.tif", heights("float32"))
    first = source_of(path).fingerprint()
    assert first == source_of(path).fingerprint()
    assert first != source_of(path, nodata=7).fingerprint()
    write(path, heights("float32") + 1)
    assert first != source_of(path).fingerprint()


def test_others_are_refused(tmp_path: Path) -> None:
    for wrong, said in (
        (7, "expected a file, a folder of tiles, an array or a Heightmap, got 7"),
        (np.zeros(5), "at least 2 x 2"),
        (tmp_path, "expected rasters in the folder"),
        (tmp_path / "none.tif", "got nothing at"),
    ):
        with pytest.raises(tl.TerrainError, match=said):
            source_of(wrong)
    infinite = np.zeros(SHAPE, np.float32)
    infinite[40, 3] = np.inf
    with pytest.raises(tl.InputError, match=r"got inf at \[40, 3\]"):
        source_of(infinite, spacing=1.0).read(slice(35, 50), slice(0, 9))
