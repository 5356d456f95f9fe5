"""What a file of heights says, before it is ground."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from .wkt import System


@dataclass(frozen=True, eq=False)
class Raster:
    """What a file says, before it is ground.

    Attributes
    ----------
    values : (R, C), any dtype
        Samples, row 0 north.
    step : (float, float) or None
        Distance between samples along x and y in the file's unit; None if the file does not say.
    origin : (float, float) or None
        x and y of sample [0, 0] in the file's unit; None if the file does not say.
    nodata : float or None
        The value that stands for no data.
    mask : (R, C) bool or None
        True where there is no data, besides `nodata`.
    scale, offset : float
        A height is ``scale * value + offset``, in `height_unit`.
    height_unit : str or None
        What the file calls the unit of its heights; None if only its CRS may say.
    system : System
        Coordinate reference system of `origin` and `step`.
    geographic : callable or None
        From x and y to longitude and latitude in degrees, of a projection.
    coloured : bool
        True if the heights came packed in colours, as tiles of web maps are.
    notes : tuple of str
        What a user ought to be warned of.
    """

    values: npt.NDArray[Any]
    step: tuple[float, float] | None = None
    origin: tuple[float, float] | None = None
    nodata: float | None = None
    mask: npt.NDArray[np.bool_] | None = None
    scale: float = 1.0
    offset: float = 0.0
    height_unit: str | None = None
    system: System = field(default_factory=System)
    geographic: Callable[[float, float], tuple[float, float]] | None = None
    coloured: bool = False
    notes: tuple[str, ...] = ()
