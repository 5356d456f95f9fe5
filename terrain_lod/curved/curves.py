"""Parametric curves through the isoline domain of the tessellator: helices, knots.

A curve is one header of ``kernels/curved/curve/`` and one row of :data:`CURVES`; one from
elsewhere is a :class:`ParametricCurve` with the path of its header: docs/own_lod.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Final

import numpy as np
import numpy.typing as npt

from ..arguments import flag, one_of, positive, whole
from ..device.device import Device
from ..device.formulas import formula_defines, formula_numbers
from ..device.layout import PARTITIONINGS
from ..numbered import Number
from ..tessellation.pattern import DevicePattern
from ..tessellation.tessellator import tessellate_device
from .parametric import Parametric, named, shape_numbers

# arguments of curve(), and what its kernel is built with
_TAKEN: Final = ("pieces", "factor", "partitioning", "device", "group", "curve", "closed")
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


@dataclass(frozen=True)
class ParametricCurve(Parametric):
    """A curve: the header with its formula, and what the host must know of it.

    Attributes
    ----------
    header : str or pathlib.Path
        What defines its ``curve()``: a file of ``kernels/``, or the path of any other.
    numbers : dict of str to Number
        What shapes it: the header reads a number ``radius`` as ``shape[RADIUS]``.
    closed : bool
        Whether its end is its beginning.

    Raises
    ------
    InputError
        If a number's name is taken by an argument of :func:`curve`.
    """

    closed: bool = False
    taken: ClassVar[tuple[str, ...]] = _TAKEN

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "closed", flag("closed", self.closed))


_LARGEST: Final = 1e18  # squares are still finite
_RADIUS: Final = Number(1.0, high=_LARGEST)
_TUBE: Final = Number(0.4, high=_LARGEST)


def _count(default: int) -> Number:
    return Number(default, low=1.0, high=64.0, step=1.0)


CURVES: Final = {
    "helix": ParametricCurve(
        "curved/curve/helix.h",
        {
            "radius": _RADIUS,
            "pitch": Number(0.5, high=_LARGEST),
            "turns": Number(3.0, low=0.5, high=64.0, step=0.5),
        },
        closed=False,
    ),
    "torus_knot": ParametricCurve(
        "curved/curve/torus_knot.h",
        {"radius": _RADIUS, "tube": _TUBE, "p": _count(2), "q": _count(3)},
        closed=True,
    ),
    "lissajous": ParametricCurve(
        "curved/curve/lissajous.h",
        {"size": _RADIUS, "x": _count(3), "y": _count(2), "z": _count(5)},
        closed=True,
    ),
}


def curve(
    shape: str | ParametricCurve,
    /,
    *,
    pieces: int = 16,
    factor: float = 5.0,
    partitioning: str = "fractional_odd",
    device: Device | None = None,
    **numbers: float,
) -> Polyline:
    """Return the points of a parametric curve.

    Parameters
    ----------
    shape : str or ParametricCurve
        helix, torus_knot, lissajous, or one of your own.
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
    >>> curve("torus_knot", pieces=16, factor=5)
    Polyline(81 points, closed)
    """
    kind = named("curve", shape, CURVES, ParametricCurve)
    one_of("partitioning", partitioning, PARTITIONINGS)
    given = shape_numbers(kind, numbers)
    pieces = whole("pieces", pieces, 1, _MOST_PIECES)
    factor = positive("factor", factor)
    device = Device.of(device)
    # one line a piece
    with np.errstate(over="ignore"):  # to infinity, which is clamped
        factors = np.tile(np.array([1.0, factor], np.float32), (pieces, 1))
    pattern = tessellate_device(
        "isoline", device.array(factors), None, partitioning, clockwise=True
    )
    positions, tangents = _evaluated(kind, given, pattern, device)
    # a piece begins where the one before ends
    kept = np.ones(len(positions), bool)
    kept[pattern.point_offsets.host()[1:-1] - 1] = False
    return Polyline(positions[kept], tangents[kept], kind.closed)


def _evaluated(
    kind: ParametricCurve, given: Mapping[str, float], pattern: DevicePattern, device: Device
) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]:
    """Return positions and tangents of all points, (N, 3)."""
    count, pieces = pattern.points.shape[0], pattern.point_offsets.size - 1
    device.require(f"{count} points of a curve", 12 * count, 12 * count)
    positions, tangents = (device.empty((count, 3), np.float32) for _ in range(2))
    group = device.group_size(64)
    defines = {
        **formula_defines("CURVE", kind.header, given),
        "CLOSED": int(kind.closed),
        "GROUP": group,
    }
    kernel = device.kernel("curved/curve.cl", "curve_points", **defines)
    kernel(
        (pieces * group,),
        (group,),
        pieces=pieces,
        shape=formula_numbers(device, given),
        point_offsets=pattern.point_offsets,
        points=pattern.points,
        positions=positions,
        tangents=tangents,
    )
    return positions.host(), tangents.host()
