"""Bézier curves of any degree, piece by piece, through the isoline domain of the tessellator."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import array, one_of, positive
from ..device.device import Device
from ..device.layout import PARTITIONINGS
from ..errors import InputError
from ..tessellation.tessellator import tessellate_device
from .curves import Polyline
from .patch_factors import MAX_FACTOR

_HIGHEST: Final = 32


def bezier_curve(
    points: npt.ArrayLike,
    *,
    factor: float = 5.0,
    partitioning: str = "fractional_odd",
    device: Device | None = None,
) -> Polyline:
    """Return the points of a Bézier curve, or of several laid end to end.

    Parameters
    ----------
    points : (N + 1, 3) or (K, N + 1, 3) array_like
        Control points of a piece of degree N, 1 to 32, or of K pieces.
    factor : float, optional
        Segments of a piece, clamped to the partitioning's range.
    partitioning : {"integer", "pow2", "fractional_odd", "fractional_even"}, optional
    device : Device, optional

    Returns
    -------
    Polyline
        Where a piece begins at the point where the one before ends, that point is there once, with
        the tangent of the later piece; :func:`terrain_lod.curved.curve_continuity` measures joints.

    Raises
    ------
    InputError
        If the control points are not such, or not finite in float32; if a word is unknown, or the
        factor not positive.
    DeviceMemoryError
        If the points do not fit the device.

    Examples
    --------
    >>> bezier_curve([(0, 0, 0), (1, 2, 0), (2, 0, 0)], factor=4, partitioning="integer")
    Polyline(5 points)
    """
    pieces = as_pieces(points)
    one_of("partitioning", partitioning, PARTITIONINGS)
    factor, (count, order) = min(positive("factor", factor), MAX_FACTOR), pieces.shape[:2]
    device = Device.of(device)
    controls = np.zeros((count, order, 4), np.float32)
    controls[..., :3] = pieces
    factors = np.tile(np.array([1.0, factor], np.float32), (count, 1))
    pattern = tessellate_device(
        "isoline", device.array(factors), None, partitioning, clockwise=True
    )
    total = pattern.points.shape[0]
    device.require(f"{total} points of a curve", 12 * total, 12 * total)
    positions, tangents = (device.empty((total, 3), np.float32) for _ in range(2))
    group = device.group_size(64)
    device.kernel("curved/bezier_curve.cl", "bezier_curve", GROUP=group, DEGREE=order - 1)(
        (count * group,),
        (group,),
        pieces=count,
        controls=device.array(controls),
        point_offsets=pattern.point_offsets,
        points=pattern.points,
        positions=positions,
        tangents=tangents,
    )
    found, along = positions.host(), tangents.host()
    ends = pattern.point_offsets.host()[1:-1].astype(np.int64) - 1
    kept = np.ones(total, bool)
    kept[ends[(found[ends] == found[ends + 1]).all(axis=1)]] = False
    closed = bool((found[0] == found[-1]).all()) and total > 2
    return Polyline(found[kept], along[kept], closed)


def as_pieces(points: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return control points as (K, N + 1, 3), or say what does not fit."""
    given = array("control points", points, (...,))
    pieces = given[None] if given.ndim == 2 else given
    if pieces.ndim != 3 or pieces.shape[2] != 3 or not 2 <= pieces.shape[1] <= _HIGHEST + 1:
        raise InputError(
            f"expected control points (N + 1, 3) or (K, N + 1, 3) of degrees 1 to {_HIGHEST}, got "
            f"shape {given.shape}"
        )
    if not len(pieces) or not (abs(pieces) <= np.finfo(np.float32).max).all():
        raise InputError("expected pieces with control points that are finite in float32")
    return pieces
