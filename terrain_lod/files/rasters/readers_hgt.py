"""SRTM tiles: a square degree of 16-bit metres, plain, gzipped or zipped."""

from __future__ import annotations

import gzip
import re
import zipfile
from pathlib import Path
from typing import Final

import numpy as np

from ...errors import FileError, InputError
from .parts import Part
from .raster import Raster
from .wkt import DEGREE, System, in_degrees

# by size in bytes; both edges of the degree included. Tiles beyond 50 degrees north or south may
# have half the columns.
SHAPES: Final = {2 * r * c: (r, c) for r, c in ((1201, 1201), (3601, 3601), (3601, 1801))}
NODATA: Final = -32768
NAME: Final = re.compile(r"([NS])(\d\d)([EW])(\d\d\d)", re.IGNORECASE)


def read_hgt(path: Path, part: Part) -> Raster:
    """Read an SRTM tile of one degree, plain, gzipped or zipped.

    Big-endian int16 metres, row by row from the north; the name, as N46E007, says where its
    south-western sample stands (USGS, "SRTM Topography", 2015, section 2.1).
    """
    part.require_one_band(path.name)
    data = _unpacked(path)
    if len(data) not in SHAPES:
        sizes = ", ".join(str(size) for size in SHAPES)
        more = "or more " if len(data) > max(SHAPES) else ""
        raise FileError(
            f"expected an SRTM tile of {sizes} bytes, got {len(data)} {more}in {path.name}: "
            f"{'another kind of file' if more else 'truncated'}?"
        )
    rows, columns = SHAPES[len(data)]
    # float32 holds every int16, and says that these are metres already
    values = np.frombuffer(data, ">i2").reshape(rows, columns).astype(np.float32)
    step = 1 / (columns - 1), 1 / (rows - 1)
    place = NAME.match(path.name)
    raster = Raster(values, step, None, NODATA, system=System(angle=DEGREE))
    if place is not None:
        south = int(place[2]) * (1 if place[1] in "Nn" else -1)
        west = int(place[4]) * (1 if place[3] in "Ee" else -1)
        origin, system = (west, south + 1.0), in_degrees("EPSG:4326")
        raster = Raster(values, step, origin, NODATA, system=system)
    return part.cut(raster, path.name)


def _unpacked(path: Path) -> bytes:
    """Return the samples, and no more than a byte beyond the largest tile."""
    most = max(SHAPES) + 1
    if path.suffix.lower() == ".gz":
        with gzip.open(path) as file:
            return file.read(most)
    if path.suffix.lower() == ".zip":
        with zipfile.ZipFile(path) as archive:
            members = [name for name in archive.namelist() if name.lower().endswith(".hgt")]
            if len(members) != 1:
                raise InputError(
                    f"expected one .hgt file in {path.name}, got {', '.join(members) or 'none'}"
                )
            with archive.open(members[0]) as packed:
                return packed.read(most)
    with path.open("rb") as plain:
        return plain.read(most)
