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
from typing import Final, Protocol

import numpy as np

from ..arguments import finite
from ..camera.camera import Camera, Point, Vectors
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh

_STEEPEST: Final = 89.5  # degrees; at 90 up would be along the view
_NEAREST, _FARTHEST = 1e-4, 4.0  # distance to the target, in diagonals of the ground
_REACH: Final = 4.0  # how far the eye goes from the middle of the ground, in diagonals
_MOST_LOOKS: Final = 100_000  # along a ray
_BEYOND: Final = 1e15  # world units
_BEFORE: Final = 1e-5  # nothing nearer than that is seen, in distances to the target
_CLEARANCE: Final = 5e-4  # between eye and ground, in diagonals


class Place(Protocol):
    """What a camera is driven around in, see :class:`terrain_lod.viewer.view.scene.Scene`."""

    centre: Point
    diagonal: float

    def floor(self, x: float, y: float) -> float:
        """Return the height that an eye at a world point stays above."""


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

    def camera(self, size: tuple[int, int]) -> Camera:
        """Return the camera for a picture of `size`; a picture without pixels counts as one."""
        width, height = (max(1, int(extent)) for extent in size)
        near = _BEFORE * self.distance
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

    def within(self, scene: Place) -> Rig:
        """Return the rig kept above the ground, near enough to see it, and never upside down."""
        diagonal = scene.diagonal
        distance = min(max(self.distance, _NEAREST * diagonal), _FARTHEST * diagonal)
        # what is no number, or beyond all distances, starts again over the middle
        known = all(abs(value) < _BEYOND for value in self.target)
        held = replace(
            self,
            target=self.target if known else scene.centre,
            distance=distance if math.isfinite(distance) else diagonal,
            heading=self.heading % 360.0 if math.isfinite(self.heading) else 0.0,
            pitch=_steep(self.pitch) if math.isfinite(self.pitch) else -45.0,
        )
        centre, eye = np.array(scene.centre), np.array(held.eye)
        away = math.dist(eye, centre)
        if away > _REACH * diagonal:
            eye = centre + (eye - centre) * (_REACH * diagonal / away)
        eye[2] = max(eye[2], scene.floor(eye[0], eye[1]) + _CLEARANCE * diagonal)
        return held._standing_at((float(eye[0]), float(eye[1]), float(eye[2])))

    def _moved(self, shift: Vectors) -> Rig:
        x, y, z = np.add(self.target, shift)
        return replace(self, target=(float(x), float(y), float(z)))

    def _standing_at(self, eye: Point) -> Rig:
        x, y, z = np.add(eye, np.multiply(self.distance, self.forward))
        return replace(self, target=(float(x), float(y), float(z)))


def height_at(ground: Heightmap, x: float, y: float) -> float:
    """Return the elevation at a world point; see :func:`heights_at`."""
    return float(heights_at(ground, np.array([finite("x", x)]), np.array([finite("y", y)]))[0])


def heights_at(ground: Heightmap, x: Vectors, y: Vectors) -> Vectors:
    """Return elevations at world points (N,), bilinear; outside those of the nearest border.

    Holes count as the lowest elevation.
    """
    rows, columns = ground.shape
    column = np.clip((x - ground.origin[0]) / ground.spacing[0], 0.0, columns - 1.0)
    row = np.clip((ground.origin[1] - y) / ground.spacing[1], 0.0, rows - 1.0)
    left = np.minimum(column.astype(int), columns - 2)
    top = np.minimum(row.astype(int), rows - 2)
    u, v = column - left, row - top
    low = 0.0 if ground.mask is None else ground.height_range[0] - ground.base

    def sample(below: int, right: int) -> Vectors:
        heights: Vectors = ground.heights[top + below, left + right].astype(np.float64)
        if ground.mask is not None:
            heights[ground.mask[top + below, left + right]] = low
        return heights

    north = (1 - u) * sample(0, 0) + u * sample(0, 1)
    south = (1 - u) * sample(1, 0) + u * sample(1, 1)
    elevations: Vectors = ground.base + (1 - v) * north + v * south
    return elevations


