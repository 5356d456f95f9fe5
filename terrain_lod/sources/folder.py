"""A folder of tiles as one source."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np

from ..errors import FileError, InputError
from ..files.rasters.formats import FORMATS
from ..files.rasters.raster import Raster
from ..files.rasters.reading import Reading, reading_of
from .raster_file import RasterFile, header_of
from .source import Heights, fingerprint_of_files, is_exact, virtual

# tiles whose grids differ by more than this part of a cell are not of one raster
_OFF: Final = 0.01


@dataclass(frozen=True)
class Placed:
    """A tile, and the row and column of its first sample in the whole."""

    tile: RasterFile
    row: int
    column: int

    @property
    def end(self) -> tuple[int, int]:
        return self.row + self.tile.shape[0], self.column + self.tile.shape[1]


@dataclass(frozen=True)
class Folder:
    """All rasters of a folder side by side; see :class:`~terrain_lod.sources.source.Source`.

    Where tiles overlap, the first by name that has data there counts; where there is none, there
    is no data. Every tile keeps its own value for nodata.

    Attributes
    ----------
    tiles : tuple of Placed
    shape : (int, int)
    reading : Reading
    is_exact : bool
    """

    tiles: tuple[Placed, ...]
    shape: tuple[int, int]
    reading: Reading
    is_exact: bool

    @classmethod
    def of(cls, folder: Path, *, band: int | None = None, **options: Any) -> Folder:
        """Look at the headers of all tiles; the options are those of :func:`terrain_lod.load`.

        Raises
        ------
        InputError
            If tiles have no place, differ in CRS, unit or step, or lie far from each other.
        """
        endings = tuple(ending for form in FORMATS for ending in form.endings)
        paths = sorted(
            path for path in folder.iterdir() if path.name.lower().endswith(endings)
            if path.is_file()
        )  # fmt: skip
        if not paths:
            raise FileError(f"expected rasters in the folder {folder}, got none")
        headers = [header_of(path, band)[0] for path in paths]
        first = headers[0]
        for path, header in zip(paths, headers, strict=True):
            _require_alike(paths[0], first, path, header)
        places = _places(paths, headers)
        north, west = np.min(places, axis=0)
        ends = [
            (row + header.values.shape[0], column + header.values.shape[1])
            for (row, column), header in zip(places, headers, strict=True)
        ]
        shape = int(max(end for end, _ in ends) - north), int(max(end for _, end in ends) - west)
        assert first.step is not None
        assert first.origin is not None
        whole = replace(
            first,
            values=virtual(shape, np.result_type(*(header.values.dtype for header in headers))),
            origin=(
                first.origin[0] + int(west) * first.step[0],
                first.origin[1] - int(north) * first.step[1],
            ),
        )
        reading = reading_of(whole, folder.name, **options)
        tiles = []
        for path, (row, column) in zip(paths, places, strict=True):
            header, southern = header_of(path, band)
            # all is alike but what stands for nodata
            nodata = reading.nodata if options.get("nodata") is not None else header.nodata
            own = replace(reading, nodata=nodata, name=path.name)
            rows, columns = header.values.shape
            tile = RasterFile(
                path.absolute(), band, (rows, columns), own, is_exact(own, header), southern
            )
            tiles.append(Placed(tile, row - int(north), column - int(west)))
        _require_together(tiles)
        return cls(tuple(tiles), shape, reading, all(placed.tile.is_exact for placed in tiles))

    def read(self, rows: slice, columns: slice) -> Heights:
        extent = rows.stop - rows.start, columns.stop - columns.start
        heights: Heights = np.full(extent, np.nan, np.float32 if self.is_exact else np.float64)
        for placed in self.tiles:
            top, left = max(rows.start, placed.row), max(columns.start, placed.column)
            bottom, right = (min(end, part.stop) for end, part in
                             zip(placed.end, (rows, columns), strict=True))  # fmt: skip
            if top >= bottom or left >= right:
                continue
            # files give two samples at least
            first = min(top - placed.row, placed.tile.shape[0] - 2)
            across = min(left - placed.column, placed.tile.shape[1] - 2)
            found = placed.tile.read(
                slice(first, max(bottom - placed.row, first + 2)),
                slice(across, max(right - placed.column, across + 2)),
            )
            down, over = top - placed.row - first, left - placed.column - across
            found = found[down : down + bottom - top, over : over + right - left]
            target = heights[
                top - rows.start : bottom - rows.start, left - columns.start : right - columns.start
            ]
            np.copyto(target, found, where=np.isnan(target), casting="same_kind")
        return heights

    def fingerprint(self) -> str:
        paths = [placed.tile.path for placed in self.tiles]
        return fingerprint_of_files(paths, (self.shape, self.reading))


def _require_alike(first: Path, one: Raster, path: Path, other: Raster) -> None:
    if other.step is None or other.origin is None or one.step is None:
        raise InputError(
            f"expected tiles that say where they are, got {path.name}, which does not: "
            "place them with gdal_translate, or build from one file"
        )
    if (one.system.crs is None) != (other.system.crs is None):
        with_crs, without = (first, path) if one.system.crs else (path, first)
        raise InputError(
            f"expected tiles in one CRS, got {with_crs.name} with one and {without.name} without: "
            "write it into the file with gdal_edit"
        )
    if one.system.horizontal != other.system.horizontal:
        raise InputError(
            f"expected tiles in one CRS, got {first.name} in {one.system.horizontal} and "
            f"{path.name} in {other.system.horizontal}: reproject one with gdalwarp"
        )
    if (one.height_unit, one.system.height_unit) != (other.height_unit, other.system.height_unit):
        raise InputError(
            f"expected heights in one unit, got others in {path.name} than in {first.name}: "
            "convert one with gdal_calc"
        )


def _places(paths: list[Path], headers: list[Raster]) -> list[tuple[int, int]]:
    """Return row and column of each tile's first sample, counted from the first tile's."""
    (x, y), (dx, dy) = headers[0].origin, headers[0].step  # type: ignore[misc]
    # steps may differ so little that nothing is off at the end of a tile
    places = []
    for path, header in zip(paths, headers, strict=True):
        assert header.origin is not None
        assert header.step is not None
        across, down = (header.origin[0] - x) / dx, (y - header.origin[1]) / dy
        off = max(abs(across - round(across)), abs(down - round(down)))
        drift = max(
            abs(step / other - 1) * extent
            for step, other, extent in zip(
                header.step, (dx, dy), header.values.shape[::-1], strict=True
            )
        )
        if off > _OFF or drift > _OFF:
            raise InputError(
                f"expected tiles on one grid of samples, got {path.name}, which is off that of "
                f"{paths[0].name} by {max(off, drift):.2g} of a cell: resample it with gdalwarp"
            )
        places.append((round(down), round(across)))
    return places


def _require_together(tiles: list[Placed]) -> None:
    """Refuse tiles that are not all connected, by touching each other or nearly so."""
    reached, left = [tiles[0]], list(tiles[1:])
    while reached and left:
        one = reached.pop()
        near = [other for other in left if _touch(one, other)]
        left = [other for other in left if other not in near]
        reached += near
    if left:
        raise InputError(
            f"expected tiles that touch each other, got {left[0].tile.path.name}, which lies apart "
            f"from {tiles[0].tile.path.name}: build from one folder each"
        )


def _touch(one: Placed, other: Placed) -> bool:
    (bottom, right), (other_bottom, other_right) = one.end, other.end
    return (
        one.row <= other_bottom and other.row <= bottom
        and one.column <= other_right and other.column <= right
    )  # fmt: skip
