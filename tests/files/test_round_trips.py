"""Points of files, taken back to the map that the raster is on, lie on its ground."""

from __future__ import annotations

import warnings
from pathlib import Path

import numpy as np
import pytest
from rasterio.transform import Affine
from rasterio.warp import transform

from support.rasters import write_tiff
from terrain_lod.files.meshes.loading import load_mesh
from terrain_lod.files.rasters.loading import load
from terrain_lod.files.rasters.place import map_of
from terrain_lod.terrain.lod_promises import MaxErrorLod
from terrain_lod.terrain.terrain import Terrain

PROMISE = 2.0
# where cells are, and metres in a unit of the map
PLACES = {
    "EPSG:32632": (Affine(30, 0, 500_000, 0, -20, 4_000_000), 1.0),
    "EPSG:4326": (Affine(1 / 1200, 0, 7.0, 0, -1 / 1200, 46.05), 1.0),
    "EPSG:3857": (Affine(100, 0, 779_000, 0, -100, 5_780_000), 1.0),
    "EPSG:2263": (Affine(90, 0, 980_000, 0, -90, 200_000), 1200 / 3937),
}


@pytest.mark.parametrize("ending", [".glb", ".obj", ".stl"])
@pytest.mark.parametrize("crs", PLACES)
@pytest.mark.parametrize("onto", [None, "utm"])
def test_a_thousand_points_lie_on_the_ground(
    tmp_path: Path, crs: str, ending: str, onto: str | None
) -> None:
    affine, unit = PLACES[crs]
    row, column = np.mgrid[:50, :60]
    values = 800 + 90 * np.sin(row / 9) + 70 * np.cos(column / 7)
    path = write_tiff(tmp_path / "a.tif", values, crs=crs, transform=affine)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        ground = load(path, z_unit="metre", crs=onto)
    own = 0.0
    if onto is not None:
        own = float(str(caught[-1].message).split("within ")[1].split()[0])
    promised = PROMISE / (unit if onto is None else 1.0)
    mesh = Terrain(ground).mesh(lod=MaxErrorLod(promised))
    saved = load_mesh(mesh.save(tmp_path / f"a{ending}"))
    # an STL has no room for the CRS: that of the ground stands in
    system, (east, north) = map_of(saved.crs or ground.crs or "")

    chance = np.random.default_rng(7)
    shares = chance.dirichlet([1, 1, 1], 1000)
    corners = saved.vertices[saved.triangles[chance.integers(len(saved.triangles), size=1000)]]
    points = np.einsum("ni,nij->nj", shares, corners.astype(np.float64)) + saved.origin
    x, y = (np.array(part) for part in transform(
        system, crs, points[:, 0] / east, points[:, 1] / north))  # fmt: skip
    across, down = (x - affine.c) / affine.a - 0.5, (y - affine.f) / affine.e - 0.5
    inside = (across >= 0) & (down >= 0) & (across < 59) & (down < 49)
    assert inside.sum() >= (990 if onto is None else 900)
    left, top = across[inside].astype(int), down[inside].astype(int)
    u, v = across[inside] - left, down[inside] - top
    seen = (1 - v) * ((1 - u) * values[top, left] + u * values[top, left + 1])
    seen += v * ((1 - u) * values[top + 1, left] + u * values[top + 1, left + 1])
    off = np.abs(points[inside, 2] * (unit if onto is None else 1.0) - seen)

    # a promise is kept at samples; between them a cell leaves the plane by a quarter of its twist,
    # a bilinear sample of a bilinear ground is off by an eighth of its curvature at most, and the
    # mesh bends where no sample is: as seen here, by less than 5 % of the promise
    twist = np.abs(np.diff(np.diff(values, axis=0), axis=1)).max() / 4
    curved = sum(np.abs(np.diff(values, 2, axis=axis)).max() / 8 for axis in (0, 1))
    between = twist + 0.05 * PROMISE + (curved if onto is not None else 0.0)
    # what text of six digits keeps of a kilometre, on a slope
    rounding = 0.02
    assert off.max() <= PROMISE + own + between + rounding
    # the same in another map, or from another row, is far off
    assert off.max() > 0.2 * PROMISE
