"""Levels of detail that promise an error, or a number of triangles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from ..errors import InputError
from ..numbered import number
from .lod import PromiseLod


@dataclass(frozen=True)
class MaxErrorLod(PromiseLod):
    """The fewest triangles within a vertical error at every sample; needs no camera.

    Parameters
    ----------
    metres : float
        In the raster's unit, above 0.
    """

    metres: float = number(
        unit="m",
        shown=(1e-6, 1e-2),
        start=2e-4,
        logarithmic=True,
        help="vertical error to keep, in the raster's unit",
    )


@dataclass(frozen=True)
class ScreenErrorLod(PromiseLod):
    """The fewest triangles within an error in pixels at every sample that is in view.

    Parameters
    ----------
    pixels : float
        How far the mesh may be off in the camera's picture, above 0.
    """

    pixels: float = number(
        1.0,
        unit="pixels",
        shown=(0.25, 32.0),
        logarithmic=True,
        help="error in the picture to keep, in pixels",
    )
    needs_camera: ClassVar[bool] = True


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

    triangles: int = number(
        low=1,
        high=2**31,
        step=1.0,
        unit="triangles",
        shown=(1e4, 1e6),
        start=1e5,
        logarithmic=True,
        help="the most triangles",
    )
    pixels: float = number(0.0, low=0.0, unit="pixels", help="error in pixels that is good enough")
    metres: float = number(
        0.0, low=0.0, unit="m", help="vertical error that is good enough: it then goes by that"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.pixels and self.metres:
            raise InputError(
                f"expected pixels or metres to be enough, got both: {self.pixels:g} pixels, "
                f"{self.metres:g} metres"
            )

    @property
    def needs_camera(self) -> bool:  # type: ignore[override]
        """Pixels are a camera's."""
        return self.pixels > 0
