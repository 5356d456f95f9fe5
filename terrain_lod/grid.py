"""How a raster is cut into tiles: the one home of the mapping tile -> samples -> world.

A tile is a square of ``tile`` cells and (tile + 1)^2 samples; neighbours share their border
samples. Rasters of any size are covered: the last row and column of tiles may be smaller.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import layout
from .arguments import whole
from .heightmap import Heightmap


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
        If `tile` is not a whole number from 1 to 63.
    """

    rows: int
    columns: int
    tile: int
    spacing: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "tile", whole("tile", self.tile, 1, layout.MAX_TILE))

    @classmethod
    def of(cls, ground: Heightmap, tile: int) -> TileGrid:
        """Return the tiles of a heightmap."""
        return cls(*ground.shape, tile, ground.spacing)

    @property
    def shape(self) -> tuple[int, int]:
        """Tile rows and columns."""
        return -(-(self.rows - 1) // self.tile), -(-(self.columns - 1) // self.tile)

    @property
    def count(self) -> int:
        """Tiles in all."""
        return self.shape[0] * self.shape[1]

    @property
    def corner_rows(self) -> npt.NDArray[np.int64]:
        """Sample rows of the tile corners; (TR + 1,)."""
        return np.minimum(np.arange(self.shape[0] + 1) * self.tile, self.rows - 1)

    @property
    def corner_columns(self) -> npt.NDArray[np.int64]:
        """Sample columns of the tile corners; (TC + 1,)."""
        return np.minimum(np.arange(self.shape[1] + 1) * self.tile, self.columns - 1)

    def record(self) -> npt.NDArray[Any]:
        """Return the ``layout.GRID`` record that kernels take."""
        return np.array(
            (self.rows, self.columns, self.tile, *self.shape, *self.spacing), layout.GRID
        )
