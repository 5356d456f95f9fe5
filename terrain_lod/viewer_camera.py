"""A camera that is driven: around a point, or freely over the ground.

::

             eye            heading 0 looks north, 90 east
               \\  pitch < 0 looks down
      distance  \\
    ground ~~~~ target ~~~~
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from .arguments import finite
from .camera import Camera, Point
from .heightmap import Heightmap

_STEEPEST: Final = 89.5  # degrees; at 90 up would be along the view
_NEAREST, _FARTHEST = 1e-4, 4.0  # distance to the target, in diagonals of the ground
_REACH: Final = 4.0  # how far the eye goes from the middle of the ground, in diagonals
_BEYOND: Final = 1e15  # world units
_CLEARANCE: Final = 5e-4  # between eye and ground, in diagonals


@dataclass(frozen=True)
class Rig:
    """Where a camera is and how it is turned.

    Attributes
    ----------
    target : (float, float, float)
        World point in the middle of the picture.
    distance : float
        From the eye to it.
    heading : float
        Where the view goes, degrees clockwise from north.
    pitch : float
        Degrees above the horizon.
    fov : float
        Vertical field of view, degrees.
    """

    target: Point
    distance: float
    heading: float
    pitch: float
    fov: float

    @classmethod
    def of(cls, camera: Camera) -> Rig:
        """Return the rig that stands where a camera does; a tilt sideways is lost."""
        view = np.subtract(camera.target, camera.eye)
        distance = float(np.linalg.norm(view))
        return cls(
            target=camera.target,
            distance=distance,
            heading=math.degrees(math.atan2(view[0], view[1])),
            pitch=math.degrees(math.asin(max(-1.0, min(1.0, view[2] / distance)))),
            fov=camera.fov,
        )

    @property
    def forward(self) -> Point:
        """Unit vector from the eye to the target."""
        turn, rise = math.radians(self.heading), math.radians(self.pitch)
        level = math.cos(rise)
        return level * math.sin(turn), level * math.cos(turn), math.sin(rise)

    @property
    def eye(self) -> Point:
        """World point where the camera stands."""
        x, y, z = np.subtract(self.target, np.multiply(self.distance, self.forward))
        return float(x), float(y), float(z)

    def camera(self, size: tuple[int, int], near: float = 0.1) -> Camera:
        """Return the camera for a picture of `size`; a picture without pixels counts as one."""
        width, height = (max(1, int(extent)) for extent in size)
        return Camera(self.eye, self.target, fov=self.fov, size=(width, height), near=near)

    def orbit(self, right: float, upward: float) -> Rig:
        """Return the rig turned around its target by degrees."""
        return replace(self, heading=self.heading - right, pitch=self.pitch - upward)

    def look(self, right: float, upward: float) -> Rig:
        """Return the rig turned around its eye by degrees."""
        turned = replace(self, heading=self.heading + right, pitch=_steep(self.pitch + upward))
        return turned._standing_at(self.eye)

    def zoom(self, factor: float) -> Rig:
        """Return the rig with its distance divided by `factor`."""
        return replace(self, distance=self.distance / factor)

    def pan(self, right: float, upward: float) -> Rig:
        """Return the rig moved within the picture, in shares of the distance."""
        across, up, _ = self.camera((1, 1)).axes
        return self._moved(self.distance * (right * across + upward * up))

    def fly(self, forward: float, right: float = 0.0) -> Rig:
        """Return the rig moved along the view and sideways, in world units."""
        across = self.camera((1, 1)).axes[0]
        return self._moved(np.multiply(forward, self.forward) + right * across)

    def within(self, ground: Heightmap) -> Rig:
        """Return the rig kept above the ground, near enough to see it, and never upside down."""
        diagonal = float(np.hypot(*ground.extent))
        distance = min(max(self.distance, _NEAREST * diagonal), _FARTHEST * diagonal)
        # what is no number, or beyond all distances, starts again over the middle of the ground
        known = all(abs(value) < _BEYOND for value in self.target)
        held = replace(
            self,
            target=self.target if known else ground.centre,
            distance=distance if math.isfinite(distance) else diagonal,
            heading=self.heading % 360.0 if math.isfinite(self.heading) else 0.0,
            pitch=_steep(self.pitch) if math.isfinite(self.pitch) else -45.0,
        )
        centre, eye = np.array(ground.centre), np.array(held.eye)
        away = math.dist(eye, centre)
        if away > _REACH * diagonal:
            eye = centre + (eye - centre) * (_REACH * diagonal / away)
        floor = height_at(ground, eye[0], eye[1]) + _CLEARANCE * diagonal
        eye[2] = max(eye[2], floor)
        return held._standing_at((float(eye[0]), float(eye[1]), float(eye[2])))

    def _moved(self, shift: np.ndarray) -> Rig:
        x, y, z = np.add(self.target, shift)
        return replace(self, target=(float(x), float(y), float(z)))

    def _standing_at(self, eye: Point) -> Rig:
        x, y, z = np.add(eye, np.multiply(self.distance, self.forward))
        return replace(self, target=(float(x), float(y), float(z)))


def height_at(ground: Heightmap, x: float, y: float) -> float:
    """Return the elevation at a world point, bilinear; outside and in holes that of the nearest.

    Holes count as the lowest elevation.
    """
    rows, columns = ground.shape
    column = (finite("x", x) - ground.origin[0]) / ground.spacing[0]
    row = (ground.origin[1] - finite("y", y)) / ground.spacing[1]
    column, row = min(max(column, 0.0), columns - 1.0), min(max(row, 0.0), rows - 1.0)
    left, top = min(int(column), columns - 2), min(int(row), rows - 2)
    u, v = column - left, row - top
    corners = ground.heights[top : top + 2, left : left + 2].astype(np.float64)
    if ground.mask is not None:
        low = ground.height_range[0] - ground.base
        corners = np.where(ground.mask[top : top + 2, left : left + 2], low, corners)
    west, east = (1 - v) * corners[0] + v * corners[1]
    return ground.base + float((1 - u) * west + u * east)


def _steep(pitch: float) -> float:
    return min(max(pitch, -_STEEPEST), _STEEPEST)
