"""How much detail does each tile need? Plane, deviation from it and range, on the device."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import one_of
from ..device.device import Device
from ..ground.grid import TileGrid
from ..ground.heightmap import Heightmap
from ..ground.relief import Relief
from .buffers import DeviceAnalysis, DeviceGround

PLANES: Final = ("least_squares", "corners")

_GROUP: Final = 64  # work-items, one for each column of a few tiles
_RUN: Final = 64  # tiles that an item of a CPU goes through
_REST: Final = 4096  # groups for tiles that are left, as far as there are any


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
    def of(cls, grid: TileGrid, analysis: DeviceAnalysis) -> TileAnalysis:
        """Bring down what the kernel found."""
        planes, details = analysis.planes.host(), analysis.details.host()
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
    one_of("plane", plane, PLANES)
    uploaded = DeviceGround.upload(Relief(ground), tile, Device.of(device))
    return TileAnalysis.of(uploaded.grid, analyse_on_device(uploaded, plane=plane))


def analyse_on_device(ground: DeviceGround, *, plane: str = "least_squares") -> DeviceAnalysis:
    """Run the analysis kernel and leave its results on the device."""
    shape = (*ground.grid.shape, 4)
    planes, details = (ground.device.empty(shape, np.float32) for _ in range(2))
    analysis = DeviceAnalysis(one_of("plane", plane, PLANES), planes, details)
    analyse_tiles(ground, analysis)
    return analysis


def analyse_tiles(
    ground: DeviceGround,
    analysis: DeviceAnalysis,
    numbers: npt.NDArray[np.int32] | None = None,
) -> None:
    """Analyse all tiles, or some by their numbers, into what is known of all."""
    device, grid = ground.device, ground.grid
    group = device.group_size(_GROUP)
    # tiles that a group fits at once, of a row of the grid or of the list
    rows, count = (grid.shape[0], grid.shape[1]) if numbers is None else (1, len(numbers))
    at_once = _RUN if group == 1 else group // _columns(grid.tile)
    defines = {
        "TILE": grid.tile,
        "GROUP": group,
        "LANES": device.lanes if group == 1 else 1,
        "CORNERS": int(analysis.plane == "corners"),
        "LISTED": int(numbers is not None),
        **ground.defines,
    }
    left = device.empty(1 + rows * count, np.int32)
    left.write([0])
    results = {"left": left, "planes": analysis.planes, "details": analysis.details}
    kernel = device.kernel("terrain/analysis.cl", "analysis", **defines)
    kernel(
        (-(-count // at_once) * group, rows),
        (group, 1),
        **ground.arguments,
        count=count,
        tiles=device.array(np.zeros(1, np.int32) if numbers is None else numbers),
        **results,
    )
    kernel = device.kernel("terrain/analysis.cl", "analysis_of_the_rest", **defines)
    kernel(
        (device.runs(min(rows * count, _REST)) * group,), (group,), **ground.arguments, **results
    )


def _columns(tile: int) -> int:
    """Return the power of two that holds a row of a tile's samples, at least 4."""
    return max(4, 1 << tile.bit_length())
