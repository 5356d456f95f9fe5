"""Tessellation factors of curved patches: how many segments an edge deserves.

A formula is a small class here, a header of ``kernels/`` that defines ``edge_factor()``, and a
function of ``terrain_lod.reference.curved.patch_factors``. The class's numbers reach the header by
name: a field ``near`` is ``parameters[FACTOR_NEAR]``. A formula is asked once an edge, so that
patches on both sides of it agree.
"""

from __future__ import annotations

from abc import ABC
from dataclasses import dataclass, fields
from typing import ClassVar, Final

from ..arguments import finite, positive
from ..errors import InputError

# the most segments that any partitioning makes
MAX_FACTOR: Final = 64


class EdgeFactor(ABC):
    """A formula for the segments along an edge.

    Attributes
    ----------
    header : str
        File of ``kernels/`` that defines its ``edge_factor()``.
    needs_camera : bool
    """

    header: ClassVar[str]
    needs_camera: ClassVar[bool] = True

    def parameters(self, diagonal: float) -> dict[str, float]:
        """Return the numbers that the header reads; `diagonal` is that of the mesh's bounds."""
        return {field.name: getattr(self, field.name) for field in fields(self)}  # type: ignore[arg-type]


@dataclass(frozen=True)
class UniformFactor(EdgeFactor):
    """The same factor everywhere.

    Parameters
    ----------
    factor : float
        Segments along an edge, 1 to 64.
    """

    factor: float = 5.0
    header: ClassVar[str] = "curved/factor/uniform.h"
    needs_camera: ClassVar[bool] = False

    def __post_init__(self) -> None:
        checked_factor("factor", self.factor)


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

    near: float = 0.0
    far: float | None = None
    minimum: float = 1.0
    maximum: float = 15.0
    header: ClassVar[str] = "curved/factor/distance.h"

    def __post_init__(self) -> None:
        if finite("near", self.near) < 0:
            raise InputError(f"expected near >= 0, got {self.near:g}")
        if self.far is not None and finite("far", self.far) <= self.near:
            raise InputError(f"expected far > near, got far {self.far:g} and near {self.near:g}")
        _check_range(self.minimum, self.maximum)

    def parameters(self, diagonal: float) -> dict[str, float]:
        far = self.near + diagonal if self.far is None else self.far
        return {**super().parameters(diagonal), "far": far}


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

    pixels: float = 8.0
    minimum: float = 1.0
    maximum: float = 64.0
    header: ClassVar[str] = "curved/factor/length.h"

    def __post_init__(self) -> None:
        positive("pixels", self.pixels)
        _check_range(self.minimum, self.maximum)


@dataclass(frozen=True)
class OrientationFactor(EdgeFactor):
    """The more a surface is seen from its side, the more segments.

    Parameters
    ----------
    minimum, maximum : float, optional
        Factors seen from the front and from the side, 1 to 64.
    """

    minimum: float = 1.0
    maximum: float = 15.0
    header: ClassVar[str] = "curved/factor/orientation.h"

    def __post_init__(self) -> None:
        _check_range(self.minimum, self.maximum)


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

    cosine: float = 0.3
    minimum: float = 1.0
    maximum: float = 15.0
    header: ClassVar[str] = "curved/factor/silhouette.h"

    def __post_init__(self) -> None:
        positive("cosine", self.cosine)
        _check_range(self.minimum, self.maximum)


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

    pixels: float = 0.5
    minimum: float = 1.0
    maximum: float = 64.0
    header: ClassVar[str] = "curved/factor/curvature.h"

    def __post_init__(self) -> None:
        positive("pixels", self.pixels)
        _check_range(self.minimum, self.maximum)


def checked_factor(name: str, value: float) -> float:
    """Return a tessellation factor, or say what it should be."""
    if not 1 <= finite(name, value) <= MAX_FACTOR:
        raise InputError(f"expected {name} from 1 to {MAX_FACTOR}, got {value:g}")
    return value


def _check_range(minimum: float, maximum: float) -> None:
    checked_factor("minimum", minimum)
    checked_factor("maximum", maximum)
    if maximum < minimum:
        raise InputError(f"expected maximum >= minimum, got {maximum:g} and {minimum:g}")
