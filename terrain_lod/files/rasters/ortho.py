"""Pictures of the ground from above, brought to the map that the ground is on."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ...errors import FileError, InputError
from ...ground.heightmap import Heightmap
from .place import map_of
from .readers_gdal import crs_called, opened_picture

Picture = npt.NDArray[np.uint8]
# pixels along one side, in reach of every driver
_LARGEST: Final = 4096
# where the picture does not reach
_GREY: Final = 204


def read_ortho(path: Path, ground: Heightmap) -> Picture:
    """Return a picture of the ground's own rectangle, from its first sample to its last.

    A picture that says where it is, is reprojected; another one covers the ground edge to edge.
    Where it does not reach, the picture is grey.

    Returns
    -------
    (H, W, 3) uint8
        Row 0 north, at most 4096 pixels a side.

    Raises
    ------
    FileError
        If there is no such file, or GDAL does not know it.
    InputError
        If it shows another place, has not one or three bands of 8 bits, or if the ground has no
        CRS that it could be brought to.
    MissingExtraError
        If rasterio is not installed.
    """
    if not path.is_file():
        raise FileError(f"expected a picture, got nothing at {path}")
    with opened_picture(path) as file:
        if file.count == 2 or file.dtypes[0] != "uint8":
            raise InputError(
                f"expected a picture of one or three bands of 8 bits, got {file.count} of "
                f"{file.dtypes[0]} in {path.name}"
            )
        if file.crs is None or file.transform.is_identity:
            step = max(1.0, max(file.shape) / _LARGEST)
            rows, columns = (math.ceil(extent / step) for extent in file.shape)
            return _colours(file.read(_bands(file), out_shape=(len(_bands(file)), rows, columns)))
        return _brought_to(file, path.name, ground)


def _bands(file: Any) -> list[int]:
    return [1, 2, 3] if file.count >= 3 else [1]


def _colours(bands: npt.NDArray[np.uint8]) -> Picture:
    return np.ascontiguousarray(np.broadcast_to(np.moveaxis(bands, 0, 2), (*bands.shape[1:], 3)))


def _brought_to(file: Any, name: str, ground: Heightmap) -> Picture:
    """Return what a picture shows of the ground's rectangle."""
    from rasterio import Affine
    from rasterio.enums import Resampling
    from rasterio.vrt import WarpedVRT
    from rasterio.warp import calculate_default_transform

    if ground.crs is None:
        raise InputError(f"expected ground with a CRS, for {name} has one, got none")
    crs, (east, north) = map_of(ground.crs)
    width, depth = ground.extent[0] / east, ground.extent[1] / north
    with crs_called(crs) as target:
        step = calculate_default_transform(file.crs, target, file.width, file.height, *file.bounds)
        finest = max(step[0].a, max(width, depth) / _LARGEST)
        columns, rows = (max(math.ceil(extent / finest), 1) for extent in (width, depth))
        transform = Affine(
            width / columns, 0.0, ground.origin[0] / east,
            0.0, -depth / rows, ground.origin[1] / north,
        )  # fmt: skip
        with WarpedVRT(
            file, crs=target, transform=transform, width=columns, height=rows,
            resampling=Resampling.bilinear, add_alpha=file.count in (1, 3),
        ) as warped:  # fmt: skip
            bands = warped.read([*_bands(file), warped.count])
    known = bands[-1] > 0
    if not known.any():
        raise InputError(f"expected a picture of the ground that it is laid over, got {name}, "
                         "which shows another place")  # fmt: skip
    return _colours(np.where(known, bands[:-1], np.uint8(_GREY)))


def coordinates(vertices: npt.NDArray[Any], origin: Any, ground: Heightmap) -> npt.NDArray[Any]:
    """Return where vertices are in the picture of a ground: u east, v north, 0 to 1; (V, 2)."""
    places = vertices[:, :2].astype(np.float64) + np.subtract(origin[:2], ground.origin)
    return np.asarray(places / ground.extent + (0.0, 1.0), np.float32)
