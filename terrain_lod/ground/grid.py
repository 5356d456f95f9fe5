"""How a raster is cut into tiles: the one home of the mapping tile -> samples -> world.

A tile is a square of ``tile`` cells and (tile + 1)^2 samples; neighbours share their border
samples. Rasters of any size are covered: the last tiles of a row or column may be smaller.

fractional_odd lands on the samples only where a tile has an odd number of cells. So where tiles are
odd and an even number of cells is left for the last one, it is split into two odd ones: factors
equal to the cells then reproduce any raster::

    |<----15---->|<----15---->|<--5-->|<-3->|      38 cells, 39 samples
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..arguments import whole
from ..device import layout
from ..errors import InputError
from .heightmap import Heightmap
from .relief import Relief

# kernels number samples along a line, and the control points of all patches, in 32 bits
_MOST_SAMPLES: Final = 2**30
_MOST_TILES: Final = 2**27


@dataclass(frozen=True)
class TileGrid:
    """The TR x TC tiles of an R x C raster.

    Parameters
    ----------
    rows, columns : int
        Samples of the raster.
    tile : int
        Cells along a full tile, 1 to 63.
    spacing : (float, float)
        World distance between samples along x and y.

    Raises
    ------
    InputError
        If `tile` is not a whole number from 1 to 63, or samples or tiles are too many to number.
    """

    rows: int
    columns: int
    tile: int
    spacing: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "tile", whole("tile", self.tile, 1, layout.MAX_TILE))
        if max(self.rows, self.columns) > _MOST_SAMPLES or self.count > _MOST_TILES:
            raise InputError(
                f"expected a raster of at most {_MOST_SAMPLES} samples along a side and "
                f"{_MOST_TILES} tiles, got {self.rows} x {self.columns} samples in {self.count} "
                f"tiles of {self.tile}: use larger tiles, a smaller raster or coarser detail"
            )

    @classmethod
    def of(cls, ground: Heightmap | Relief, tile: int) -> TileGrid:
        """Return the tiles of a heightmap, or of one with detail."""
        return cls(*ground.shape, tile, ground.spacing)

    @property
    def shape(self) -> tuple[int, int]:
        """Tile rows and columns."""
        return _tile_count(self.rows - 1, self.tile), _tile_count(self.columns - 1, self.tile)

    @property
    def extent(self) -> tuple[float, float]:
        """World size along x and y, first to last sample."""
        return (self.columns - 1) * self.spacing[0], (self.rows - 1) * self.spacing[1]

    @property
    def count(self) -> int:
        """Tiles in all."""
        return self.shape[0] * self.shape[1]

    @property
    def levels(self) -> int:
        """Levels of the error ladder: the odd factors 1, 3, 5, ... up to a tile's cells."""
        return (self.tile + 1) // 2

    @cached_property
    def corner_rows(self) -> npt.NDArray[np.int64]:
        """Sample rows of the tile corners; (TR + 1,)."""
        return _corners(self.rows - 1, self.tile)

    @cached_property
    def corner_columns(self) -> npt.NDArray[np.int64]:
        """Sample columns of the tile corners; (TC + 1,)."""
        return _corners(self.columns - 1, self.tile)

    @cached_property
    def areas(self) -> npt.NDArray[np.int32]:
        """First row, first column, rows and columns of the cells of each tile; (P, 4)."""
        rows, columns = self.corner_rows, self.corner_columns
        parts = np.broadcast_arrays(
            rows[:-1, None], columns[:-1], np.diff(rows)[:, None], np.diff(columns)
        )
        return np.stack([part.ravel() for part in parts], axis=1).astype(np.int32)

    def touching(self, rows: slice, columns: slice) -> npt.NDArray[np.int32]:
        """Return the tiles that hold any of these samples, their borders included; sorted.

        Parameters
        ----------
        rows, columns : slice
            Of samples within the raster, start and stop given.
        """
        (first_row, end_row), (first_column, end_column) = (
            # the first tile that ends at `start` or after it, the first that begins at `stop`
            (np.searchsorted(corners[1:], part.start), np.searchsorted(corners[:-1], part.stop))
            for corners, part in ((self.corner_rows, rows), (self.corner_columns, columns))
        )
        down = np.arange(first_row, end_row, dtype=np.int32)
        across = np.arange(first_column, end_column, dtype=np.int32)
        tiles: npt.NDArray[np.int32] = (down[:, None] * np.int32(self.shape[1]) + across).ravel()
        return tiles

    def record(self) -> npt.NDArray[Any]:
        """Return the ``layout.GRID`` record that kernels take."""
        last = (self.corner_rows[-2], self.corner_columns[-2])
        return np.array(
            (self.rows, self.columns, self.tile, *self.shape, *last, *self.spacing), layout.GRID
        )


def _last_tiles(cells: int, tile: int) -> list[int]:
    """Return the cells of the tiles after those that are full for certain."""
    left = cells % tile
    if tile % 2 == 1 and left % 2 == 0 and left > 0:
        smaller = (left // 2 - 1) | 1
        return [left - smaller, smaller]
    return [left] if left else []


def _tile_count(cells: int, tile: int) -> int:
    return cells // tile + len(_last_tiles(cells, tile))


def _corners(cells: int, tile: int) -> npt.NDArray[np.int64]:
    """Return the first cell of each tile, and the end; ``tile_corner`` of ``common.h``."""
    sizes = [tile] * (cells // tile) + _last_tiles(cells, tile)
    return np.concatenate([[0], np.cumsum(sizes)])
