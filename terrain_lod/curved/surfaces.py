"""Parametric surfaces through the tessellator: spheres, tori, one-sided strips, shells.

A surface is one header, ``kernels/curved/surface/<name>.h``, and one row of :data:`SURFACES`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Final, NamedTuple

import numpy as np

from ..arguments import one_of, whole
from ..device.device import Device
from ..errors import InputError
from ..mesh.mesh import Mesh
from ..mesh.vertices import DeviceVertices
from ..tessellation.pattern import DevicePattern
from .shape_numbers import Number, shape_numbers
from .uniform_quads import Evaluate, uniform_mesh

_MOST_PATCHES: Final = 16384  # along u or v: steps are counted in 32 bits


class Surface(NamedTuple):
    """What the host must know of a surface.

    Attributes
    ----------
    numbers : dict of str to Number
        What shapes it, in the order of the kernel's array.
    closed : str
        Those of u and v whose end is their beginning.
    twisted : bool
        Whether u comes back with v turned round.
    """

    numbers: dict[str, Number]
    closed: str = ""
    twisted: bool = False


_RADIUS: Final = Number(1.0)
_EXPONENT: Final = Number(0.4, low=0.1, high=2.0)
# half turns are counted in whole numbers
_TURNS: Final = Number(2.0, low=0.5, high=64.0, step=0.5)

SURFACES: Final = {
    "sphere": Surface({"radius": _RADIUS}, closed="u"),
    "torus": Surface({"radius": _RADIUS, "tube": Number(0.4)}, closed="uv"),
    "moebius": Surface({"radius": _RADIUS, "width": Number(0.6)}, closed="u", twisted=True),
    "klein": Surface({"radius": Number(2.0), "size": _RADIUS}, closed="uv", twisted=True),
    "helicoid": Surface({"radius": _RADIUS, "pitch": Number(1.0), "turns": _TURNS}),
    "seashell": Surface(
        {
            "turns": Number(4.0, low=0.5, high=64.0, step=0.5),
            "growth": Number(2.0, low=1.01, high=100.0),
            "tube": Number(0.5),
            "height": Number(1.2, low=0.0),
        },
        closed="v",
    ),
    "superquadric": Surface(
        {"radius": _RADIUS, "along": _EXPONENT, "across": _EXPONENT}, closed="u"
    ),
}


def surface(
    name: str,
    *,
    patches: tuple[int, int] = (8, 4),
    factor: float = 5.0,
    partitioning: str = "fractional_odd",
    device: Device | None = None,
    **numbers: float,
) -> Mesh:
    """Return the mesh of a parametric surface.

    Parameters
    ----------
    name : str
        One of sphere, torus, moebius, klein, helicoid, seashell, superquadric.
    patches : (int, int), optional
        Quads along u and along v.
    factor : float, optional
        Tessellation factor of all edges and insides, clamped to the partitioning's range.
    partitioning : {"integer", "pow2", "fractional_odd", "fractional_even"}, optional
    device : Device, optional
    **numbers : float
        What shapes the surface, in any unit of length::

            sphere        radius=1
            torus         radius=1, tube=0.4             radii of the ring and of its tube
            moebius       radius=1, width=0.6
            klein         radius=2, size=1               figure-eight immersion
            helicoid      radius=1, pitch=1, turns=2     rise a turn; whole or half turns
            seashell      turns=4, growth=2, tube=0.5, height=1.2
            superquadric  radius=1, along=0.4, across=0.4         exponents, 1 is a sphere

    Returns
    -------
    Mesh
        Patches that meet have the same vertices to the bit, also where the surface closes. Normals
        are the surface's own, towards dP/du × dP/dv; triangles are counter-clockwise seen from
        there. One-sided surfaces turn their normals over at u = 0.

    Raises
    ------
    InputError
        If a word is unknown, or a number is not in its range.
    DeviceMemoryError
        If the mesh does not fit the device.

    Examples
    --------
    >>> surface("torus", patches=(8, 4), factor=5, tube=0.3)
    Mesh(1152 vertices, 1600 triangles)
    """
    one_of("surface", name, SURFACES)
    shape = shape_numbers(name, SURFACES[name].numbers, numbers)
    across, down = (
        whole("patches", count, 1, _MOST_PATCHES) for count in _pair("patches", patches)
    )
    device = device or Device.open()
    evaluate = _evaluation(name, (across, down), shape, device)
    return uniform_mesh(across * down, factor, partitioning, device, evaluate)


def _evaluation(
    name: str, patches: tuple[int, int], shape: Mapping[str, float], device: Device
) -> Evaluate:
    """Return what puts the points of a pattern on the surface."""
    closed, (across, down) = SURFACES[name].closed, patches

    def evaluate(pattern: DevicePattern, vertices: DeviceVertices, items: int, group: int) -> None:
        kernel = device.kernel(
            "curved/surface.cl",
            "surface_points",
            GROUP=group,
            SURFACE=f'"curved/surface/{name}.h"',
            CLOSED_U=int("u" in closed),
            CLOSED_V=int("v" in closed),
            TWISTED=int(SURFACES[name].twisted),
            **{number.upper(): index for index, number in enumerate(shape)},
        )
        kernel(
            (items,),
            (group,),
            across=across,
            down=down,
            shape=device.array(np.array(list(shape.values()), np.float32)),
            point_offsets=pattern.point_offsets,
            points=pattern.points,
            positions=vertices.positions,
            normals=vertices.normals,
        )

    return evaluate


def _pair(name: str, values: Iterable[int]) -> tuple[int, ...]:
    """Return two values, or say that two were expected."""
    pair = tuple(values) if isinstance(values, Iterable) else ()
    if len(pair) != 2:
        raise InputError(f"expected two numbers for {name}, got {values!r}")
    return pair
