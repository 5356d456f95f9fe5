"""Keeping a promise: choose factors, measure what comes of them, tighten, until it holds.

What is chosen holds by what the ladder and the strips beside edges say, at whole odd factors. Other
partitionings round factors, and every float is rounded. So the finished triangles are measured, on
the device, and tiles that exceed what they are allowed are asked for less; in the end they are
meshed in full, which is exact. What is promised is what was measured last.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from ..camera.camera import Camera
from ..device.device import DeviceArray
from ..errors import InputError
from ..mesh.mesh import Achieved
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from .lod import PromiseLod
from .meshing import pattern_on_device
from .selection import Selection
from .tiles import DeviceTiles

# shares of what is allowed shrink so fast that full resolution comes well before this
_MOST_ROUNDS: Final = 40

# errors between which a budget's is looked for
_SMALLEST: Final = 1e-6
_LARGEST: Final = 1e9
_HALVINGS: Final = 13


@dataclass(frozen=True, eq=False)
class Kept:
    """The factors and the pattern that keep a promise, and what was measured of them."""

    factors: DeviceFactors
    pattern: DevicePattern
    achieved: Achieved

    @property
    def triangle_count(self) -> int:
        count: int = self.pattern.primitives.shape[0]
        return count


@dataclass(frozen=True, eq=False)
class Promise:
    """What promises about one terrain and one view are kept with.

    Attributes
    ----------
    tiles : DeviceTiles
        With their ladder.
    camera : Camera or None
        Errors can be in pixels where there is one.
    partitioning : str
    edge_rule : str
        Rule for the factors of edges.
    cull : bool
    weights : DeviceArray, (P,) float32, or None
        How many times a tile's error counts.
    """

    tiles: DeviceTiles
    camera: Camera | None
    partitioning: str
    edge_rule: str
    cull: bool
    weights: DeviceArray | None = None

    def keep(self, lod: PromiseLod) -> Kept:
        """Return the cheapest mesh found that keeps what `lod` promises."""
        if lod.triangles is None:
            return self._within(lod.metres, lod.pixels)
        # metres ask for an error in metres, whatever the camera sees
        if self.camera is not None and not lod.metres:
            return self._least_error(lod.triangles, lod.pixels, in_pixels=True)
        return self._least_error(lod.triangles, lod.metres, in_pixels=False)

    def _within(self, metres: float, pixels: float) -> Kept:
        selection = Selection.start(
            self.tiles,
            self.camera,
            metres=metres,
            pixels=pixels,
            edge_rule=self.edge_rule,
            cull=self.cull,
            weights=self.weights,
        )
        for rounds in range(1, _MOST_ROUNDS + 1):
            selection.choose()
            # what did not change was measured before
            pattern = self._pattern(selection.factors if rounds == 1 else selection.only_changed())
            selection.measure(pattern)
            exceeding, refinable = selection.tighten()
            if refinable == 0:
                break
        if rounds > 1:
            pattern = self._pattern(selection.factors)
        worst = selection.measured.host()
        allowed = selection.allowed.host()
        # the error in pixels grows faster than that in metres, so their ratio bounds it
        weights = 1.0 if self.weights is None else self.weights.host()
        with np.errstate(invalid="ignore", divide="ignore"):
            used = np.where(worst > 0, worst / allowed / weights, 0.0)
        achieved = Achieved(
            metres=float(worst.max()),
            pixels=pixels * float(np.nanmax(used, initial=0.0)) if np.isfinite(pixels) else None,
            kept=exceeding == 0,
            rounds=rounds,
        )
        return Kept(selection.factors, pattern, achieved)

    def _pattern(self, factors: DeviceFactors) -> DevicePattern:
        return pattern_on_device(self.tiles, factors, self.partitioning)

    def _least_error(self, triangles: int, enough: float, *, in_pixels: bool) -> Kept:
        """Return the mesh of at most so many `triangles` with the least error above `enough`."""

        def at(error: float) -> Kept:
            return self._within(*((np.inf, error) if in_pixels else (error, np.inf)))

        low, high = max(enough, _SMALLEST), _LARGEST
        best = at(low)
        if best.triangle_count <= triangles:
            return best
        best = at(high)
        if best.triangle_count > triangles and in_pixels:
            # beside the eye no vertical error is few enough pixels: then none is promised
            best = self._within(_LARGEST, np.inf)
            best = replace(best, achieved=replace(best.achieved, pixels=np.inf))
        if best.triangle_count > triangles:
            raise InputError(
                f"expected a budget of at least {best.triangle_count} triangles for the patches "
                f"in view, got {triangles}: use larger tiles or a larger budget"
            )
        # halve the range of errors, by their logarithm, around the budget
        for _ in range(_HALVINGS):
            middle = float(np.sqrt(low * high))
            found = at(middle)
            if found.triangle_count > triangles:
                low = middle
            else:
                best, high = found, middle
        return best
