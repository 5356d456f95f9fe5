"""Damaged files of ground: what is loaded is ground, and becomes a mesh."""

from __future__ import annotations

import gzip
import random
import zipfile
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Final
from unittest.mock import patch

import numpy as np

from fuzz.damage import damaged
from fuzz.kind import require
from support.odd_rasters import FLOAT, HILLS, ODD, WHOLE, Maker
from support.rasters import TILE, write_hgt, write_image
from terrain_lod.files.rasters import readers_gdal
from terrain_lod.files.rasters.loading import load
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.terrain.terrain import Terrain

# samples that become a mesh, too: more take their time
_FEW: Final = 100_000

# a file, those beside it, and what `load` is told
Source = tuple[str, dict[str, bytes], dict[str, Any]]


def trial(chance: random.Random, folder: Path) -> None:
    name, files, told = _source(chance.choice(_NAMES))
    # one of them is damaged: mostly that which is loaded
    victim = name if chance.random() < 0.7 else chance.choice(list(files))
    for file, content in files.items():
        path = folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(damaged(content, chance) if file == victim else content)
    # as if rasterio were not installed, now and then
    has = readers_gdal.has_rasterio() and chance.random() < 0.8
    with patch.object(readers_gdal, "has_rasterio", lambda: has):
        ground = load(folder / name, **told)
    require_ground(ground)
    if ground.heights.size <= _FEW:
        mesh = Terrain(ground).mesh()
        require(bool(np.isfinite(mesh.vertices).all()), "vertices that are not finite")
        require(bool(np.isfinite(mesh.normals).all()), "normals that are not finite")
        require(len(mesh.triangles) > 0 or not whole_cells(ground).any(), "no triangles")


def require_ground(ground: Heightmap) -> None:
    """Say what is wrong with ground that was made of whatever."""
    require(bool(np.isfinite(ground.heights[ground.valid]).all()), "heights that are not finite")
    require(bool(ground.valid.any()), "ground without data")
    require(bool(np.isfinite(ground.origin).all() and np.isfinite(ground.base)), "a place nowhere")
    spacing = np.array(ground.spacing)
    require(bool((np.isfinite(spacing) & (spacing > 0)).all()), f"spacing {ground.spacing}")


def whole_cells(ground: Heightmap) -> np.ndarray:
    """Return which cells have data at all four corners."""
    valid = ground.valid
    return valid[:-1, :-1] & valid[1:, :-1] & valid[:-1, 1:] & valid[1:, 1:]


def _array(folder: Path) -> Path:
    np.save(folder / "odd.npy", FLOAT)
    return folder / "odd.npy"


def _archive(folder: Path) -> Path:
    np.savez(folder / "odd.npz", heights=FLOAT, other=np.arange(3))
    return folder / "odd.npz"


def _compressed(folder: Path) -> Path:
    np.savez_compressed(folder / "odd.npz", heights=WHOLE)
    return folder / "odd.npz"


def _image(ending: str, pixels: np.ndarray, **options: Any) -> Maker:
    return lambda folder: write_image(folder / f"odd.{ending}", pixels, **options)


def _tile(folder: Path) -> Path:
    return write_hgt(folder / "N46E007.hgt", TILE)


def _packed_tile(folder: Path) -> Path:
    path = folder / "N46E007.hgt.gz"
    path.write_bytes(gzip.compress(TILE.astype(">i2").tobytes(), 1))
    return path


def _zipped_tile(folder: Path) -> Path:
    path = folder / "N46E007.hgt.zip"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("N46E007.hgt", TILE.astype(">i2").tobytes())
    return path


def _grass(folder: Path) -> Path:
    header = "north: 4600\nsouth: 4200\neast: 620\nwest: 300\nrows: 40\ncols: 32\nnull: -5\n"
    rows = "\n".join(" ".join(f"{value:g}" for value in row) for row in HILLS)
    path = folder / "odd.asc"
    path.write_text(header + rows)
    return path


def _placed(folder: Path) -> Path:
    (folder / "odd.pgw").write_text("30\n0\n0\n-30\n500000\n4000000\n")
    return write_image(folder / "odd.png", WHOLE.astype(np.uint16))


def _terrarium(folder: Path) -> Path:
    numbers = np.round((HILLS + 32768) * 256).astype(np.int64)
    pixels = np.stack([numbers >> 16, numbers >> 8 & 255, numbers & 255], axis=-1)
    path = folder / "14" / "8500" / "5800.png"
    path.parent.mkdir(parents=True)
    return write_image(path, pixels.astype(np.uint8))


_GREY: Final = (WHOLE // 5).astype(np.uint8)
_OTHERS: Final[dict[str, Maker]] = {
    "NumPy array": _array,
    "NumPy archive": _archive,
    "NumPy archive, compressed": _compressed,
    "16-bit PNG": _image("png", WHOLE.astype(np.uint16)),
    "16-bit PNG with a world file": _placed,
    "8-bit PNG": _image("png", _GREY),
    "JPEG": _image("jpg", _GREY),
    "WebP": _image("webp", _GREY, lossless=True),
    "Terrarium": _terrarium,
    "SRTM": _tile,
    "SRTM, gzipped": _packed_tile,
    "SRTM, zipped": _zipped_tile,
    "GRASS": _grass,
}
_NAMES: Final = (*ODD, *_OTHERS)


@cache
def _source(name: str) -> Source:
    """Return a whole raster of a kind, and the files beside it."""
    make, told = ODD.get(name) or (_OTHERS[name], {})
    with TemporaryDirectory() as folder:
        path = make(Path(folder))
        files = {
            str(file.relative_to(folder)): file.read_bytes()
            for file in sorted(Path(folder).rglob("*"))
            if file.is_file()
        }
        return str(path.relative_to(folder)), files, told