def ground_seen(ground: Heightmap, camera: Camera, x: float, y: float) -> Point | None:
    """Return the world point of the ground that a pixel shows, None for the sky.

    Parameters
    ----------
    ground : Heightmap
    camera : Camera
    x, y : float
        Pixel, counted from the lower left.
    """
    eye, ray = np.array(camera.eye), _ray(camera, x, y)
    # where the ray is over the ground and no higher than its summits
    low, high = ground.height_range
    (x0, y0), (wide, deep) = ground.origin, ground.extent
    box = np.array([[x0, y0 - deep, low], [x0 + wide, y0, high]])
    with np.errstate(divide="ignore", invalid="ignore"):
        walls = np.sort(np.nan_to_num((box - eye) / ray, nan=0.0), axis=0)
    begin, end = max(0.0, float(walls[0].max())), float(walls[1].min())
    if not begin < end:
        return None
    # four looks a cell, then the crossing between the last above and the first below
    cells = (end - begin) * np.hypot(*(ray[:2] / ground.spacing))
    along = np.linspace(begin, end, int(min(4 * cells, _MOST_LOOKS)) + 2)
    points = eye + along[:, None] * ray
    above = points[:, 2] - heights_at(ground, points[:, 0], points[:, 1])
    below = np.flatnonzero(above <= 0)
    if not len(below):
        return None
    first = below[0]
    place = points[first]
    if first > 0:
        share = above[first - 1] / (above[first - 1] - above[first])
        place = points[first - 1] + share * (points[first] - points[first - 1])
    return float(place[0]), float(place[1]), float(place[2])


def triangle_seen(mesh: Mesh, camera: Camera, x: float, y: float) -> tuple[int, Point] | None:
    r"""Return the triangle that a pixel shows and the world point on it; None beside the mesh.

    Parameters
    ----------
    mesh : Mesh
    camera : Camera
    x, y : float
        Pixel, counted from the lower left.

    Notes
    -----
    Seen along the ray, every triangle is flat, and those that the ray meets hold the point 0::

            c           orientations of 0ab, 0bc, 0ca: all of them left, or all of them right;
           / \          they are the weights of c, a and b where the ray meets the triangle
          / 0 \
         a-----b
    """
    ray = _ray(camera, x, y)
    across = np.cross(ray, camera.axes[1])
    axes = np.stack([across, np.cross(across, ray), ray / (ray @ ray)], axis=1)
    seen = (mesh.vertices + (mesh.origin - camera.eye)) @ axes
    a, b, c = (seen[mesh.triangles[:, corner]] for corner in range(3))
    weights = np.stack([_turn(b, c), _turn(c, a), _turn(a, b)], axis=1)
    met = np.flatnonzero((weights >= 0).all(axis=1) | (weights <= 0).all(axis=1))
    deep = np.stack([a[met, 2], b[met, 2], c[met, 2]], axis=1)
    with np.errstate(invalid="ignore"):  # triangles seen from their side have no weights
        depths = (weights[met] * deep).sum(axis=1) / weights[met].sum(axis=1)
    depths[~(depths > 0)] = np.inf
    if not (depths < np.inf).any():
        return None
    first = int(depths.argmin())
    point = np.add(camera.eye, depths[first] * ray)
    return int(met[first]), (float(point[0]), float(point[1]), float(point[2]))


def _turn(a: Vectors, b: Vectors) -> Vectors:
    turn: Vectors = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return turn


def _ray(camera: Camera, x: float, y: float) -> Vectors:
    """Return the direction, 1 deep, in which the middle of a pixel looks."""
    width, height = camera.size
    across, up = camera.half_extents
    right, upward, forward = camera.axes
    shares = 2 * (x + 0.5) / width - 1, 2 * (y + 0.5) / height - 1
    ray: Vectors = forward + shares[0] * across * right + shares[1] * up * upward
    return ray


def _steep(pitch: float) -> float:
    return min(max(pitch, -_STEEPEST), _STEEPEST)
