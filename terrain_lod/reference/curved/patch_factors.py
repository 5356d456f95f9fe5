"""Tessellation factors of edges in float64: what ``kernels/curved/factor/`` computes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Parameters = Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Edge:
    """What a formula knows of an edge.

    Attributes
    ----------
    ends : (2, 3)
    lifts : (2, 3)
        Of the curve's two inner control points from the straight edge, times three.
    normals : (4, 3)
        Of the mesh, at both ends of both sides.
    faces : (2, 3)
        Unit normals of the plane triangles at both sides, zero where one has no area.
    outline : bool
        There is one side only.
    """

    ends: Array
    lifts: Array
    normals: Array
    faces: Array
    outline: bool

    @property
    def length(self) -> float:
        return float(np.linalg.norm(self.ends[1] - self.ends[0]))

    def distance(self, view: npt.NDArray[Any]) -> float:
        """Return the distance from the eye to the edge's middle."""
        return float(np.linalg.norm(self.ends.mean(axis=0) - view["eye"]))

    def to_eye(self, view: npt.NDArray[Any]) -> Array:
        """Return the unit vector from the middle to the eye."""
        if view["parallel"]:
            towards: Array = -view["axes"][2].astype(np.float64)
            return towards
        towards = view["eye"] - self.ends.mean(axis=0)
        return np.asarray(towards / np.linalg.norm(towards))


def edge_of(triangles: npt.NDArray[np.int32], patches: npt.NDArray[np.int32],
            places: npt.NDArray[np.int32], positions: Array, normals: Array,
            controls: Array) -> Edge:  # fmt: skip
    """Return the edge at two `places` of the flattened edges of (T, 3) triangles.

    `controls` are the (T, 10, 3) control points of the (T, 12) `patches`.
    """
    triangle, side = divmod(int(places[0]), 3)
    corners = triangles[triangle][[(side + 1) % 3, (side + 2) % 3]]
    adjacent = patches[triangle, 3 + 2 * side : 5 + 2 * side]
    ends = positions[corners]
    straight = np.stack([2 * ends[0] + ends[1], ends[0] + 2 * ends[1]]) / 3
    faces = []
    for place in places:
        a, b, c = positions[triangles[int(place) // 3]]
        across = np.cross(b - a, c - a)
        faces.append(across / (np.linalg.norm(across) or 1.0))
    return Edge(
        ends=ends,
        lifts=3 * (controls[triangle, 3 + 2 * side : 5 + 2 * side] - straight),
        normals=normals[[*corners, *np.where(adjacent < 0, corners, adjacent)]],
        faces=np.array(faces),
        outline=bool(places[0] == places[1]),
    )


def uniform(edge: Edge, view: npt.NDArray[Any], parameters: Parameters) -> float:
    """The same everywhere."""
    return parameters["factor"]


def distance(edge: Edge, view: npt.NDArray[Any], parameters: Parameters) -> float:
    """(1 - t) maximum + t minimum, with t from 0 at `near` to 1 at `far`."""
    near, far = parameters["near"], parameters["far"]
    t = np.clip((edge.distance(view) - near) / (far - near), 0, 1)
    return float((1 - t) * parameters["maximum"] + t * parameters["minimum"])


def length(edge: Edge, view: npt.NDArray[Any], parameters: Parameters) -> float:
    """Pixels across the edge's bounding sphere, over those of a segment."""
    return _clamped(
        edge.length * _pixels_per_unit(view, edge.distance(view)) / parameters["pixels"], parameters
    )


def orientation(edge: Edge, view: npt.NDArray[Any], parameters: Parameters) -> float:
    """More the more the surface is seen from its side."""
    cosine = min(1.0, float(np.abs(edge.normals @ edge.to_eye(view)).min()))
    minimum, maximum = parameters["minimum"], parameters["maximum"]
    return minimum + (maximum - minimum) * (1 - cosine)


def silhouette(edge: Edge, view: npt.NDArray[Any], parameters: Parameters) -> float:
    """Dyken's silhouetteness: 1 between a face seen from the front and one seen from behind."""
    first, second = edge.faces @ edge.to_eye(view)
    off = min(abs(first), abs(second)) / parameters["cosine"]
    on_outline = edge.outline or first * second <= 0
    minimum, maximum = parameters["minimum"], parameters["maximum"]
    return minimum + (maximum - minimum) * (1.0 if on_outline else 1 - min(off, 1.0))


def curvature(edge: Edge, view: npt.NDArray[Any], parameters: Parameters) -> float:
    """Segments that keep a polyline within pixels of a curve of known second derivative."""
    a, b = edge.lifts
    bend = max(np.linalg.norm(2 * b - 4 * a), np.linalg.norm(2 * a - 4 * b))
    pixels = bend / 8 * _pixels_per_unit(view, edge.distance(view) - edge.length / 2)
    segments = min(float(np.sqrt(pixels / parameters["pixels"])), parameters["maximum"])
    return _clamped(factor_for(segments), parameters)


def factor_for(segments: float) -> float:
    """Return the least factor with no segment longer than 1 / segments in any partitioning.

    Between whole factors n and n + 2 of a fractional partitioning the longest segment falls in a
    straight line from 1 / n to 1 / (n + 2).
    """
    factor = 1.0
    for least in (1, 2):
        if segments > least:
            n = segments - (segments - least) % 2
            factor = max(factor, n + 2 * (1 / n - 1 / segments) / (1 / n - 1 / (n + 2)))
    return factor


def _pixels_per_unit(view: npt.NDArray[Any], distance: float) -> float:
    focal = float(view["focal"])
    return focal if view["parallel"] else focal / max(distance, float(view["near"]))


def _clamped(factor: float, parameters: Parameters) -> float:
    return min(max(factor, parameters["minimum"]), parameters["maximum"])


Formula = Callable[[Edge, npt.NDArray[Any], Parameters], float]
"""Segments along an edge, from what is known of it, the view and the formula's numbers."""

FORMULAS: Final[Mapping[str | Path, Formula]] = {
    "curved/factor/uniform.h": uniform,
    "curved/factor/distance.h": distance,
    "curved/factor/length.h": length,
    "curved/factor/orientation.h": orientation,
    "curved/factor/silhouette.h": silhouette,
    "curved/factor/curvature.h": curvature,
}
