"""A source of any size, read once, window by window, into a file that is mapped."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np

from ..errors import FileError, InputError
from ..ground.place import Place
from ..ground.units import METRE, unit_called
from ..sources.source import Source as Windows
from .geoid import Geoid
from .mapped import MappedGround

# samples read together
_TOGETHER: Final = 1 << 22


def mapped_ground(
    source: Windows, path: Path, crs: str | None, geoid: Geoid | None
) -> MappedGround:
    """Read a source, window by window, into a file, and return the ground that is there.

    Parameters
    ----------
    source : Source
        Of any size.
    path : Path
        Of the file; the disk needs 4 bytes a sample there.
    crs : str or None
        Instead of what the source says.
    geoid : Geoid or None
        What its heights are above, if not the ellipsoid: they become those above it, in metres.

    Raises
    ------
    InputError
        If samples have no data: holes have to be known all over, and that needs memory.
    FileError
        If the source cannot be read, or the file not be written.
    """
    (rows, columns), reading = source.shape, source.reading
    crs, units, metres = crs or reading.crs, reading.units, 1.0
    place = Place.of(crs)
    if geoid is not None:
        metres, units = (unit_called(units[1]) or METRE).metres, (units[0], METRE.name)
    base, low, high = 0.0, np.inf, -np.inf
    together = max(_TOGETHER // columns, 1)
    try:
        with path.open("wb") as file:
            for top in range(0, rows, together):
                stop = min(top + together, rows)
                part = source.read(slice(top, stop), slice(0, columns)).astype(np.float64)
                if np.isnan(part).any():
                    row, column = np.argwhere(np.isnan(part))[0]
                    raise InputError(
                        "expected ground without holes where it is read window by window, got no "
                        f"data at [{top + row}, {column}]: load it, or fill its holes"
                    )
                if geoid is not None:
                    (x, y), (dx, dy) = reading.origin, reading.spacing
                    row, column = np.mgrid[top:stop, :columns]
                    lon, lat = place.to_degrees(x + column * dx, y - row * dy)
                    part = part * metres + geoid.above_ellipsoid(lon, lat)
                if top == 0 and (geoid is not None or not source.is_exact):
                    base = float(np.round(part.mean()))
                low, high = min(low, float(part.min())), max(high, float(part.max()))
                with np.errstate(over="ignore"):
                    stored = (part - base).astype(np.float32)
                if np.isinf(stored).any():
                    raise InputError("expected heights that float32 can hold, got some beyond")
                stored.tofile(file)
    except OSError as error:
        if isinstance(error, FileError):
            raise
        raise FileError(
            f"cannot write {rows * columns * 4:,} bytes to {path}: {error.strerror}"
        ) from None
    return MappedGround(path, source.shape, reading.spacing, reading.origin, base, crs, units,
                        (low, high), source.fingerprint())  # fmt: skip
