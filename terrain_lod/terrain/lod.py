"""Levels of detail: how many segments a patch deserves, seen from a camera.

A level of detail is a small class here, a header of ``kernels/`` that defines ``patch_lod()``, and
a function of ``terrain_lod.reference.terrain.lod``. The class's numbers reach the header by name: a
field ``near`` is ``parameters[LOD_NEAR]``.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

from ..arguments import finite, positive, whole
from ..device.layout import MAX_TILE
from ..errors import InputError


@dataclass(frozen=True)
class Scene:
    """What defaults are taken from, in world units.

    Attributes
    ----------
    diagonal : float
        Of the ground's bounding box.
    rough_deviation : float
        Deviation that 98 % of the tiles stay below.
    """

    diagonal: float
    rough_deviation: float


class Lod(ABC):
    """A level of detail, as the hull stage takes it.

    Attributes
    ----------
    header : str
        File of ``kernels/`` that defines its ``patch_lod()``.
    needs_camera : bool
    """

    header: ClassVar[str]
    needs_camera: ClassVar[bool] = True

    @abstractmethod
    def parameters(self, scene: Scene) -> dict[str, float]:
        """Return the numbers that the header reads, defaults filled in from the scene."""


@dataclass(frozen=True)
class UniformLod(Lod):
    """The same tessellation factor everywhere.

    Parameters
    ----------
    factor : float
        Segments along an edge, 1 to 63; no tile gets more than its cells.
    """

    factor: float
    header: ClassVar[str] = "terrain/lod/uniform.h"
    needs_camera: ClassVar[bool] = False

    def __post_init__(self) -> None:
        _factor("factor", self.factor)

    def parameters(self, scene: Scene) -> dict[str, float]:
        return {"factor": self.factor}


@dataclass(frozen=True)
class DistanceLod(Lod):
    """The nearer the camera, the more detail; the book's listing 9.7, clamped.

    Parameters
    ----------
    near, far : float, optional
        Distances in world units with the highest and the lowest detail; `far` defaults to the
        diagonal of the ground.
    minimum, maximum : float, optional
        Factors at `far` and `near`, 1 to 63.
    falloff : float, optional
        Exponent of the nearness: 1 is linear, more keeps detail closer to the camera.
    """

    near: float = 0.0
    far: float | None = None
    minimum: float = 1.0
    maximum: float = 15.0
    falloff: float = 1.0
    header: ClassVar[str] = "terrain/lod/distance.h"

    def __post_init__(self) -> None:
        _check_range(self.near, self.far, self.minimum, self.maximum)
        positive("falloff", self.falloff)

    def parameters(self, scene: Scene) -> dict[str, float]:
        return {**_range_parameters(self, scene), "falloff": self.falloff}


@dataclass(frozen=True)
class CoplanarityLod(Lod):
    """Distance scaled by deviation: detail where the ground leaves its plane.

    Parameters
    ----------
    near, far, minimum, maximum : float, optional
        As for :class:`DistanceLod`.
    full_deviation : float, optional
        Deviation in world units from which on a tile gets what its distance allows; defaults to
        the deviation that 98 % of the ground's tiles stay below.
    flat_weight : float, optional
        Share of its distance's detail that an exactly flat tile keeps, 0 to 1; between flat and
        full the share grows with the square root of the deviation.

    Notes
    -----
    Zink, Pettineo, Hoxley: *Practical Rendering and Computation with Direct3D 11*, section 9.1.2.
    """

    near: float = 0.0
    far: float | None = None
    minimum: float = 1.0
    maximum: float = 15.0
    full_deviation: float | None = None
    flat_weight: float = 0.3
    header: ClassVar[str] = "terrain/lod/coplanarity.h"

    def __post_init__(self) -> None:
        _check_range(self.near, self.far, self.minimum, self.maximum)
        if self.full_deviation is not None:
            positive("full_deviation", self.full_deviation)
        if not 0 <= finite("flat_weight", self.flat_weight) <= 1:
            raise InputError(f"expected flat_weight from 0 to 1, got {self.flat_weight:g}")

    def parameters(self, scene: Scene) -> dict[str, float]:
        rough = scene.rough_deviation if self.full_deviation is None else self.full_deviation
        return {
            **_range_parameters(self, scene),
            # on perfectly flat ground any positive number means flat
            "full_deviation": rough if rough > 0 else 1.0,
            "flat_weight": self.flat_weight,
        }


@dataclass(frozen=True)
class ScreenAreaLod(Lod):
    """As much detail as the tile's bounding box has area in the picture.

    Parameters
    ----------
    pixels : float, optional
        A tile gets a segment along its edges for every so many pixels along the side of a square
        with the area of its projected box.
    minimum, maximum : float, optional
        Factors that limit it, 1 to 63.
    """

    pixels: float = 8.0
    minimum: float = 1.0
    maximum: float = 15.0
    header: ClassVar[str] = "terrain/lod/area.h"

    def __post_init__(self) -> None:
        positive("pixels", self.pixels)
        _check_factors(self.minimum, self.maximum)

    def parameters(self, scene: Scene) -> dict[str, float]:
        return {"pixels": self.pixels, "minimum": self.minimum, "maximum": self.maximum}


class PromiseLod:
    """A level of detail that promises an error: the finished mesh is measured and keeps to it.

    Attributes
    ----------
    needs_camera : bool
    metres, pixels : float
        The most that the mesh may be off at any sample, vertically in the raster's unit and in the
        picture; infinite where not asked for.
    triangles : int or None
        The most triangles, if there is a limit.
    """

    needs_camera: ClassVar[bool] = False
    metres: float = math.inf
    pixels: float = math.inf
    triangles: int | None = None


@dataclass(frozen=True)
class MaxErrorLod(PromiseLod):
    """The fewest triangles within a vertical error at every sample; needs no camera.

    Parameters
    ----------
    metres : float
        In the raster's unit, above 0.
    """

    metres: float

    def __post_init__(self) -> None:
        positive("metres", self.metres)


@dataclass(frozen=True)
class ScreenErrorLod(PromiseLod):
    """The fewest triangles within an error in pixels at every sample that is in view.

    Parameters
    ----------
    pixels : float
        How far the mesh may be off in the camera's picture, above 0.
    """

    pixels: float = 1.0
    needs_camera: ClassVar[bool] = True

    def __post_init__(self) -> None:
        positive("pixels", self.pixels)


@dataclass(frozen=True)
class BudgetLod(PromiseLod):
    """The least error that a number of triangles can give.

    In pixels; in metres without a camera, or where `metres` are given.

    Parameters
    ----------
    triangles : int
        The most that the mesh may have.
    pixels, metres : float, optional
        Error that need not be bettered, one of both: fewer triangles are used where they suffice.
    """

    triangles: int
    pixels: float = 0.0
    metres: float = 0.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "triangles", whole("triangles", self.triangles, 1, 2**31))
        for name in ("pixels", "metres"):
            if finite(name, getattr(self, name)) < 0:
                raise InputError(f"expected {name} >= 0, got {getattr(self, name):g}")
        if self.pixels and self.metres:
            raise InputError(
                f"expected pixels or metres to be enough, got both: {self.pixels:g} pixels, "
                f"{self.metres:g} metres"
            )

    @property
    def needs_camera(self) -> bool:  # type: ignore[override]
        """Pixels are a camera's."""
        return self.pixels > 0


