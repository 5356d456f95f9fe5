"""How far is a mesh from the ground? Measured at every sample, from the triangles alone."""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..arguments import flag, instance
from ..device.device import Device, DeviceArray, Kernel
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh
from ..mesh.soundness import sound_mesh
from ..reference.measure.error import NEAR, SINGLE
from ..reference.measure.error import error_field as reference_field

_log = logging.getLogger(__name__)

# samples that one work-item looks at before a triangle is split
_BAND: Final = 1024


@dataclass(frozen=True)
class VerticalError:
    """Height of a mesh above the ground, over the samples that it covers.

    Attributes
    ----------
    maximum : float
        Largest distance up or down, in the raster's unit; NaN where no sample is covered.
    rms, mean : float
        Root of the mean square, and the mean: above 0 where the mesh lies above the ground.
    where : (int, int) or None
        Row and column of the sample that is farthest off, the first of equals.
    point : (float, float) or None
        World x and y of that sample.
    samples, uncovered : int
        Samples with data that were measured, and those under no triangle: outside the mesh, in
        a culled patch, next to nodata.
    field : (R, C) float32 or None
        Mesh minus ground, NaN where not measured; if asked for.
    """

    maximum: float
    rms: float
    mean: float
    where: tuple[int, int] | None
    point: tuple[float, float] | None
    samples: int
    uncovered: int
    field: npt.NDArray[np.float32] | None = field(default=None, repr=False, compare=False)

    def __str__(self) -> str:
        outside = f", {self.uncovered} samples not covered" if self.uncovered else ""
        if self.where is None:
            return f"no sample measured{outside}"
        row, column = self.where
        return (
            f"largest error {self.maximum:.4g} at [{row}, {column}], RMS {self.rms:.4g}, "
            f"mean {self.mean:.4g} over {self.samples} samples{outside}"
        )


def vertical_error(
    mesh: Mesh, ground: Heightmap, *, field: bool = False, device: Device | None = None
) -> VerticalError:
    """Measure the vertical distance between a mesh and the ground at every sample.

    A sample is measured in every triangle whose closed footprint contains it, and the largest
    distance counts: what is left is the surface at its worst, cracks included. Only positions and
    corners are used, so any mesh over the ground can be measured, whoever made it. Walls, and
    triangles thinner than 2^-26 cells seen from above, cover nothing.

    Parameters
    ----------
    mesh : Mesh
        In the same world as `ground`; the origins may differ.
    ground : Heightmap
    field : bool, optional
        Also return the error of each sample.
    device : Device, optional

    Returns
    -------
    VerticalError

    Raises
    ------
    InputError
        If the mesh has positions that are not finite or corners that are no vertices.
    DeviceMemoryError
        If the device cannot hold mesh and raster.

    Notes
    -----
    Computed in 64 bits and rounded to float32 once: an error is right to half a unit in its last
    place, given the positions. Of these, columns and rows within a relative 2^-23 of a whole
    number, which is what float32 tells apart, are that number; a crossing of an edge with a row
    within 2^-26 cells. A device without 64-bit floats leaves the work to NumPy.
    """
    mesh, ground = sound_mesh(mesh), instance("a Heightmap for ground", ground, Heightmap)
    keep, device = flag("field", field), Device.of(device)
    if device.has_doubles:
        errors = _field_on_device(mesh, ground, device).host()
    else:
        _log.info("%s has no 64-bit floats: measuring with NumPy", device.info.name)
        errors = reference_field(mesh, ground).astype(np.float32)
    return _summary(errors, ground, keep=keep)


def _summary(errors: npt.NDArray[np.float32], ground: Heightmap, *, keep: bool) -> VerticalError:
    """Return the numbers that describe a field of errors."""
    measured = errors[~np.isnan(errors)].astype(np.float64)
    samples = len(measured)
    with_data = int(np.count_nonzero(ground.valid))
    worst, where, point = np.nan, None, None
    if samples:
        index = int(np.nanargmax(np.abs(errors)))
        row, column = divmod(index, ground.shape[1])
        worst, where = float(abs(errors[row, column])), (row, column)
        (x0, y0), (dx, dy) = ground.origin, ground.spacing
        point = x0 + column * dx, y0 - row * dy
    return VerticalError(
        maximum=worst,
        rms=float(np.sqrt(np.mean(np.square(measured)))) if samples else np.nan,
        mean=float(np.mean(measured)) if samples else np.nan,
        where=where,
        point=point,
        samples=samples,
        uncovered=with_data - samples,
        field=errors if keep else None,
    )


def _field_on_device(mesh: Mesh, ground: Heightmap, device: Device) -> DeviceArray:
    """Upload mesh and ground and return the (R, C) float32 field, mesh minus ground."""
    vertices, triangles, heights = mesh.vertices, mesh.triangles, ground.heights
    if ground.mask is not None:
        heights = np.where(ground.mask, np.float32(np.nan), heights)
    device.require(
        f"measuring {mesh!r} on a raster of {ground.shape[0]} x {ground.shape[1]}",
        *(vertices.nbytes, 2 * vertices.nbytes, triangles.nbytes),
        *(3 * [heights.nbytes]),
    )
    placed = _place(device.array(vertices), mesh, ground)
    return _rasterise(device.array(triangles), placed, device.array(heights))


def _place(vertices: DeviceArray, mesh: Mesh, ground: Heightmap) -> DeviceArray:
    """Return column, row and height above the ground's base of each vertex; (V, 3) float64."""
    placed = vertices.device.empty(vertices.shape, np.float64)
    _kernel(vertices.device, "place")(
        (len(mesh.vertices),),
        (64,),
        count=len(mesh.vertices),
        shift_x=float(mesh.origin[0] - ground.origin[0]),
        shift_y=float(mesh.origin[1] - ground.origin[1]),
        shift_z=float(mesh.origin[2] - ground.base),
        dx=ground.spacing[0],
        dy=ground.spacing[1],
        vertices=vertices,
        placed=placed,
    )
    return placed


def _rasterise(triangles: DeviceArray, placed: DeviceArray, heights: DeviceArray) -> DeviceArray:
    """Return the largest error over each sample; (R, C) float32, NaN where there is none."""
    device = triangles.device
    count, (rows, columns) = triangles.shape[0], heights.shape
    keys = device.zeros(heights.shape, np.uint32)
    band_count = device.zeros(1, np.uint32)
    mesh: dict[str, Any] = {"triangles": triangles, "placed": placed}
    mesh |= {"rows": rows, "columns": columns}
    _kernel(device, "measure")(
        (count,), (64,), count=count, heights=heights, keys=keys, band_count=band_count, **mesh
    )
    # triangles over many samples: count, allocate exactly, fill
    total = int(band_count.host()[0])
    if total:
        bands = device.empty((total, 2), np.int32)
        band_count.fill(0)
        _kernel(device, "list_bands")(
            (count,), (64,), count=count, bands=bands, band_count=band_count, **mesh
        )
        _kernel(device, "measure_bands")(
            (total,), (64,), count=total, heights=heights, bands=bands, keys=keys, **mesh
        )
    errors = device.empty(heights.shape, np.float32)
    _kernel(device, "read_keys")(
        (heights.size,), (64,), count=heights.size, keys=keys, errors=errors
    )
    return errors


def _kernel(device: Device, name: str) -> Kernel:
    return device.kernel("measure/vertical_error.cl", name, NEAR=NEAR, SINGLE=SINGLE, BAND=_BAND)
