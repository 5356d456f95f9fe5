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
import numpy.typing as npt

from ..camera.camera import Camera
from ..device.device import DeviceArray
from ..errors import InputError
from ..mesh.mesh import Achieved
from .choice import Allowance
from .fitted import fitted_mesh
from .leaves import Drawn, Leaves
from .lod import PromiseLod
from .meshing import Tessellated
from .selection import Selection
from .steady import Steady
from .tiles import DeviceTiles

# shares of what is allowed shrink so fast that full resolution comes well before this
_MOST_ROUNDS: Final = 40

# errors between which a budget's is looked for
_SMALLEST: Final = 1e-6
_LARGEST: Final = 1e9
_HALVINGS: Final = 13


@dataclass(frozen=True, eq=False)
class Kept:
    """What keeps a promise, and what was measured of it.

    Attributes
    ----------
    made : Tessellated
    drawn : Drawn or None
        What is known of the patches; None where they are the tiles.
    """

    made: Tessellated
    drawn: Drawn | None = None

    @property
    def triangle_count(self) -> int:
        return self.made.triangle_count

    @property
    def achieved(self) -> Achieved:
        assert self.made.achieved is not None  # it was promised
        return self.made.achieved


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
    steady : Steady or None
        What patches were allowed in the last mesh.
    heights : {"ground", "fitted"}
        Whether vertices stand on the ground, or float within the error.
    """

    tiles: DeviceTiles
    camera: Camera | None
    partitioning: str
    edge_rule: str
    cull: bool
    weights: DeviceArray | None = None
    steady: Steady | None = None
    heights: str = "ground"

    def keep(self, lod: PromiseLod) -> Kept:
        """Return the cheapest mesh found that keeps what `lod` promises."""
        if lod.triangles is None:
            return self._within(lod.metres, lod.pixels)
        # metres ask for an error in metres, whatever the camera sees
        if self.camera is not None and not lod.metres:
            return self._least_error(lod.triangles, lod.pixels, in_pixels=True)
        return self._least_error(lod.triangles, lod.metres, in_pixels=False)

    def _within(self, metres: float, pixels: float) -> Kept:
        if self.heights == "fitted":
            return self._within_fitted(metres, pixels)
        if self.partitioning == "integer":
            return self._within_tree(metres, pixels)
        selection = Selection.start(
            self.tiles,
            self.camera,
            metres=metres,
            pixels=pixels,
            edge_rule=self.edge_rule,
            cull=self.cull,
            weights=self.weights,
        )
        patches = self.tiles.patch_set
        for rounds in range(1, _MOST_ROUNDS + 1):
            selection.choose()
            # what did not change was measured before
            factors = selection.factors if rounds == 1 else selection.only_changed()
            made = Tessellated.of(patches, factors, self.partitioning)
            selection.measure(made.pattern)
            exceeding, refinable = selection.tighten()
            if refinable == 0:
                break
        if rounds > 1:
            made = Tessellated.of(patches, selection.factors, self.partitioning)
        worst, allowed = selection.measured.host(), selection.allowed.host()
        if self.weights is not None:
            allowed *= self.weights.host()
        achieved = _achieved(worst, allowed, pixels, exceeding, rounds)
        return Kept(replace(made, achieved=achieved))

    def _within_tree(self, metres: float, pixels: float) -> Kept:
        tree = self.tiles.tree
        assert tree is not None  # who promises has it made
        allowance = Allowance(
            self.tiles.view(self.camera),
            self.cull,
            metres,
            pixels,
            tree.weights(self.weights),
            0.0 if self.steady is None else self.steady.hysteresis,
        )
        with tree.marked(self.steady) as (stamp, marks):
            leaves = Leaves(tree, stamp, marks, allowance)
            for rounds in range(1, _MOST_ROUNDS + 1):
                if rounds > 1:
                    leaves.refine()
                leaves.fit()
                made = Tessellated.of(leaves.patches, leaves.factors, self.partitioning)
                leaves.measure(made.pattern)
                exceeding, refinable = leaves.tighten()
                if refinable == 0:
                    break
            drawn = leaves.drawn()
        achieved = _achieved(drawn.measured, drawn.allowed, pixels, exceeding, rounds)
        return Kept(replace(made, achieved=achieved), drawn)

    def _within_fitted(self, metres: float, pixels: float) -> Kept:
        tree = self.tiles.tree
        assert tree is not None  # who promises has it made
        standing = self._within_tree(metres, pixels)
        found = fitted_mesh(
            tree,
            Allowance(self.tiles.view(self.camera), self.cull, metres, pixels),
            self.weights,
            fewer_than=standing.triangle_count,
        )
        if found is None:
            return standing
        achieved = _achieved(found.drawn.measured, found.drawn.allowed, pixels, 0, found.rounds)
        return Kept(replace(found.made, achieved=achieved), found.drawn)

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
            achieved = replace(best.achieved, pixels=np.inf)
            best = replace(best, made=replace(best.made, achieved=achieved))
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


def _achieved(
    worst: npt.NDArray[np.float32],
    allowed: npt.NDArray[np.float32],
    pixels: float,
    exceeding: int,
    rounds: int,
) -> Achieved:
    """Return what was measured of patches that were allowed so much, and `pixels` all of them."""
    # the error in pixels grows faster than that in metres, so their ratio bounds it
    with np.errstate(invalid="ignore", divide="ignore"):
        used = np.where(worst > 0, worst / allowed, 0.0)
    return Achieved(
        metres=float(worst.max(initial=0.0)),
        pixels=pixels * float(np.nanmax(used, initial=0.0)) if np.isfinite(pixels) else None,
        kept=exceeding == 0,
        rounds=rounds,
    )
