"""Levels of detail by formula: by distance, by deviation, by area in the picture, or none."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Final

from ..arguments import instance
from ..device.layout import MAX_TILE
from ..numbered import TILE, Number, number
from .lod import Lod, Scene

_NEAR: Final = Number(
    0.0, low=0.0, unit="m", shown=(0.0, 1.0), help="distance with the most detail"
)
_FAR: Final = Number(
    None,
    unit="m",
    shown=(0.01, 2.0),
    start=1.0,
    help="distance with the least detail; by default the diagonal of the ground",
)
_MINIMUM: Final = Number(1.0, low=1.0, high=MAX_TILE, unit="segments", help="least factor")
_MAXIMUM: Final = Number(
    None,
    low=1.0,
    high=MAX_TILE,
    start=TILE,
    unit="segments",
    help="most factor; by default the cells of a tile",
)


@dataclass(frozen=True)
class UniformLod(Lod):
    """The same tessellation factor everywhere.

    Parameters
    ----------
    factor : float
        Segments along an edge, 1 to 63; no tile gets more than its cells.
    """

    factor: float = number(
        low=1.0,
        high=MAX_TILE,
        start=TILE,
        unit="segments",
        help="segments along an edge; by default the cells of a tile",
    )
    header: ClassVar[str | Path] = "terrain/lod/uniform.h"
    needs_camera: ClassVar[bool] = False


@dataclass(frozen=True)
class DistanceLod(Lod):
    """The nearer the camera, the more detail.

    Parameters
    ----------
    near, far : float, optional
        Distances in world units with the highest and the lowest detail; `far` defaults to the
        diagonal of the ground.
    minimum, maximum : float, optional
        Factors at `far` and `near`, 1 to 63; `maximum` defaults to the cells of a tile.
    falloff : float, optional
        Exponent of the nearness: 1 is linear, more keeps detail closer to the camera.

    Notes
    -----
    Zink, Pettineo, Hoxley: *Practical Rendering and Computation with Direct3D 11*, listing 9.7,
    clamped.
    """

    near: float = number(_NEAR)
    far: float | None = number(_FAR)
    minimum: float = number(_MINIMUM)
    maximum: float | None = number(_MAXIMUM)
    falloff: float = number(
        1.0,
        shown=(0.25, 8.0),
        logarithmic=True,
        help="exponent of the nearness; more keeps detail closer",
    )
    header: ClassVar[str | Path] = "terrain/lod/distance.h"
    swept: ClassVar[str] = "maximum"

    def parameters(self, scene: Scene) -> dict[str, float]:
        return {**self.numbers(), "far": _far(self, scene), "maximum": _most(self, scene)}


@dataclass(frozen=True)
class CoplanarityLod(Lod):
    """Detail where the ground is seen to leave its plane.

    A tile gets segments with the cube root of its deviation in the picture, so that the sum of
    squared errors is about the least for a number of triangles; docs/coplanarity.md derives it.

    Parameters
    ----------
    pixels : float, optional
        Deviation in the picture at which a tile gets `maximum` segments; one of an eighth of it
        gets half as many.
    minimum, maximum : float, optional
        Factors that limit it, 1 to 63; `maximum` defaults to the cells of a tile.

    Notes
    -----
    The deviation is that of Zink, Pettineo, Hoxley: *Practical Rendering and Computation with
    Direct3D 11*, section 9.1.2; :class:`BookCoplanarityLod` weighs it as they do.
    """

    pixels: float = number(
        16.0,
        unit="pixels",
        shown=(0.5, 128.0),
        logarithmic=True,
        help="deviation from its plane in the picture at which a tile gets all detail",
    )
    minimum: float = number(_MINIMUM)
    maximum: float | None = number(_MAXIMUM)
    header: ClassVar[str | Path] = "terrain/lod/coplanarity.h"

    def parameters(self, scene: Scene) -> dict[str, float]:
        return {**self.numbers(), "maximum": _most(self, scene)}


@dataclass(frozen=True)
class BookCoplanarityLod(Lod):
    """Distance scaled by deviation, as the book weighs it.

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

    near: float = number(_NEAR)
    far: float | None = number(_FAR)
    minimum: float = number(_MINIMUM)
    maximum: float | None = number(_MAXIMUM)
    full_deviation: float | None = number(
        None,
        unit="m",
        help="deviation from its plane at which a tile gets all that its distance allows; by "
        "default what 98 % of the tiles stay below",
    )
    flat_weight: float = number(
        0.3, low=0.0, high=1.0, help="share of its distance's detail that a flat tile keeps"
    )
    header: ClassVar[str | Path] = "terrain/lod/book_coplanarity.h"
    swept: ClassVar[str] = "maximum"

    def parameters(self, scene: Scene) -> dict[str, float]:
        rough = scene.rough_deviation if self.full_deviation is None else self.full_deviation
        # on perfectly flat ground any positive number means flat
        full = rough if rough > 0 else 1.0
        return {
            **self.numbers(),
            "far": _far(self, scene),
            "maximum": _most(self, scene),
            "full_deviation": full,
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
        Factors that limit it, 1 to 63; `maximum` defaults to the cells of a tile.
    """

    pixels: float = number(
        8.0, unit="pixels", shown=(1.0, 64.0), logarithmic=True, help="pixels along a segment"
    )
    minimum: float = number(_MINIMUM)
    maximum: float | None = number(_MAXIMUM)
    header: ClassVar[str | Path] = "terrain/lod/area.h"

    def parameters(self, scene: Scene) -> dict[str, float]:
        return {**self.numbers(), "maximum": _most(self, scene)}


_Capped = DistanceLod | CoplanarityLod | BookCoplanarityLod | ScreenAreaLod


def _far(lod: DistanceLod | BookCoplanarityLod, scene: Scene) -> float:
    diagonal = instance("a Scene", scene, Scene).diagonal
    return lod.near + diagonal if lod.far is None else lod.far


def _most(lod: _Capped, scene: Scene) -> float:
    # a tile of a few cells may have less than the least that is asked for
    return max(lod.minimum, scene.tile) if lod.maximum is None else lod.maximum
