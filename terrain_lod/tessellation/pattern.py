"""What the tessellator emits: points of the domain and the triangles between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

TOPOLOGIES: Final = ("clockwise", "counter_clockwise")  # with u to the right and v down


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

    @classmethod
    def of(
        cls,
        domain: str,
        partitioning: str,
        points: npt.NDArray[Any],
        primitives: npt.NDArray[Any],
        point_offsets: npt.NDArray[Any],
        primitive_offsets: npt.NDArray[Any],
    ) -> Pattern:
        """Return a pattern of primitives with two corners (lines) or three (triangles)."""
        offsets = primitive_offsets.astype(np.int64)
        nothing = np.zeros_like(offsets)
        lined = primitives.shape[1] == 2
        return cls(
            domain,
            partitioning,
            points,
            triangles=np.empty((0, 3), np.int32) if lined else primitives,
            lines=primitives if lined else np.empty((0, 2), np.int32),
            point_offsets=point_offsets.astype(np.int64),
            triangle_offsets=nothing if lined else offsets,
            line_offsets=offsets if lined else nothing,
        )

    @classmethod
    def of_nothing(cls, domain: str, partitioning: str, corners: int) -> Pattern:
        """Return the pattern of no patches, whose primitives would have so many corners."""
        points, primitives = np.empty((0, 2), np.uint32), np.empty((0, corners), np.int32)
        return cls.of(domain, partitioning, points, primitives, np.zeros(1), np.zeros(1))

    @property
    def primitives(self) -> npt.NDArray[np.int32]:
        """Triangles, or lines in the isoline domain."""
        return self.lines if self.domain == "isoline" else self.triangles

    @property
    def primitive_offsets(self) -> npt.NDArray[np.int64]:
        """Where each patch begins among the primitives; (P + 1,)."""
        return self.line_offsets if self.domain == "isoline" else self.triangle_offsets

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

    def host(self, domain: str, partitioning: str) -> Pattern:
        """Bring the pattern down."""
        return Pattern.of(
            domain,
            partitioning,
            self.points.host(),
            self.primitives.host(),
            self.point_offsets.host(),
            self.primitive_offsets.host(),
        )
