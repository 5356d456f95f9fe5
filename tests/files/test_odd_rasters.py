"""Odd rasters against GDAL's own reading: value, mask, orientation, spacing and origin."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from rasterio.enums import ColorInterp
from rasterio.transform import Affine
from rasterio.warp import transform as warp

from support.odd_rasters import ODD
from terrain_lod.errors import InputError, MissingExtraError
from terrain_lod.files.rasters import readers_gdal
from terrain_lod.files.rasters.loading import load
from terrain_lod.ground.heightmap import Heightmap

FOOT, SURVEY_FOOT = 0.3048, 1200 / 3937
BAND_UNITS = {"ft": FOOT, "foot": FOOT, "US survey foot": SURVEY_FOOT, "cm": 0.01, "metre": 1.0,
              "m": 1.0, "fathom": 1.8288, "km": 1000.0}  # fmt: skip


@dataclass(frozen=True)
class Reading:
    """What GDAL says: metres, and where row 0 is north."""

    heights: np.ndarray
    valid: np.ndarray
    transform: Affine  # of the middles of cells
    crs: Any


def source_of(path: Path) -> str:
    if path.suffix == ".zip":
        return f"/vsizip/{path}/inside/dem.tif"
    return f"/vsigzip/{path}" if path.suffix == ".gz" else str(path)


def by_gdal(path: Path, told: dict[str, Any]) -> Reading:
    """Read a file by rasterio alone, by other means than `load`: a whole band, then its part."""
    level = {} if "overview" not in told else {"overview_level": told["overview"]}
    with rasterio.open(source_of(path), **level) as file:
        band = told.get("band", 1)
        raw = file.read(band, masked=True)
        heights = np.ma.getdata(raw).astype(np.float64)
        valid = ~np.ma.getmaskarray(raw) & ~np.isnan(heights)
        for alpha, use in enumerate(file.colorinterp, 1):
            if use == ColorInterp.alpha:
                valid &= file.read(alpha) > 0
        metres = BAND_UNITS.get(file.units[band - 1] or "")
        if metres is None:
            metres = file.crs.linear_units_factor[1] if file.crs and file.crs.is_projected else 1.0
            metres = metres if "US" in (file.crs.linear_units if file.crs else "") else 1.0
        with np.errstate(over="ignore"):
            heights = (heights * file.scales[band - 1] + file.offsets[band - 1]) * metres
        transform = file.transform @ Affine.translation(0.5, 0.5)
        crs = file.crs
    rows, columns = np.arange(len(heights)), np.arange(heights.shape[1])
    if "window" in told:
        column, row, width, height = told["window"]
        rows, columns = rows[row : row + height], columns[column : column + width]
    if "bounds" in told:
        west, south, east, north = told["bounds"]
        x, y = transform.c + transform.a * columns, transform.f + transform.e * rows
        columns, rows = columns[(x >= west) & (x <= east)], rows[(y >= south) & (y <= north)]
    heights, valid = heights[np.ix_(rows, columns)], valid[np.ix_(rows, columns)]
    transform = transform @ Affine.translation(columns[0], rows[0])
    if transform.e > 0:
        heights, valid = heights[::-1], valid[::-1]
        transform = transform @ Affine.translation(0, len(rows) - 1) @ Affine.scale(1, -1)
    return Reading(heights, valid, transform, crs)


def true_spacing(reading: Reading) -> tuple[float, float]:
    """Return metres between samples in the middle, along a great circle of PROJ's."""
    rows, columns = np.array(reading.heights.shape) / 2 - 0.5
    points = [reading.transform @ (columns + dx, rows + dy) for dx, dy in
              ((-0.5, 0), (0.5, 0), (0, -0.5), (0, 0.5))]  # fmt: skip
    # about the middle, a projection true to scale there
    x, y = reading.transform @ (columns, rows)
    (longitude,), (latitude,) = warp(reading.crs, geographic_of(reading.crs), [x], [y])
    scale = 0.9 if "4807" in str(reading.crs.to_authority()) else 1.0
    radii = "+R=3396190" if "3396190" in reading.crs.to_wkt() else "+ellps=WGS84"
    flat = f"+proj=aeqd +lat_0={latitude * scale} +lon_0={longitude * scale} {radii}"
    there = np.array(warp(reading.crs, flat, *map(list, zip(*points, strict=True))))
    return float(np.hypot(*(there[:, 1] - there[:, 0]))), float(
        np.hypot(*(there[:, 3] - there[:, 2]))
    )


def geographic_of(crs: Any) -> Any:
    return crs if crs.is_geographic else rasterio.CRS.from_epsg(4326)


def loaded(path: Path, told: dict[str, Any]) -> Heightmap:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        return load(path, **told)


@pytest.mark.parametrize("name", ODD)
def test_agrees_with_gdal(tmp_path: Path, name: str) -> None:
    make, told = ODD[name]
    path = make(tmp_path)
    ground, reading = loaded(path, told), by_gdal(path, told)
    metre = {"metre": 1.0, "US survey foot": SURVEY_FOOT, "foot": FOOT}[ground.units[1]]
    assert ground.units[0] == ground.units[1]
    assert ground.shape == reading.heights.shape
    np.testing.assert_array_equal(ground.valid, reading.valid)
    np.testing.assert_allclose(
        (ground.elevation * metre)[ground.valid], reading.heights[reading.valid], rtol=1e-6
    )
    step = reading.transform.a, -reading.transform.e
    origin = reading.transform.c, reading.transform.f
    if ground.crs is None or not ground.crs.startswith("LOCAL_CS"):
        np.testing.assert_allclose(ground.spacing, step, rtol=1e-9)
        np.testing.assert_allclose(ground.origin, origin, rtol=1e-9)
    else:
        # true to scale, and scaled back by what the CRS says what GDAL says
        np.testing.assert_allclose(ground.spacing, true_spacing(reading), rtol=2e-3)
        words = ground.crs.split(" times ")[1].split()
        scale = np.array([float(words[0]), float(words[2])])
        np.testing.assert_allclose(ground.spacing / scale, step, rtol=1e-6)
        np.testing.assert_allclose(ground.origin / scale, origin, rtol=1e-6)


def test_there_are_enough() -> None:
    assert len(ODD) >= 60


@pytest.mark.parametrize("name", ODD)
def test_without_rasterio_it_agrees_or_is_refused(
    tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    make, told = ODD[name]
    path = make(tmp_path)
    expected = loaded(path, told)
    monkeypatch.setattr(readers_gdal, "has_rasterio", lambda: False)
    refused = None
    try:
        ground = loaded(path, told)
    except (MissingExtraError, InputError) as error:
        refused = str(error)
    if refused is not None:
        assert "\n" not in refused
        assert "terrain_lod[geo]" in refused or "channel" in refused
        return
    assert (ground.shape, ground.units) == (expected.shape, expected.units)
    np.testing.assert_array_equal(ground.valid, expected.valid)
    np.testing.assert_array_equal(ground.elevation, expected.elevation)
    # the figure of the earth of a CRS that is a code alone is taken for WGS 84's
    np.testing.assert_allclose(ground.spacing, expected.spacing, rtol=1e-4)
    np.testing.assert_allclose(ground.origin, expected.origin, rtol=1e-4)
