"""Parametric surfaces through the tessellator: spheres, tori, one-sided strips, shells.

A surface is one header of ``kernels/curved/surface/`` and one row of :data:`SURFACES`; one from
elsewhere is a :class:`ParametricSurface` with the path of its header: docs/own_lod.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Final

from ..arguments import flag, parts, text, told, whole
from ..device.device import Device
from ..device.formulas import formula_defines, formula_numbers
from ..errors import InputError
from ..mesh.mesh import Mesh
from ..mesh.vertices import DeviceVertices
from ..numbered import Number
from ..tessellation.pattern import DevicePattern
from .parametric import Parametric, named, shape_numbers
from .quads import Evaluate, uniform_mesh

# arguments of surface(), and what its kernel is built with
_TAKEN: Final = ("patches", "factor", "partitioning", "device", "group", "surface", "twisted")
_MOST_PATCHES: Final = 16384  # along u or v: steps are counted in 32 bits


@dataclass(frozen=True)
class ParametricSurface(Parametric):
    """A surface: the header with its formula, and what the host must know of it.

    Attributes
    ----------
    header : str or pathlib.Path
        What defines its ``surface()``: a file of ``kernels/``, or the path of any other.
    numbers : dict of str to Number
        What shapes it: the header reads a number ``radius`` as ``shape[RADIUS]``.
    closed : str
        Those of u and v whose end is their beginning: ``""``, ``"u"``, ``"v"`` or ``"uv"``.
    twisted : bool
        Whether u comes back with v turned round.

    Raises
    ------
    InputError
        If `closed` is another word, the surface is twisted and not closed along u, or a number's
        name is taken by an argument of :func:`surface`.
    """

    closed: str = ""
    twisted: bool = False
    taken: ClassVar[tuple[str, ...]] = _TAKEN

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "closed", text("closed", self.closed))
        if self.closed not in ("", "u", "v", "uv"):
            raise InputError(f"expected closed to be '', 'u', 'v' or 'uv', got {told(self.closed)}")
        object.__setattr__(self, "twisted", flag("twisted", self.twisted))
        if self.twisted and "u" not in self.closed:
            raise InputError(f"expected a twisted surface to be closed in u, got {self.closed!r}")


_LARGEST: Final = 1e18  # squares are still finite
_RADIUS: Final = Number(1.0, high=_LARGEST)
_EXPONENT: Final = Number(0.4, low=0.1, high=2.0)
# half turns are counted in whole numbers
_TURNS: Final = Number(2.0, low=0.5, high=64.0, step=0.5)

SURFACES: Final = {
    "sphere": ParametricSurface("curved/surface/sphere.h", {"radius": _RADIUS}, closed="u"),
    "torus": ParametricSurface(
        "curved/surface/torus.h",
        {"radius": _RADIUS, "tube": Number(0.4, high=_LARGEST)},
        closed="uv",
    ),
    "moebius": ParametricSurface(
        "curved/surface/moebius.h",
        {"radius": _RADIUS, "width": Number(0.6, high=_LARGEST)},
        closed="u",
        twisted=True,
    ),
    "klein": ParametricSurface(
        "curved/surface/klein.h",
        {"radius": Number(2.0, high=_LARGEST), "size": _RADIUS},
        closed="uv",
        twisted=True,
    ),
    "helicoid": ParametricSurface(
        "curved/surface/helicoid.h",
        {"radius": _RADIUS, "pitch": Number(1.0, high=_LARGEST), "turns": _TURNS},
    ),
    "seashell": ParametricSurface(
        "curved/surface/seashell.h",
        {
            "turns": Number(4.0, low=0.5, high=64.0, step=0.5),
            "growth": Number(2.0, low=1.01, high=100.0),
            "tube": Number(0.5, high=_LARGEST),
            "height": Number(1.2, low=0.0, high=_LARGEST),
        },
        closed="v",
    ),
    "superquadric": ParametricSurface(
        "curved/surface/superquadric.h",
        {"radius": _RADIUS, "along": _EXPONENT, "across": _EXPONENT},
        closed="u",
    ),
}


def surface(
    shape: str | ParametricSurface,
    /,
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
    shape : str or ParametricSurface
        sphere, torus, moebius, klein, helicoid, seashell, superquadric, or one of your own.
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
    kind = named("surface", shape, SURFACES, ParametricSurface)
    given = shape_numbers(kind, numbers)
    across, down = (
        whole("patches", count, 1, _MOST_PATCHES)
        for count in parts("patches", patches, "along u", "along v")
    )
    device = Device.of(device)
    evaluate = _evaluation(kind, (across, down), given, device)
    return uniform_mesh(across * down, factor, partitioning, device, evaluate)


def _evaluation(
    kind: ParametricSurface, patches: tuple[int, int], given: Mapping[str, float], device: Device
) -> Evaluate:
    """Return what puts the points of a pattern on the surface."""
    across, down = patches
    defines = {
        **formula_defines("SURFACE", kind.header, given),
        "CLOSED_U": int("u" in kind.closed),
        "CLOSED_V": int("v" in kind.closed),
        "TWISTED": int(kind.twisted),
    }

    def evaluate(pattern: DevicePattern, vertices: DeviceVertices, items: int, group: int) -> None:
        kernel = device.kernel("curved/surface.cl", "surface_points", **{**defines, "GROUP": group})
        kernel(
            (items,),
            (group,),
            across=across,
            down=down,
            shape=formula_numbers(device, given),
            point_offsets=pattern.point_offsets,
            points=pattern.points,
            positions=vertices.positions,
            normals=vertices.normals,
        )

    return evaluate
