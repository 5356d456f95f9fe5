"""Tessellation factors of curved patches: how many segments an edge deserves.

A formula is a small class here, a header of ``kernels/`` that defines ``edge_factor()``, a function
of ``terrain_lod.reference.curved.patch_factors`` and a row of :data:`EDGE_FACTORS`. The class's
numbers reach the header by name: a field ``near`` is ``parameters[FACTOR_NEAR]``. A formula is
asked once an edge, so that patches on both sides of it agree. Classes from elsewhere have headers
of their own, as paths: docs/own_lod.md.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import ClassVar, Final

from ..arguments import finite, instance
from ..numbered import Number, Numbered, number

# the most segments that any partitioning makes
MAX_FACTOR: Final = 64


class EdgeFactor(Numbered):
    """A formula for the segments along an edge.

    Attributes
    ----------
    header : str or pathlib.Path
        What defines its ``edge_factor()``: a file of ``kernels/``, or the path of any other.
    """

    header: ClassVar[str | Path] = ""

    def parameters(self, diagonal: float) -> dict[str, float]:
        """Return the numbers that the header reads; `diagonal` is that of the mesh's bounds."""
        return self.numbers()


_FACTOR: Final = Number(
    5.0,
    low=1.0,
    high=MAX_FACTOR,
    unit="segments",
    logarithmic=True,
    help="segments along every edge",
)
_MINIMUM: Final = replace(_FACTOR, default=1.0, help="the fewest segments")
_MAXIMUM: Final = replace(_FACTOR, default=15.0, help="the most segments")


@dataclass(frozen=True)
class UniformFactor(EdgeFactor):
    """The same factor everywhere.

    Parameters
    ----------
    factor : float
        Segments along an edge, 1 to 64.
    """

    factor: float = number(_FACTOR)
    header: ClassVar[str | Path] = "curved/factor/uniform.h"
    needs_camera: ClassVar[bool] = False


@dataclass(frozen=True)
class DistanceFactor(EdgeFactor):
    """The nearer the camera, the more segments: (1 - t) maximum + t minimum.

    Parameters
    ----------
    near, far : float, optional
        Distances of an edge's middle in world units at which t is 0 and 1; `far` defaults to `near`
        and the diagonal of the mesh.
    minimum, maximum : float, optional
        Factors at `far` and `near`, 1 to 64.

    Notes
    -----
    *DirectX 11 tessellation*, slides of 2010, "distance adaptive tessellation": their (1 - t) max
    + t has a minimum of 1.
    """

    near: float = number(
        0.0, low=0.0, unit="m", shown=(0.0, 1.0), help="distance with the most segments"
    )
    far: float | None = number(
        None,
        unit="m",
        shown=(0.01, 4.0),
        # a first view is from outside: all of the mesh is farther than its diagonal
        start=2.0,
        help="distance with the fewest; by default a diagonal of the mesh beyond near",
    )
    minimum: float = number(_MINIMUM)
    maximum: float = number(_MAXIMUM)
    header: ClassVar[str | Path] = "curved/factor/distance.h"

    def parameters(self, diagonal: float) -> dict[str, float]:
        far = self.near + finite("diagonal", diagonal) if self.far is None else self.far
        return {**self.numbers(), "far": far}


@dataclass(frozen=True)
class LengthFactor(EdgeFactor):
    """Segments of so many pixels, by the edge's bounding sphere in the picture.

    Parameters
    ----------
    pixels : float, optional
        Along a segment, above 0. Triangles below 8 pixels cost a GPU more than they show.
    minimum, maximum : float, optional
        Factors, 1 to 64.
    """

    pixels: float = number(
        8.0, unit="pixels", shown=(0.125, 64.0), logarithmic=True, help="pixels along a segment"
    )
    minimum: float = number(_MINIMUM)
    maximum: float = number(replace(_MAXIMUM, default=64.0))
    header: ClassVar[str | Path] = "curved/factor/length.h"


@dataclass(frozen=True)
class OrientationFactor(EdgeFactor):
    """The more a surface is seen from its side, the more segments.

    Parameters
    ----------
    minimum, maximum : float, optional
        Factors seen from the front and from the side, 1 to 64.
    """

    minimum: float = number(_MINIMUM)
    maximum: float = number(_MAXIMUM)
    header: ClassVar[str | Path] = "curved/factor/orientation.h"


@dataclass(frozen=True)
class SilhouetteFactor(EdgeFactor):
    """Segments where the outline of the picture is.

    Parameters
    ----------
    cosine : float, optional
        Of the angle between a face and the view, above 0: where both faces of an edge are turned
        towards the eye, or both away, by more than that, the edge is no part of the outline.
    minimum, maximum : float, optional
        Factors away from the outline and on it, 1 to 64.

    Notes
    -----
    C. Dyken, M. Reimers, J. Seland: *Real-Time GPU Silhouette Refinement Using Adaptively Blended
    Bezier Patches*, 2008.
    """

    cosine: float = number(
        0.3, shown=(0.01, 1.0), help="faces turned by more are no part of the outline"
    )
    minimum: float = number(_MINIMUM)
    maximum: float = number(_MAXIMUM)
    header: ClassVar[str | Path] = "curved/factor/silhouette.h"


@dataclass(frozen=True)
class CurvatureFactor(EdgeFactor):
    """As many segments as keep a curved edge's polyline within so many pixels of it.

    Parameters
    ----------
    pixels : float, optional
        How far an edge may be off its curve in the middle of the picture, above 0; a perspective
        stretches what is away from it.
    minimum, maximum : float, optional
        Factors, 1 to 64.

    Notes
    -----
    On semi-uniform patterns, between whole levels, it may be an eighth more.
    """

    pixels: float = number(
        0.5, unit="pixels", shown=(0.125, 64.0), logarithmic=True, help="pixels off the curve"
    )
    minimum: float = number(_MINIMUM)
    maximum: float = number(replace(_MAXIMUM, default=64.0))
    header: ClassVar[str | Path] = "curved/factor/curvature.h"


EDGE_FACTORS: Final[dict[str, type[EdgeFactor]]] = {
    "uniform": UniformFactor,
    "distance": DistanceFactor,
    "length": LengthFactor,
    "silhouette": SilhouetteFactor,
    "orientation": OrientationFactor,
    "curvature": CurvatureFactor,
}
"""Every formula for edges, by its name on the command line and in viewers."""


def checked_formula(value: object) -> EdgeFactor:
    """Return `value` if it is a formula for edges.

    Raises
    ------
    InputError
        If it is anything else, a class of them included.
    """
    return instance("a formula for edges, such as LengthFactor(8.0)", value, EdgeFactor)


def checked_factor(name: str, value: float) -> float:
    """Return a tessellation factor, or say what it should be."""
    return _FACTOR.checked(name, value)
