"""Soft light from the sky on a mesh of ground: less in valleys and before walls."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh


@dataclass(frozen=True, eq=False)
class SkyLight:
    """The share of the sky's light that samples of a ground have.

    Attributes
    ----------
    ground : Heightmap
    seen : (R, C) float32
        As :attr:`terrain_lod.Terrain.sky` has them.
    """

    ground: Heightmap
    seen: npt.NDArray[np.float32]

    def on(self, mesh: Mesh) -> npt.NDArray[np.float32]:
        """Return the share of each vertex, that of the sample next to it; (V,)."""
        rows, columns = self.seen.shape
        (dx, dy), (x0, y0) = self.ground.spacing, self.ground.origin
        across = mesh.vertices[:, 0] * np.float32(1 / dx) + np.float32((mesh.origin[0] - x0) / dx)
        down = mesh.vertices[:, 1] * np.float32(-1 / dy) + np.float32((y0 - mesh.origin[1]) / dy)
        column = np.clip(np.rint(across), 0, columns - 1).astype(np.intp)
        row = np.clip(np.rint(down), 0, rows - 1).astype(np.intp)
        shares: npt.NDArray[np.float32] = self.seen[row, column]
        return shares
