"""A good place to look at ground or a mesh from, when nobody names one."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..arguments import instance
from ..ground.exaggeration import exaggerated
from ..ground.heightmap import Heightmap
from .camera import FOV, SIZE, Camera, Vectors

# across, back and up from the middle of a mesh to the eye, in diagonals
_EYE: Final = (0.5, -1.0, 0.6)
# of the ground, and of the picture, that a view over the ground shows and fills at least
_SHOWN, _FILLED = 0.4, 0.25
# of the picture's half width and height that ground may take when all of it is to be seen: notes
# stand below
_MARGINS: Final = (0.92, 0.76)
_PITCH: Final = -28.0  # degrees, when all of it is to be seen
# degrees, the most wanted first
_HEADINGS: Final = (15, 0, 30, -15, 45, -30, 60, -45, -60, 75, -75, 90)
_POINTS: Final = 48  # samples along an axis that stand for all


def default_camera(
    ground: Heightmap,
    *,
    fov: float = FOV,
    size: tuple[int, int] = SIZE,
    exaggeration: float = 1.0,
) -> Camera:
    """Return an oblique view over the ground: from its southern edge, looking north.

    The eye stands above the highest ground near it, so that the picture runs from the tiles at its
    feet to the horizon. Where that shows too little, as of ground that is tall for its width or
    wide for its depth, the eye steps back until all of the ground is in the picture.

    Parameters
    ----------
    ground : Heightmap
    fov : float, optional
        Vertical, degrees.
    size : (int, int), optional
        Of the picture, pixels.
    exaggeration : float, optional
        Of the heights in the picture. The camera is in the true world all the same.
    """
    ground = exaggerated(instance("a Heightmap for ground", ground, Heightmap), exaggeration)
    return _best_view(ground, fov, size).lifted(1 / exaggeration)


def _best_view(ground: Heightmap, fov: float, size: tuple[int, int]) -> Camera:
    """Return the view over the ground if it shows enough, else the best of all of it."""
    points = _points(ground)
    over = _view_over(ground, fov, size)
    pixels, depth = over.project(points)
    ahead = depth > 0
    above = ahead & (pixels[:, 1] < 0) & (np.abs(2 * pixels[:, 0] / size[0] - 1) < 1)
    seen = ahead & (pixels >= 0).all(axis=1) & (pixels <= size).all(axis=1)
    shows_it = not above.any() and seen.mean() >= _SHOWN
    if shows_it and _covered(over, points[seen]) >= _FILLED:
        return over
    views = [_whole_view(points, heading, fov, size) for heading in _HEADINGS]
    return max(views, key=lambda view: _covered(view, points))


def orbit_camera(
    ground: Heightmap,
    *,
    fov: float = FOV,
    size: tuple[int, int] = SIZE,
    exaggeration: float = 1.0,
) -> Camera:
    """Return a view of all of the ground that still shows all of it from every other side.

    It looks north at the middle of the ground, which :func:`terrain_lod.camera.path.orbit` turns
    around. What it is given is as for :func:`default_camera`.
    """
    ground = exaggerated(instance("a Heightmap for ground", ground, Heightmap), exaggeration)
    centre = ground.centre
    away = _points(ground) - centre
    # the ground turned on its middle: every sample everywhere on its circle
    radii, turns = np.hypot(away[:, 0], away[:, 1]), np.arange(0, 2 * np.pi, np.pi / 12)
    circles = radii[:, None] * np.cos(turns), radii[:, None] * np.sin(turns)
    rises = np.broadcast_to(away[:, 2:], circles[0].shape)
    swept = np.stack([*circles, rises], axis=-1).reshape(-1, 3) + centre
    view = _whole_view(swept, 0.0, fov, size)
    # it looks north: where its view meets the middle of the ground, the turns are around that
    forward = view.axes[2]
    ahead = (centre[1] - view.eye[1]) / forward[1]
    target = (centre[0], centre[1], view.eye[2] + ahead * float(forward[2]))
    return replace(view, eye=(centre[0], *view.eye[1:]), target=target).lifted(1 / exaggeration)


def camera_around(
    points: npt.NDArray[np.floating[Any]], origin: npt.ArrayLike = (0.0, 0.0, 0.0)
) -> Camera:
    """Return a view of all `points` (N, 3), relative to `origin`: from the south, above them."""
    seen = points if len(points) else np.zeros((1, 3))
    low, high = (bound.astype(np.float64) for bound in (seen.min(axis=0), seen.max(axis=0)))
    middle, diagonal = (low + high) / 2 + origin, float(np.linalg.norm(high - low)) or 1.0
    eye = middle + np.multiply(_EYE, diagonal)
    return Camera(tuple(eye.tolist()), tuple(middle.tolist()))


def _view_over(ground: Heightmap, fov: float, size: tuple[int, int]) -> Camera:
    """Return the view from the southern edge, whatever it shows."""
    x, y, _ = ground.centre
    width, depth = ground.extent
    low, high = ground.height_range
    diagonal = float(np.hypot(width, depth))
    eye = (x - 0.20 * width, y - 0.50 * depth)
    target = (x + 0.06 * width, y - 0.03 * depth, low + 0.3 * (high - low))
    nearby = _highest_near(ground, eye, 0.20 * diagonal)
    height = max(target[2] + 0.16 * diagonal, nearby + 0.02 * diagonal)
    return Camera((*eye, height), target, fov=fov, size=size)


def _whole_view(points: Vectors, heading: float, fov: float, size: tuple[int, int]) -> Camera:
    r"""Return the nearest view of all `points` (N, 3) in a heading, degrees clockwise from north.

    Notes
    -----
    Along the view's own axes, a point (x, f) is within the picture of an eye (e, d) whose sides
    open by t where ``|x - e| <= t (f - d)``. All of them are where::

         max(x - t f) + t d  <=  e  <=  min(x + t f) - t d

    which has an answer up to the d at which both sides meet; and the same upwards.
    """
    turn, rise = math.radians(heading), math.radians(_PITCH)
    forward = np.array([math.sin(turn), math.cos(turn), 0.0]) * math.cos(rise)
    forward[2] = math.sin(rise)
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    # only its axes and the opening of its sides are asked of this one
    view = Camera(_tuple(middle - forward), _tuple(middle), fov=fov, size=size)
    *across, depth = ((points - middle) @ axis for axis in view.axes)
    opening = np.multiply(_MARGINS, view.half_extents)
    ends = [
        (float((x - t * depth).max()), float((x + t * depth).min()), t)
        for x, t in zip(across, opening, strict=True)
    ]
    # however flat or small the ground, the eye is not in it
    near = -0.01 * float(np.linalg.norm(np.ptp(points, axis=0)))
    back = min([near, *((high - low) / (2 * t) for low, high, t in ends)])
    sideways = [(low + high) / 2 for low, high, _ in ends]
    on_axis = middle + sideways[0] * view.axes[0] + sideways[1] * view.axes[1]
    return Camera(_tuple(on_axis + back * forward), _tuple(on_axis), fov=fov, size=size)


def _covered(view: Camera, points: Vectors) -> float:
    """Return the share of the picture that the outline of all points takes."""
    from scipy.spatial import ConvexHull, QhullError

    pixels, _ = view.project(points)
    try:
        return float(ConvexHull(pixels).volume) / (view.size[0] * view.size[1])
    except (QhullError, ValueError):  # a line, or none
        return 0.0


def _points(ground: Heightmap) -> Vectors:
    """Return world points that stand for the ground: samples all over it, borders and summits too.

    (N, 3) float64.
    """
    rows, columns = (
        np.unique(np.linspace(0, extent - 1, min(extent, _POINTS)).astype(int))
        for extent in ground.shape
    )
    # the highest of the samples around each
    parts = np.where(ground.valid, ground.heights, -np.inf)
    tops = np.maximum.reduceat(np.maximum.reduceat(parts, rows, axis=0), columns, axis=1)
    y, x = np.nonzero(np.isfinite(tops))
    return np.stack(
        [
            ground.origin[0] + ground.spacing[0] * columns[x],
            ground.origin[1] - ground.spacing[1] * rows[y],
            ground.base + tops[y, x].astype(np.float64),
        ],
        axis=1,
    )


def _highest_near(ground: Heightmap, point: tuple[float, float], radius: float) -> float:
    """Return the highest elevation within `radius` of a world point, or of all ground if none."""
    rows, columns = ground.shape
    x = ground.origin[0] + ground.spacing[0] * np.arange(columns) - point[0]
    y = ground.origin[1] - ground.spacing[1] * np.arange(rows) - point[1]
    near = (np.hypot(x, y[:, None]) <= radius) & ground.valid
    return ground.base + float(ground.heights[near].max()) if near.any() else ground.height_range[1]


def _tuple(values: Iterable[float]) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z
