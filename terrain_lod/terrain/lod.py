"""What a level of detail is: how many segments a patch deserves, seen from a camera.

A formula is a small class of ``lod_formulas.py``, a header of ``kernels/`` that defines
``patch_lod()``, a function of ``terrain_lod.reference.terrain.lod`` and a row of ``lods.py``. The
class's numbers reach the header by name: a field ``near`` is ``parameters[LOD_NEAR]``. Classes from
elsewhere have headers of their own, as paths: docs/own_lod.md. A promise has no header, it is kept
by ``promise.py``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Final

from ..arguments import finite, instance
from ..errors import InputError
from ..numbered import Number, Numbered, number


@dataclass(frozen=True)
class Scene:
    """What defaults are taken from, in world units.

    Attributes
    ----------
    diagonal : float
        Of the ground's bounding box.
    rough_deviation : float
        Deviation that 98 % of the tiles stay below.
    tile : int
        Cells along a tile.
    """

    diagonal: float
    rough_deviation: float
    tile: int

    def __post_init__(self) -> None:
        for name in ("diagonal", "rough_deviation"):
            object.__setattr__(self, name, finite(name, getattr(self, name)))


class Lod(Numbered):
    """A formula for the segments of a patch, as the hull stage takes it.

    Attributes
    ----------
    header : str or pathlib.Path
        What defines its ``patch_lod()``: a file of ``kernels/``, or the path of any other.
    """

    header: ClassVar[str | Path] = ""

    def parameters(self, scene: Scene) -> dict[str, float]:
        """Return the numbers that the header reads, defaults filled in from the scene."""
        return self.numbers()


class PromiseLod(Numbered):
    """A level of detail that promises an error: the finished mesh is measured and keeps to it.

    Attributes
    ----------
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


WEIGHTS: Final = {
    "horizon": Number(
        4.0,
        low=1.0,
        shown=(1.0, 8.0),
        help="weight of a tile that stands against the sky, on any level of detail",
    ),
    "silhouette": Number(
        1.0,
        low=1.0,
        shown=(1.0, 8.0),
        help="weight of a tile that is seen edge on, on any level of detail",
    ),
}
"""What a :class:`Weighted` is made with beside a level of detail."""


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
    horizon: float = number(WEIGHTS["horizon"])
    silhouette: float = number(WEIGHTS["silhouette"])
    needs_camera: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if isinstance(checked_lod(self.lod), Weighted):
            raise InputError(f"expected a level of detail without weights to weigh, got {self.lod}")
        for name, what in WEIGHTS.items():
            object.__setattr__(self, name, what.checked(name, getattr(self, name)))


AnyLod = Lod | PromiseLod | Weighted


def checked_lod(value: object) -> AnyLod:
    """Return `value` if it is a level of detail.

    Raises
    ------
    InputError
        If it is anything else, a class of them included.
    """
    what = "a level of detail, such as ScreenErrorLod(1.0)"
    made: AnyLod = instance(what, value, Lod | PromiseLod | Weighted)
    return made


def unweighted(lod: AnyLod) -> Lod | PromiseLod:
    """Return what is weighed, or the level of detail itself."""
    return lod.lod if isinstance(lod, Weighted) else lod
