"""What stages hand to each other on the device: small records of arrays."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..device.device import Device, DeviceArray
from ..ground.grid import TileGrid
from ..ground.relief import Relief


@dataclass(frozen=True, eq=False)
class DeviceGround:
    """A heightmap, what is laid over it, and how it is cut into tiles.

    Attributes
    ----------
    relief : Relief
        What was uploaded.
    grid : TileGrid
        Of the sum of heightmap and detail: R x C samples, TR x TC tiles, P of them.
    heights : DeviceArray, float32
        Of the heightmap, as it is.
    holes : DeviceArray, uint8, as `heights`, or (1,) where data is everywhere
        Not zero where there is no data.
    detail : DeviceArray, (DR, DC) float32, or None
        Added to the heights, see :class:`~terrain_lod.ground.relief.Relief`.
    """

    relief: Relief
    grid: TileGrid
    heights: DeviceArray
    holes: DeviceArray
    detail: DeviceArray | None

    @classmethod
    def upload(cls, relief: Relief, tile: int, device: Device) -> DeviceGround:
        """Copy `relief` to the device, or refuse it with the bytes wanted and had."""
        ground, detail = relief.ground, relief.detail
        holes = np.zeros(1, bool) if ground.mask is None else ground.mask
        rows, columns = ground.shape
        device.require(f"a raster of {rows} x {columns}", ground.heights.nbytes, holes.nbytes)
        return cls(
            relief,
            TileGrid.of(relief, tile),
            device.array(ground.heights),
            device.array(holes.view(np.uint8)),
            None if detail is None else device.array(detail.heights),
        )

    def updated(self, relief: Relief, rows: slice) -> DeviceGround:
        """Rewrite it for a relief that differs in `rows` of its heightmap alone."""
        mask, start = relief.ground.mask, rows.start * relief.ground.shape[1]
        holes = self.holes
        if mask is not None and self.masked:
            holes.write(mask[rows].view(np.uint8), start)
        elif mask is not None or self.masked:
            whole = np.zeros(1, bool) if mask is None else mask
            holes = self.device.array(whole.view(np.uint8))
        self.heights.write(relief.ground.heights[rows], start)
        return replace(self, relief=relief, holes=holes)

    @property
    def device(self) -> Device:
        return self.heights.device

    @property
    def masked(self) -> bool:
        """Whether data is missing anywhere."""
        return self.relief.ground.mask is not None

    @property
    def origin(self) -> tuple[float, float, float]:
        """World point that everything on the device is relative to."""
        return (*self.relief.ground.origin, self.relief.base)

    @property
    def arguments(self) -> dict[str, Any]:
        """What every kernel that reads the ground takes of it, by the names of its arguments."""
        detail = self.heights if self.detail is None else self.detail
        return {
            "grid": self.grid.record(),
            "heights": self.heights,
            "holes": self.holes,
            "detail_heights": detail,
        }

    @property
    def defines(self) -> dict[str, int]:
        """What every kernel that reads the ground is built with; ``kernels/terrain/ground.h``."""
        if self.detail is None:
            return {"MASKED": int(self.masked), "DETAIL": 0}
        (across, down), (rows, columns) = self.relief.steps, self.detail.shape
        return {
            "MASKED": int(self.masked),
            "DETAIL": 1,
            "STEPS_ACROSS": across,
            "STEPS_DOWN": down,
            "DETAIL_ROWS": rows,
            "DETAIL_COLUMNS": columns,
        }


@dataclass(frozen=True, eq=False)
class DeviceAnalysis:
    """What the analysis found of every tile.

    Attributes
    ----------
    plane : str
        Which plane deviations are from.
    planes : DeviceArray, (TR, TC, 4) float32
        Unit normal, height at the tile's centre.
    details : DeviceArray, (TR, TC, 4) float32
        Deviation, minimum, maximum, samples without data.
    """

    plane: str
    planes: DeviceArray
    details: DeviceArray


@dataclass(frozen=True, eq=False)
class PatchSet:
    """P patches as kernels see them that know where the points of a pattern lie.

    Attributes
    ----------
    ground : DeviceGround
    header : str
        File of ``kernels/`` that says what a patch is.
    count : int
        P.
    arguments : dict of str to object
        What this header wants.
    details : DeviceArray
        By the numbers that the header gives patches: drift, minimum, maximum, samples without data.
    is_lifted : bool
        Whether points of the pattern stand off the ground.
    """

    ground: DeviceGround
    header: str
    count: int
    arguments: dict[str, Any]
    details: DeviceArray
    is_lifted: bool = False

    def lifted(self, lifts: DeviceArray) -> PatchSet:
        """Return the same with points so far above the ground; (N,) float32."""
        return replace(self, arguments={**self.arguments, "lifts": lifts}, is_lifted=True)

    @property
    def device(self) -> Device:
        return self.ground.device

    @property
    def defines(self) -> dict[str, int | str]:
        """What these kernels are built with."""
        tile = self.ground.grid.tile
        return {
            "PATCHES": f'"{self.header}"',
            "TILE": tile,
            "FINER": lattice_levels(tile),
            "LIFTED": int(self.is_lifted),
            **self.ground.defines,
        }


def lattice_levels(tile: int) -> int:
    """Return how many times finer, as a power of two, a node's lattice is than its finest pattern.

    Four times, as long as that is no more than 65 samples along a side.
    """
    return 2 if tile <= 16 else 1 if tile <= 32 else 0


@dataclass(frozen=True, eq=False)
class DevicePatches:
    """The hull stage's input.

    Attributes
    ----------
    control_points : DeviceArray, (TR + 1, TC + 1, 4) float32
        x, y, z relative to the terrain's origin and base, and 1.
    indices : DeviceArray, (P, 12) int32
    """

    control_points: DeviceArray
    indices: DeviceArray


@dataclass(frozen=True, eq=False)
class DeviceLadder:
    """Errors of every tile and every edge, in the raster's unit.

    Level k is the factor 2 k + 1, or the tile's cells where it has fewer.

    Attributes
    ----------
    tiles : DeviceArray, (P, L, L) float32
        Largest vertical error of the tile at level pair [along v, along u], its edges matching.
    inner : DeviceArray, (P, L, L) float32
        The same within the lattice that other edges would leave as it is.
    across : DeviceArray, ((TR + 1) * TC, L) float32
        Of the edges that run along u, row by row.
    down : DeviceArray, (TR * (TC + 1), L) float32
        Of the edges that run along v.
    order : DeviceArray, (L * L,) int32
        Level pairs, L v + u, the fewest triangles first.
    """

    tiles: DeviceArray
    inner: DeviceArray
    across: DeviceArray
    down: DeviceArray
    order: DeviceArray

    def measured(self) -> dict[str, DeviceArray]:
        """Return the arrays that are measured, by their names."""
        return {name: getattr(self, name) for name in ("tiles", "inner", "across", "down")}
