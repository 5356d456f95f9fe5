"""How much detail does each tile need? Plane, deviation from it and range, on the device."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from .arguments import one_of
from .device import Device, DeviceArray
from .grid import TileGrid
from .heightmap import Heightmap

PLANES: Final = ("least_squares", "corners")


@dataclass(frozen=True, eq=False)
class TileAnalysis:
    """What the analysis found, tile by tile; NaN where a tile has no data.

    Attributes
    ----------
    grid : TileGrid
    normal : (TR, TC, 3) float32
        Unit normal of the tile's plane; x east, y north, z up.
    height : (TR, TC) float32
        Of the plane at the tile's centre, relative to the heightmap's base.
    deviation : (TR, TC) float32
        Standard deviation (N - 1) of the samples' perpendicular distance to the plane, in the
        raster's unit.
    minimum, maximum : (TR, TC) float32
        Relative to the heightmap's base.
    nodata : (TR, TC) int32
        Samples without data.
    """

    grid: TileGrid
    normal: npt.NDArray[np.float32]
    height: npt.NDArray[np.float32]
    deviation: npt.NDArray[np.float32]
    minimum: npt.NDArray[np.float32]
    maximum: npt.NDArray[np.float32]
    nodata: npt.NDArray[np.int32]

    @classmethod
    def of(
        cls, grid: TileGrid, planes: npt.NDArray[np.float32], details: npt.NDArray[np.float32]
    ) -> TileAnalysis:
        """Return the analysis that the kernel's two outputs, (TR, TC, 4) each, hold."""
        return cls(
            grid,
            normal=planes[..., :3],
            height=planes[..., 3],
            deviation=details[..., 0],
            minimum=details[..., 1],
            maximum=details[..., 2],
            nodata=details[..., 3].astype(np.int32),
        )

    def __repr__(self) -> str:
        rows, columns = self.grid.shape
        return (
            f"TileAnalysis({rows} x {columns} tiles of {self.grid.tile}, "
            f"deviation up to {np.nanmax(self.deviation):g})"
        )


@dataclass(frozen=True, eq=False)
class DeviceGround:
    """A heightmap on the device.

    Attributes
    ----------
    heights : DeviceArray, (R, C) float32
    holes : DeviceArray, (R, C) uint8, or (1,) where data is everywhere
        Not zero where there is no data.
    masked : bool
    """

    heights: DeviceArray
    holes: DeviceArray
    masked: bool

    @classmethod
    def upload(cls, ground: Heightmap, device: Device) -> DeviceGround:
        """Copy `ground` to the device, or refuse it with the bytes wanted and had."""
        masked = ground.mask is not None
        holes = ground.mask if ground.mask is not None else np.zeros(1, bool)
        rows, columns = ground.shape
        device.require(f"a raster of {rows} x {columns}", ground.heights.nbytes, holes.nbytes)
        return cls(device.array(ground.heights), device.array(holes.view(np.uint8)), masked)


@dataclass(frozen=True, eq=False)
class DeviceAnalysis:
    """The analysis on the device.

    Attributes
    ----------
    planes : DeviceArray, (TR, TC, 4) float32
        Unit normal, height at the tile's centre.
    details : DeviceArray, (TR, TC, 4) float32
        Deviation, minimum, maximum, samples without data.
    """

    planes: DeviceArray
    details: DeviceArray

    def host(self, grid: TileGrid) -> TileAnalysis:
        """Bring the analysis down."""
        return TileAnalysis.of(grid, self.planes.host(), self.details.host())


def analyse(
    ground: Heightmap,
    *,
    tile: int = 15,
    plane: str = "least_squares",
    device: Device | None = None,
) -> TileAnalysis:
    """Fit a plane to every tile and measure how far the ground is from it.

    Parameters
    ----------
    ground : Heightmap
    tile : int, optional
        Cells along a tile, 1 to 63.
    plane : {"least_squares", "corners"}, optional
        The best fit, or the mean of the four corner normals as in the source.
    device : Device, optional

    Returns
    -------
    TileAnalysis

    Raises
    ------
    InputError
        If `tile` or `plane` is not one of these.
    DeviceMemoryError
        If the device cannot hold the raster.

    Notes
    -----
    Zink, Pettineo, Hoxley: *Practical Rendering and Computation with Direct3D 11*, section 9.1.2.
    """
    device = device or Device.open()
    grid = TileGrid.of(ground, tile)
    return analyse_on_device(DeviceGround.upload(ground, device), grid, plane=plane).host(grid)


def analyse_on_device(
    ground: DeviceGround, grid: TileGrid, *, plane: str = "least_squares"
) -> DeviceAnalysis:
    """Run the analysis kernel and leave its results on the device."""
    device = ground.heights.device
    corners = one_of("plane", plane, PLANES) == "corners"
    group = device.group_size(64)
    kernel = device.kernel(
        "analysis.cl",
        "analysis",
        TILE=grid.tile,
        GROUP=group,
        CORNERS=int(corners),
        MASKED=int(ground.masked),
    )
    planes = device.empty((*grid.shape, 4), np.float32)
    details = device.empty((*grid.shape, 4), np.float32)
    # a tile a group on a GPU; on a CPU launching a group costs as much as a tile
    groups = grid.count if device.is_gpu else min(grid.count, 256)
    kernel(
        (groups * group,),
        (group,),
        grid=grid.record(),
        heights=ground.heights,
        holes=ground.holes,
        planes=planes,
        details=details,
        scratch=group * 4,
    )
    return DeviceAnalysis(planes, details)