@dataclass(frozen=True)
class Weighted:
    """Any level of detail, with more of it where ground stands against the sky.

    Far ridges are small, but nothing hides what they lack: that is what this is for.

    Parameters
    ----------
    lod : Lod or PromiseLod
        A formula's factors are multiplied by a tile's weight; what a promise allows is divided by
        it, so that a promise is kept all the same. A weight below 1 would break one.
    horizon : float, optional
        Weight of a tile that is the horizon; it falls to 1 for tiles whose top does not reach it.
    silhouette : float, optional
        Weight of a tile whose plane is seen edge on; it falls to 1 for one seen from above.

    Raises
    ------
    InputError
        If a weight is below 1, or `lod` is not a level of detail.
    """

    lod: Lod | PromiseLod
    horizon: float = 4.0
    silhouette: float = 1.0
    needs_camera: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if not isinstance(self.lod, Lod | PromiseLod):
            raise InputError(f"expected a level of detail to weigh, got {self.lod!r}")
        for name in ("horizon", "silhouette"):
            if finite(name, getattr(self, name)) < 1:
                raise InputError(f"expected {name} >= 1, got {getattr(self, name):g}")


def _range_parameters(lod: DistanceLod | CoplanarityLod, scene: Scene) -> dict[str, float]:
    far = lod.near + scene.diagonal if lod.far is None else lod.far
    return {"near": lod.near, "far": far, "minimum": lod.minimum, "maximum": lod.maximum}


def _factor(name: str, value: float) -> None:
    if not 1 <= finite(name, value) <= MAX_TILE:
        raise InputError(f"expected {name} from 1 to {MAX_TILE}, got {value:g}")


def _check_range(near: float, far: float | None, minimum: float, maximum: float) -> None:
    if finite("near", near) < 0:
        raise InputError(f"expected near >= 0, got {near:g}")
    if far is not None and finite("far", far) <= near:
        raise InputError(f"expected far > near, got far {far:g} and near {near:g}")
    _check_factors(minimum, maximum)


def _check_factors(minimum: float, maximum: float) -> None:
    _factor("minimum", minimum)
    _factor("maximum", maximum)
    if maximum < minimum:
        raise InputError(f"expected maximum >= minimum, got {maximum:g} and {minimum:g}")
