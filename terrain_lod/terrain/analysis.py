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
    analyse_tiles(ground, analysis, np.arange(ground.grid.count, dtype=np.int32))
    return analysis


def analyse_tiles(
    ground: DeviceGround, analysis: DeviceAnalysis, numbers: npt.NDArray[np.int32]
) -> None:
    """Analyse some tiles, by their numbers, into what is known of all."""
    device = ground.device
    group = device.group_size(64)
    kernel = device.kernel(
        "terrain/analysis.cl",
        "analysis",
        TILE=ground.grid.tile,
        GROUP=group,
        CORNERS=int(analysis.plane == "corners"),
        **ground.defines,
    )
    kernel(
        (device.runs(len(numbers)) * group,),
        (group,),
        **ground.arguments,
        count=len(numbers),
        tiles=device.array(numbers),
        planes=analysis.planes,
        details=analysis.details,
        scratch=group * 6 * 4,
    )
