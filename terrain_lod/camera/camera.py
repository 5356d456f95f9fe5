"""Where the picture is taken from, and what it can see."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import array, finite, numbers, parts, positive, whole
from ..device import layout
from ..errors import InputError

Point = tuple[float, float, float]
Vectors = npt.NDArray[np.float64]

FOV: Final = 45.0
"""Degrees from the bottom of a picture to its top, unless said otherwise."""
SIZE: Final = (1920, 1080)
"""Width and height of a picture in pixels, unless said otherwise."""

_FARTHEST: Final = 1e30  # squares of squares stay finite


@dataclass(frozen=True)
class Camera:
    """A camera in world coordinates: perspective, or parallel where `height` is given.

    Parameters
    ----------
    eye, target : (float, float, float)
        Where the camera stands and what it looks at, in world units.
    up : (float, float, float), optional
        Which way is up in the picture; not parallel to the view.
    fov : float, optional
        Vertical field of view in degrees, between 0 and 180.
    size : (int, int), optional
        Width and height of the picture in pixels.
    near, far : float, optional
        Depths of the clipping planes in world units; `far` may be infinite.
    height : float, optional
        World height of the picture of a parallel (orthographic) camera; `fov` means nothing then.

    Raises
    ------
    InputError
        If the camera stands in its own target, looks along `up`, or a number is out of range.
    """

    eye: Point
    target: Point
    up: Point = (0.0, 0.0, 1.0)
    fov: float = FOV
    size: tuple[int, int] = SIZE
    near: float = 0.1
    far: float = math.inf
    height: float | None = None

    def __post_init__(self) -> None:
        for name in ("eye", "target", "up"):
            object.__setattr__(self, name, point(name, getattr(self, name)))
        object.__setattr__(self, "size", _size(self.size))
        for name, check in (("fov", finite), ("near", positive), ("height", positive)):
            if name != "height" or self.height is not None:
                object.__setattr__(self, name, check(name, getattr(self, name)))
        if not 0 < self.fov < 180:
            raise InputError(f"expected fov between 0 and 180 degrees, got {self.fov:g}")
        # an array may be infinite here and there
        if not (isinstance(self.far, float | np.floating) and self.far == math.inf):
            object.__setattr__(self, "far", finite("far", self.far))
        for name in ("near", "far", "height"):
            if _FARTHEST < (length := getattr(self, name) or 0.0) < math.inf:
                raise InputError(f"expected {name} up to {_FARTHEST:g}, got {length:g}")
        if self.far <= self.near:
            raise InputError(f"expected far > near, got far {self.far:g} and near {self.near:g}")
        if self.eye == self.target:
            raise InputError(f"expected a camera away from its target, got both at {self.eye}")
        view = np.subtract(self.target, self.eye)
        across = np.linalg.norm(np.cross(view, self.up))
        if across <= 1e-9 * np.linalg.norm(view) * np.linalg.norm(self.up):
            raise InputError(f"expected up across the view, got up {self.up} parallel to it")

    @property
    def axes(self) -> Vectors:
        """Unit vectors to the right, upwards and forward of the picture; (3, 3) rows."""
        forward = _unit(np.subtract(self.target, self.eye))
        right = _unit(np.cross(forward, self.up))
        return np.stack([right, np.cross(right, forward), forward])

    @property
    def half_extents(self) -> tuple[float, float]:
        """Half the picture's width and height: at depth 1, or at any where parallel."""
        vertical = self.height / 2 if self.height else math.tan(math.radians(self.fov) / 2)
        return vertical * self.size[0] / self.size[1], vertical

    @property
    def focal(self) -> float:
        """Pixels that size 1 covers mid-picture: at depth 1, or at any where parallel."""
        return self.size[1] / (2 * self.half_extents[1])

    def lifted(self, exaggeration: float) -> Camera:
        """Return the camera with eye and target at so many times their heights.

        What it sees of ground that is exaggerated as much, this one sees of the ground as it is.
        """
        if exaggeration == 1:
            return self
        eye, target = ((x, y, z * exaggeration) for x, y, z in (self.eye, self.target))
        return replace(self, eye=eye, target=target)

    def planes(self, origin: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Vectors:
        """Return the frustum: left, right, bottom, top, near, far.

        Parameters
        ----------
        origin : (3,) array_like
            World point that the planes are relative to.

        Returns
        -------
        (6, 4) float64
            Unit normals n into the frustum and offsets w: a point p relative to `origin` is
            inside where ``n @ p + w >= 0`` for all six. An infinite far plane is (0, 0, 0, 1).
        """
        right, upward, forward = self.axes
        width, height = self.half_extents
        eye = np.subtract(self.eye, point("origin", origin))
        planes = []
        for across, half in ((right, width), (-right, width), (upward, height), (-upward, height)):
            # through the eye and along the side of the picture; where parallel, along the view
            normal = across if self.height else _unit(across + half * forward)
            shift = half if self.height else 0.0
            planes.append(np.append(normal, shift - normal @ eye))
        planes.append(np.append(forward, -forward @ eye - self.near))
        if math.isinf(self.far):
            planes.append(np.array([0.0, 0.0, 0.0, 1.0]))
        else:
            planes.append(np.append(-forward, forward @ eye + self.far))
        return np.stack(planes)

    def project(self, points: npt.ArrayLike) -> tuple[Vectors, Vectors]:
        """Return pixel coordinates (N, 2), y down, and depths (N,) of world `points` (N, 3).

        Points behind the eye have a depth <= 0 and pixel coordinates that mean nothing.
        """
        right, upward, forward = self.axes
        relative = array("points", points, ("N", 3)) - self.eye
        depth = relative @ forward
        width, height = self.half_extents
        scale = np.ones_like(depth) if self.height else depth
        with np.errstate(divide="ignore", invalid="ignore"):
            x = (relative @ right) / (scale * width)
            y = (relative @ upward) / (scale * height)
        pixels = np.stack([(1 + x) / 2 * self.size[0], (1 - y) / 2 * self.size[1]], axis=-1)
        return pixels, depth

    def view(self, origin: npt.ArrayLike) -> npt.NDArray[np.void]:
        """Return the ``layout.VIEW`` record that kernels take, relative to `origin`."""
        record = np.zeros((), layout.VIEW)
        record["eye"] = np.subtract(self.eye, point("origin", origin))
        record["planes"] = self.planes(origin)
        record["axes"] = self.axes
        record["focal"] = self.focal
        record["widest"] = 0.0 if self.height else math.hypot(*self.half_extents)
        record["near"] = self.near
        record["parallel"] = self.height is not None
        return record


def point(name: str, value: object) -> Point:
    """Return `value` as finite x, y, z."""
    x, y, z = numbers(name, value, "x", "y", "z")
    if max(abs(x), abs(y), abs(z)) > _FARTHEST:
        raise InputError(f"expected {name} within {_FARTHEST:g} of the origin, got {(x, y, z)}")
    return x, y, z


def _size(value: object) -> tuple[int, int]:
    width, height = parts("size", value, "width", "height")
    return whole("size", width, 1, 2**20), whole("size", height, 1, 2**20)


def _unit(vector: Vectors) -> Vectors:
    return vector / np.linalg.norm(vector)
