"""What boxes of ground deserve in a picture: whether they show, and which error they may have."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..camera.camera import Camera

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Boxes:
    """N boxes along the axes of the world.

    Attributes
    ----------
    low, high : (N, 3) float64
    """

    low: Array
    high: Array

    def taller(self, by: Array) -> Boxes:
        """Return boxes that reach so much farther up and down."""
        rise = by[:, None] * [0.0, 0.0, 1.0]
        return Boxes(self.low - rise, self.high + rise)

    def farthest(self, direction: Array) -> Array:
        """Return how far each reaches along a direction, from the origin of the world; (N,)."""
        reached: Array = np.where(direction > 0, self.high, self.low) @ direction
        return reached


@dataclass(frozen=True)
class Asked:
    """An error that is asked for, and from where.

    Attributes
    ----------
    camera : Camera or None
    metres, pixels : float
        Infinite where not asked for.
    cull : bool
        Whether what is out of view counts.
    """

    camera: Camera | None
    metres: float
    pixels: float
    cull: bool

    def shows(self, boxes: Boxes) -> npt.NDArray[np.bool_]:
        """Return whether any of a box may be in view; (N,)."""
        seen = np.ones(len(boxes.low), bool)
        if self.camera is not None and self.cull:
            for *normal, offset in self.camera.planes():
                seen &= boxes.farthest(np.array(normal)) + offset >= 0
        return seen

    def allowed(self, boxes: Boxes) -> Array:
        """Return the vertical error that keeps what is asked, wherever in a box it is; (N,).

        ``kernels/terrain/screen.h`` has the derivation.
        """
        allowed: Array = np.full(len(boxes.low), self.metres)
        camera = self.camera
        if camera is None or np.isinf(self.pixels):
            return allowed
        right, upward, forward = camera.axes
        across, along = float(np.hypot(right[2], upward[2])), abs(float(forward[2]))
        if camera.height:
            np.minimum(allowed, self.pixels / (camera.focal * max(across, 1e-6)), out=allowed)
            return allowed
        eye = np.array(camera.eye)

        def reach(axis: Any) -> Array:
            ahead = boxes.farthest(axis) - eye @ axis
            reached: Array = np.maximum(ahead, boxes.farthest(-axis) + eye @ axis)
            return reached

        nearest = -(boxes.farthest(-forward) + eye @ forward)
        depth = np.maximum(nearest * (1 - 1e-6), camera.near)
        lateral = np.hypot(reach(right), reach(upward))
        tangent = np.minimum(lateral / depth, np.hypot(*camera.half_extents))
        moved = camera.focal * (across + tangent * along)
        np.minimum(allowed, self.pixels * depth / (moved + self.pixels * along), out=allowed)
        return allowed
