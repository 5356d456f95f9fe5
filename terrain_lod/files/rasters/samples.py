"""Ground that is always there: the bundled one, and real ground that matplotlib ships."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from importlib.resources import as_file, files
from importlib.resources.abc import Traversable
from typing import Any, Final

import numpy as np

from ...arguments import one_of
from ...ground.heightmap import Heightmap
from .loading import ground_of
from .raster import Raster
from .readers_image import open_image, raster_of
from .wkt import in_degrees


def sample_names() -> tuple[str, ...]:
    """Return the names that `sample` knows."""
    return (*_catalogue(), *_SHIPPED)


def sample(name: str) -> Heightmap:
    """Return ground by name.

    Made for this project, 16 bits, from ``heightmaps/`` (its README says how): ``ridge`` and
    ``canyon``, 1025 x 1025 samples; ``dunes``, ``volcano``, ``islands`` and ``city``, 513 x 513.

    Real, from matplotlib's sample data, in degrees and so made local metres as `load` does it:
    ``jacksboro``, 344 x 403 samples of the Jacksboro fault in Tennessee (3 arc-seconds, 74.6 m x
    92.5 m); ``topobathy``, 91 x 120 samples of Vancouver Island and the sea around it (2
    arc-minutes of longitude).

    Raises
    ------
    InputError
        If there is no such ground; lists those there are.
    """
    one_of("sample", name, sample_names())
    if name in _SHIPPED:
        return ground_of(_SHIPPED[name](), name)
    entry = _catalogue()[name]
    with as_file(_bundled() / f"{name}.png") as path, open_image(path) as image:
        raster = raster_of(image, path)
    x0, y0 = entry["origin"]
    low, high = entry["height_range"]
    raster = replace(raster, step=(entry["spacing"], entry["spacing"]), origin=(x0, y0))
    return ground_of(raster, name, height_range=(low, high))


def _bundled() -> Traversable:
    return files("terrain_lod.heightmaps")


@cache
def _catalogue() -> dict[str, Any]:
    """Return what grounds.json says, by name."""
    text = (_bundled() / "grounds.json").read_text(encoding="utf-8")
    catalogue: dict[str, Any] = json.loads(text)
    return catalogue


def _shipped(file: str) -> dict[str, Any]:
    """Return the arrays of one of matplotlib's sample files."""
    from matplotlib.cbook import get_sample_data

    with np.load(get_sample_data(file, asfileobj=False)) as archive:
        return {key: archive[key] for key in archive.files}


def _jacksboro() -> Raster:
    data = _shipped("jacksboro_fault_dem.npz")
    dx, dy = float(data["dx"]), float(data["dy"])
    # the bounds are those of the outer cells' edges; the file's ymin is the northern one
    north = max(float(data["ymin"]), float(data["ymax"]))
    origin = float(data["xmin"]) + dx / 2, north - dy / 2
    return Raster(data["elevation"], (dx, dy), origin, system=in_degrees("EPSG:4269"))


def _topobathy() -> Raster:
    data = _shipped("topobathy.npz")
    longitude, latitude = data["longitude"], data["latitude"]
    dx = float(longitude[-1] - longitude[0]) / (len(longitude) - 1)
    # the rows are a Mercator map's, a little closer in the north: taken as even; row 0 is south
    dy = float(latitude[-1] - latitude[0]) / (len(latitude) - 1)
    origin = float(longitude[0]) - 360, float(latitude[-1])
    return Raster(data["topo"][::-1], (dx, dy), origin, system=in_degrees("EPSG:4326"))


_SHIPPED: Final[dict[str, Callable[[], Raster]]] = {
    "jacksboro": _jacksboro,
    "topobathy": _topobathy,
}
