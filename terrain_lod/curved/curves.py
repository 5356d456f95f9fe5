"""Parametric curves through the isoline domain of the tessellator: helices, knots.

A curve is one header, ``kernels/curved/curve/<name>.h``, and one row of :data:`CURVES`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from ..arguments import one_of, positive, whole
from ..device.device import Device
from ..device.layout import PARTITIONINGS
from ..tessellation.pattern import DevicePattern
from ..tessellation.tessellator import tessellate_device
from .shape_numbers import Number, shape_numbers

_MOST_PIECES: Final = 16384  # steps are counted in 32 bits


@dataclass(frozen=True, eq=False)
class Polyline:
    """Points in the order of a curve.

    Attributes
    ----------
    points, tangents : (N, 3) float32
        Tangents have unit length.
    closed : bool
        Whether the last point is the first, to the bit.
    """

    points: npt.NDArray[np.float32]
    tangents: npt.NDArray[np.float32]
    closed: bool

    def __repr__(self) -> str:
        return f"Polyline({len(self.points)} points{', closed' if self.closed else ''})"


class Curve(NamedTuple):
    """What shapes a curve, in the order of the kernel's array, and whether it closes."""

    numbers: dict[str, Number]
    closed: bool


_RADIUS: Final = Number(1.0)
_TUBE: Final = Number(0.4)


def _count(default: int) -> Number:
    return Number(default, low=1.0, high=64.0, step=1.0)


CURVES: Final = {
    "helix": Curve(
        {
            "radius": _RADIUS,
            "pitch": Number(0.5),
            "turns": Number(3.0, low=0.5, high=64.0, step=0.5),
        },
        closed=False,
    ),
    "torus_knot": Curve(
        {"radius": _RADIUS, "tube": _TUBE, "p": _count(2), "q": _count(3)}, closed=True
    ),
    "lissajous": Curve(
        {"size": _RADIUS, "x": _count(3), "y": _count(2), "z": _count(5)}, closed=True
    ),
}


def curve(
    name: str,
    *,
    pieces: int = 16,
    factor: float = 16.0,
    partitioning: str = "integer",
    device: Device | None = None,
    **numbers: float,
) -> Polyline:
    """Return the points of a parametric curve.

    Parameters
    ----------
    name : str
        One of helix, torus_knot, lissajous.
    pieces : int, optional
        Isolines laid end to end.
    factor : float, optional
        Segments of a piece, clamped to the partitioning's range.
    partitioning : {"integer", "pow2", "fractional_odd", "fractional_even"}, optional
    device : Device, optional
    **numbers : float
        What shapes the curve::

            helix       radius=1, pitch=0.5, turns=3      rise a turn; whole or half turns
            torus_knot  radius=1, tube=0.4, p=2, q=3      times around the axis and the tube
            lissajous   size=1, x=3, y=2, z=5             times to and fro along each axis

    Raises
    ------
    InputError
        If a word is unknown, or a number is not in its range.
    DeviceMemoryError
        If the points do not fit the device.

    Examples
    --------
    >>> curve("torus_knot", pieces=16, factor=16)
    Polyline(257 points, closed)
    """
    one_of("curve", name, CURVES)
    one_of("partitioning", partitioning, PARTITIONINGS)
    shape = shape_numbers(name, CURVES[name].numbers, numbers)
    pieces = whole("pieces", pieces, 1, _MOST_PIECES)
    factor = positive("factor", factor)
    device = device or Device.open()
    # one line a piece
    factors = np.tile(np.array([1.0, factor], np.float32), (pieces, 1))
    pattern = tessellate_device(
        "isoline", device.array(factors), None, partitioning, clockwise=True
    )
    positions, tangents = _evaluated(name, shape, pattern, device)
    # a piece begins where the one before ends
    kept = np.ones(len(positions), bool)
    kept[pattern.point_offsets.host()[1:-1] - 1] = False
    return Polyline(positions[kept], tangents[kept], CURVES[name].closed)


def _evaluated(
    name: str, shape: Mapping[str, float], pattern: DevicePattern, device: Device
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Return positions and tangents of all points, (N, 3)."""
    count, pieces = pattern.points.shape[0], pattern.point_offsets.size - 1
    device.require(f"{count} points of a curve", 12 * count, 12 * count)
    positions, tangents = (device.empty((count, 3), np.float32) for _ in range(2))
    group = device.group_size(64)
    kernel = device.kernel(
        "curved/curve.cl",
        "curve_points",
        GROUP=group,
        CURVE=f'"curved/curve/{name}.h"',
        CLOSED=int(CURVES[name].closed),
        **{number.upper(): index for index, number in enumerate(shape)},
    )
    kernel(
        (pieces * group,),
        (group,),
        pieces=pieces,
        shape=device.array(np.array(list(shape.values()), np.float32)),
        point_offsets=pattern.point_offsets,
        points=pattern.points,
        positions=positions,
        tangents=tangents,
    )
    return positions.host(), tangents.host()
