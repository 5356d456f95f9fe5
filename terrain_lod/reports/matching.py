"""A level of detail, tuned until its triangles or its error are what is wanted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from ..device.layout import MAX_TILE
from ..terrain.lod_formulas import DistanceLod
from ..terrain.lod_promises import ScreenErrorLod

Tunable = DistanceLod | ScreenErrorLod

_BISECTIONS: Final = 24
# pixels between which a promise is tuned
_COARSEST: Final = 512.0
_FINEST: Final = 1 / 64


def tuned(
    lod: Tunable, wanted: float, measure: Callable[[Tunable], float], *, share: float, rises: bool
) -> Tunable:
    """Return `lod`, finer or coarser, so that what is measured of it comes to `wanted`.

    Bisects the highest factor of distance LOD between its lowest and 63, and the pixels of
    screen-error LOD. Where the measure jumps past `wanted`, the nearest that was met is returned.

    Parameters
    ----------
    lod : DistanceLod or ScreenErrorLod
    wanted : float
        Above 0.
    measure : callable
        Triangles or error of a level of detail.
    share : float
        Of `wanted`, within which the search ends.
    rises : bool
        Whether more detail measures more, as triangles do, or less, as errors do.
    """
    coarse, fine = 0.0, 1.0
    best, least = lod, float("inf")
    for _ in range(_BISECTIONS):
        middle = (coarse + fine) / 2
        candidate = _at(lod, middle)
        excess = excess_share(measure(candidate), wanted)
        if abs(excess) < least:
            best, least = candidate, abs(excess)
        if least <= share:
            break
        too_fine = (excess > 0) == rises
        coarse, fine = (coarse, middle) if too_fine else (middle, fine)
    return best


def excess_share(found: float, wanted: float) -> float:
    """Return by which share of `wanted` what was found is more."""
    return (found - wanted) / wanted if wanted else float("inf" if found else 0)


def _at(lod: Tunable, detail: float) -> Tunable:
    """Return `lod` at a detail between 0, the coarsest, and 1."""
    if isinstance(lod, DistanceLod):
        return replace(lod, maximum=lod.minimum + detail * (MAX_TILE - lod.minimum))
    return replace(lod, pixels=_COARSEST * (_FINEST / _COARSEST) ** detail)
