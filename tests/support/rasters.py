"""Small rasters written to files, and the line that a bad one is refused with."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rasterio
from PIL import Image
from rasterio.transform import Affine

from terrain_lod.errors import TerrainError
from terrain_lod.files.rasters.loading import load

# 3 rows, 4 columns
GRID = np.array([[120, 130, 140, 150], [220, 230, 240, 250], [320, 330, 340, 350]])
# the header of a small ESRI ASCII grid, but for its cells
CORNER = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\n"
# an SRTM tile of three arc-seconds
TILE = (np.add.outer(np.arange(1201), np.arange(1201)) % 3000).astype(np.int16)
# cells of 30 x 20 m, the north-western one's corner at (500 000, 4 000 000)
UTM = Affine(30, 0, 500_000, 0, -20, 4_000_000)


def write_tiff(path: Path, values: np.ndarray, **options: Any) -> Path:
    """Write one band or, from (bands, R, C), several."""
    bands = values[None] if values.ndim == 2 else values
    options = {"driver": "GTiff", "crs": "EPSG:32632", "transform": UTM} | options
    tags = options.pop("tags", {})
    count, height, width = bands.shape
    with rasterio.open(
        path, "w", count=count, height=height, width=width, dtype=bands.dtype, **options
    ) as file:
        file.write(bands)
        file.update_tags(**tags)
    return path


def write_image(path: Path, pixels: np.ndarray, **options: Any) -> Path:
    Image.fromarray(pixels).save(path, **options)
    return path


def write_hgt(path: Path, values: np.ndarray) -> Path:
    path.write_bytes(values.astype(">i2").tobytes())
    return path


def write_asc(path: Path, header: str, values: np.ndarray = GRID) -> Path:
    body = "\n".join(" ".join(str(value) for value in row) for row in values.tolist())
    path.write_text(f"ncols {values.shape[1]}\nnrows {values.shape[0]}\n{header}\n{body}\n")
    return path


def refusal(
    error: type[TerrainError] | tuple[type[TerrainError], ...], path: Path, **options: Any
) -> str:
    """Return the one line that loading a file is refused with."""
    with pytest.raises(error) as caught:
        load(path, **options)
    message = str(caught.value)
    assert "\n" not in message
    assert message.startswith("expected ")
    return message
