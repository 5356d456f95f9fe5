"""What the tessellator emits: points of the domain and the triangles between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True, eq=False)
class Pattern:
    """Tessellation patterns of P patches, one after the other.

    Attributes
    ----------
    domain, partitioning : str
    points : (N, 2) uint32
        u, v in 16.16 fixed point; in the triangle domain w = 65536 - u - v.
    triangles : (M, 3) int32
        Indices into `points`; empty for isolines.
    lines : (L, 2) int32
        Indices into `points`; empty for quads and triangles.
    point_offsets, triangle_offsets, line_offsets : (P + 1,) int64
        Where each patch begins in the arrays above.
    """

    domain: str
    partitioning: str
    points: npt.NDArray[np.uint32]
    triangles: npt.NDArray[np.int32]
    lines: npt.NDArray[np.int32]
    point_offsets: npt.NDArray[np.int64]
    triangle_offsets: npt.NDArray[np.int64]
    line_offsets: npt.NDArray[np.int64]

    @property
    def patch_count(self) -> int:
        return len(self.point_offsets) - 1

    def __repr__(self) -> str:
        return (
            f"Pattern({self.domain}, {self.partitioning}: {self.patch_count} patches, "
            f"{len(self.points)} points, {len(self.triangles)} triangles, {len(self.lines)} lines)"
        )


@dataclass(frozen=True, eq=False)
class DevicePattern:
    """The same on the device, where the domain stage takes it from.

    Attributes
    ----------
    points : DeviceArray, (N, 2) uint32
    primitives : DeviceArray, (M, 3) or (L, 2) int32
    point_offsets, primitive_offsets : DeviceArray, (P + 1,) uint32
    """

    points: Any
    primitives: Any
    point_offsets: Any
    primitive_offsets: Any
