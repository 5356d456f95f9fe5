"""Files that claim or hold more than fits, refused before anything is taken; damaged headers."""

from __future__ import annotations

import gzip
import struct
import subprocess
import sys
import zipfile
import zlib
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import rasterio

from support.rasters import UTM, refusal, write_tiff
from terrain_lod.errors import FileError, InputError, MissingExtraError
from terrain_lod.files.rasters.limits import (
    DEVICE_BYTES,
    WORK_BYTES,
    free_memory,
    require_memory,
)
from terrain_lod.files.rasters.loading import load


def npy(header: str, data: bytes = bytes(64)) -> bytes:
    """Return a NumPy file with any text for its header."""
    text = header.encode() + b" " * (64 - (len(header) + 11) % 64) + b"\n"
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(text)) + text + data


def png(columns: int, rows: int) -> bytes:
    """Return a PNG of a few bytes that claims any size."""

    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    header = struct.pack(">IIBBBBB", columns, rows, 16, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(99)))


def archive(name: str, data: bytes) -> bytes:
    stream = BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr(name, data)
    return stream.getvalue()


HEADER = "{'descr': '<f4', 'fortran_order': False, 'shape': "
ASC = "ncols %s\nnrows 2\nxllcorner 5e5\nyllcorner 0\ncellsize 1\n1 2 3 4\n"
DAMAGED = {
    "open.npy": npy(HEADER + "(4, 4), "),
    "nested.npy": npy("(" * 90 + ")" * 90),
    "minus.npy": npy(HEADER + "(" + "-" * 9000 + "1, 2)}"),
    "negative.npy": npy(HEADER + "(-4, -4)}"),
    "true.npy": npy(HEADER + "(True, 16)}"),
    "many.npy": npy(HEADER + "(1000000, 1000000)}"),
    "beyond.npy": npy(HEADER + f"({2**70}, {2**70})}}"),
    "objects.npy": npy("{'descr': '|O', 'fortran_order': False, 'shape': (4, 4)}"),
    "text.npz": archive("heights", b"no array"),
    "claims.npz": archive("heights.npy", npy(HEADER + "(1000000, 1000000)}")),
    "cut.npz": archive("heights.npy", npy(HEADER + "(4, 4)}"))[:80],
    "inf.asc": (ASC % "inf").encode(),
    "1e400.asc": (ASC % "1e400").encode(),
    "half.asc": (ASC % "1.5").encode(),
    "minus.asc": (ASC % "-2").encode(),
    "huge.asc": (ASC % "1e9").encode(),
    "claims.png": png(30_000, 30_000),
    "zeros.png": png(0, 0),
    "empty.tif": b"",
    "empty.hgt.gz": gzip.compress(b""),
    "text.tif": b"II*\0\xff\xff\xff\xff",
    "loop.tif": b"II*\0\x08\0\0\0" + b"\x01\0" * 40,
}


@pytest.mark.parametrize("name", DAMAGED)
def test_damaged_headers(tmp_path: Path, route: str, name: str) -> None:
    (tmp_path / name).write_bytes(DAMAGED[name])
    # an archive without an array, and a TIFF of which Pillow knows nothing, say something else
    errors = (FileError, InputError) if name == "text.npz" else FileError
    if route == "Pillow" and name.endswith(".tif"):
        errors = (FileError, MissingExtraError)
    assert name in refusal(errors, tmp_path / name)


def test_a_png_that_claims_the_world(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(png(2**31 - 1, 2**31 - 1))
    refusal((FileError, InputError), tmp_path / "a.png")


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["gz", "zip"])
def test_a_tile_is_unpacked_no_further_than_a_tile(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"N46E007.hgt.{ending}"
    # 400 MB of zeros
    if ending == "gz":
        path.write_bytes(gzip.compress(bytes(2**22), 1) * 100)
    else:
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as packed:
            packed.writestr("N46E007.hgt", bytes(400 * 2**20))
    program = (
        "import resource, sys, terrain_lod as tl\n"
        "before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "try: tl.load(sys.argv[1])\n"
        "except tl.FileError as error: print(error)\n"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)"
    )
    child = subprocess.run(
        [sys.executable, "-c", program, str(path)], capture_output=True, text=True, check=True
    )
    message, kilobytes = child.stdout.strip().splitlines()
    assert "or more in N46E007.hgt" in message
    assert int(kilobytes) < 150_000


def sparse(path: Path, side: int) -> Path:
    """Write a TIFF of hardly any bytes and a lot of samples."""
    with rasterio.open(
        path, "w", driver="GTiff", width=side, height=side, count=1, dtype="float32",
        crs="EPSG:32632", transform=UTM, SPARSE_OK=True, tiled=True, blockxsize=4096,
        blockysize=4096, BIGTIFF="YES",
    ):  # fmt: skip
        pass
    return path


def test_a_raster_beyond_memory_names_bytes_and_ways_out(tmp_path: Path) -> None:
    path = sparse(tmp_path / "a.tif", 400_000)
    message = refusal(InputError, path)
    assert "400,000 x 400,000 samples in a.tif" in message
    assert "2.56 TB here and 800 GB on a device: read a part with window= or bounds=" in message
    part = load(path, window=(300_000, 399_990, 10, 10), spacing="map")
    assert part.shape == (10, 10)
    assert part.origin == (500_000 + 30 * 300_000.5, 4_000_000 - 20 * 399_990.5)


@pytest.mark.slow
def test_the_limit_of_the_address_space_counts(tmp_path: Path) -> None:
    path = sparse(tmp_path / "a.tif", 30_000)
    program = (
        "import resource, sys, terrain_lod as tl\n"
        "resource.setrlimit(resource.RLIMIT_AS, (6 << 30,) * 2)\n"
        "try: tl.load(sys.argv[1])\n"
        "except tl.InputError as error: print(error)"
    )
    child = subprocess.run(
        [sys.executable, "-c", program, str(path)], capture_output=True, text=True, timeout=60
    )
    assert "30,000 x 30,000 samples" in child.stdout, child.stderr


def test_free_memory_is_known_here() -> None:
    free = free_memory()
    assert free is not None
    assert 2**20 < free < 2**50
    require_memory(1000, 1000, np.float32, "a")
    with pytest.raises(InputError, match=f"{DEVICE_BYTES} TB on a device"):
        require_memory(10**6, 10**6, np.float32, "a")


@pytest.mark.slow
@pytest.mark.parametrize("dtype", ["int16", "float64"])
def test_what_loading_takes_is_what_is_promised(tmp_path: Path, dtype: str) -> None:
    values = np.add.outer(np.arange(3000), np.arange(3000) / 7 % 1000).astype(dtype)
    path = write_tiff(tmp_path / "a.tif", values, nodata=5)
    program = (
        "import resource, sys, terrain_lod as tl\n"
        "tl.load(sys.argv[1], window=(0, 0, 9, 9))\n"
        "peak = lambda: resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024\n"
        "before = peak(); tl.load(sys.argv[1]); print(peak() - before)"
    )
    child = subprocess.run(
        [sys.executable, "-c", program, str(path)], capture_output=True, text=True
    )
    # with room for GDAL's own cache
    assert int(child.stdout) < 1.3 * values.size * (2 * values.dtype.itemsize + WORK_BYTES)
