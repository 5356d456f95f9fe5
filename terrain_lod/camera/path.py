"""Ways for a camera over ground: around it, across it, or through cameras of a file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import whole
from ..ground.heightmap import Heightmap
from .camera import FOV, SIZE, Camera
from .camera_file import load_cameras
from .viewpoint import orbit_camera

_MOST: Final = 100_000  # pictures of a path
_KEYS: Final = 9  # places that a flight across passes
_FLIGHT: Final = 0.035  # its height above the ground, in diagonals
_AHEAD: Final = 0.16  # how far before it a flight looks, in its length


def orbit(ground: Heightmap, frames: int, *, camera: Camera | None = None) -> tuple[Camera, ...]:
    """Return cameras once around a target, clockwise.

    Parameters
    ----------
    ground : Heightmap
    frames : int
    camera : Camera, optional
        The first; defaults to one from the south that has all of the ground in every picture.
    """
    count = whole("frames", frames, 1, _MOST)
    camera = camera or orbit_camera(ground)
    away = np.subtract(camera.eye, camera.target)
    cameras = []
    for turn in 2 * np.pi * np.arange(count) / count:
        cos, sin = np.cos(turn), np.sin(turn)
        turned = (cos * away[0] + sin * away[1], cos * away[1] - sin * away[0], away[2])
        cameras.append(replace(camera, eye=_point(np.add(camera.target, turned))))
    return tuple(cameras)


def flyover(
    ground: Heightmap, frames: int, *, size: tuple[int, int] = SIZE, fov: float = FOV
) -> tuple[Camera, ...]:
    """Return cameras of a flight from the south to the north, in gentle bends, above the summits.

    Parameters
    ----------
    ground : Heightmap
    frames : int
    size : (int, int), optional
        Of the pictures.
    fov : float, optional
        Vertical, degrees.
    """
    from scipy.interpolate import CubicSpline

    count = whole("frames", frames, 1, _MOST)
    width, depth = ground.extent
    diagonal = float(np.hypot(width, depth))
    along = np.linspace(0.0, 1.0, _KEYS)
    x = ground.origin[0] + width * (0.5 + 0.22 * np.sin(2 * np.pi * along))
    y = ground.origin[1] - depth * (1.0 - along)
    z = _summits(ground, x, y) + _FLIGHT * diagonal
    way = CubicSpline(along, np.stack([x, y, z], axis=1))
    at = np.linspace(0.02, 0.98 - _AHEAD, count)
    eyes, targets = way(at), way(at + _AHEAD)
    targets[:, 2] -= 1.5 * _FLIGHT * diagonal
    return tuple(
        Camera(_point(eye), _point(target), fov=fov, size=size)
        for eye, target in zip(eyes, targets, strict=True)
    )


def load_path(
    path: Path, frames: int, *, size: tuple[int, int] | None = None
) -> tuple[Camera, ...]:
    """Return cameras through those of a JSON file, a list of objects with the fields of a Camera.

    Between them eye and target follow cubic splines, the rest straight lines; the first and the
    last are met exactly.

    Raises
    ------
    FileError
        If the file cannot be read.
    InputError
        If it is no list of cameras.
    """
    from scipy.interpolate import CubicSpline

    count = whole("frames", frames, 1, _MOST)
    keys = load_cameras(path)
    if size is not None:
        keys = [replace(key, size=size) for key in keys]
    if len(keys) == 1:
        return tuple(keys) * count
    given = np.arange(len(keys))
    at = np.linspace(0, len(keys) - 1, count)
    eyes = CubicSpline(given, [key.eye for key in keys])(at)
    targets = CubicSpline(given, [key.target for key in keys])(at)
    ups = np.stack([np.interp(at, given, [key.up[axis] for key in keys]) for axis in range(3)], 1)
    fovs = np.interp(at, given, [key.fov for key in keys])
    return tuple(
        replace(keys[0], eye=_point(eye), target=_point(target), up=_point(up), fov=float(fov))
        for eye, target, up, fov in zip(eyes, targets, ups, fovs, strict=True)
    )


def _summits(
    ground: Heightmap, x: npt.NDArray[np.float64], y: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return elevations above all ground near each point, without steps between neighbours."""
    from scipy.ndimage import gaussian_filter, maximum_filter

    heights = np.where(ground.valid, ground.heights, ground.heights.min())
    reach = max(3, max(ground.shape) // 8)
    step = max(1, reach // 32)  # a flight needs no more
    highest = maximum_filter(heights[::step, ::step], size=reach // step | 1)
    smooth = gaussian_filter(highest, sigma=reach / step / 4)
    row = np.clip((ground.origin[1] - y) / ground.spacing[1] / step, 0, smooth.shape[0] - 1)
    column = np.clip((x - ground.origin[0]) / ground.spacing[0] / step, 0, smooth.shape[1] - 1)
    above: npt.NDArray[np.float64] = smooth[row.astype(int), column.astype(int)] + ground.base
    return above


def _point(values: npt.NDArray[np.float64] | tuple[float, ...]) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z
