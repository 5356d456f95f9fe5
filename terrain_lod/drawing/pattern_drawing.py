"""Tessellation patterns drawn: triangles, rings, control points, and factors at their edges.

u is to the right and v down; a triangle is drawn with equal sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from ..device.layout import FIXED_ONE
from ..tessellation.pattern import Pattern
from .pattern_rings import edges_of_triangles, strips_of_triangles

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Places = npt.NDArray[np.float64]
Factors = npt.NDArray[Any]

_INK: Final = "#1d3446"
_LINE: Final = "#5b7c92"
_CONTROL: Final = "#d9541e"
_OUTER: Final = (0.90, 0.95, 0.98)  # strips, from the outermost
_INNER: Final = (0.36, 0.62, 0.79)
_KINDS: Final = {"semi_uniform": "semi-uniform, levels"}
_MOST_DOTS: Final = 1200  # more points than that are not marked


class _Edge(NamedTuple):
    """Where the label of an edge stands in the plane, and how it is turned, in degrees."""

    name: str
    place: tuple[float, float]
    turn: float


class _Frame(NamedTuple):
    """How a domain lies in the plane: x to the right, y down."""

    u: tuple[float, float]
    v: tuple[float, float]
    corners: tuple[tuple[int, int], ...]  # u, v of the control points
    edges: tuple[_Edge, ...]


_HALF: Final = 0.5
_HEIGHT: Final = 0.8660254037844386  # of a triangle with sides of 1
_QUAD: Final = _Frame(
    (1.0, 0.0),
    (0.0, 1.0),
    ((0, 0), (1, 0), (0, 1), (1, 1)),
    (
        _Edge("u = 0", (-0.06, _HALF), 90),
        _Edge("v = 0", (_HALF, -0.06), 0),
        _Edge("u = 1", (1.06, _HALF), -90),
        _Edge("v = 1", (_HALF, 1.06), 0),
    ),
)
_FRAMES: Final = {
    "quad": _QUAD,
    "isoline": _QUAD._replace(edges=()),
    "triangle": _Frame(
        (1.0, 0.0),
        (_HALF, _HEIGHT),
        ((0, 0), (1, 0), (0, 1)),
        (
            _Edge("u = 0", (0.19, 0.47), -60),
            _Edge("v = 0", (_HALF, -0.06), 0),
            _Edge("w = 0", (0.81, 0.47), 60),
        ),
    ),
}


def draw_pattern(
    figure: Figure, pattern: Pattern, patch: int, labels: tuple[Factors | None, Factors | None]
) -> None:
    """Draw a patch into an empty figure, with its edge and inside factors (P, n) as labels."""
    frame = _FRAMES[pattern.domain]
    begin, end = pattern.point_offsets[patch : patch + 2]
    points = pattern.points[begin:end].astype(np.int64)
    low, high = pattern.primitive_offsets[patch : patch + 2]
    primitives = pattern.primitives[low:high].astype(np.intp) - begin
    places = points / FIXED_ONE @ np.array([frame.u, frame.v])
    axes = figure.add_axes((0.02, 0.02, 0.96, 0.86))
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.set_xlim(-0.12, 1.12)
    axes.set_ylim(max(frame.u[1], frame.v[1]) + 0.12, -0.12)
    if pattern.domain == "isoline":
        _draw_lines(axes, places[primitives], _LINE, 0.9)
    else:
        _draw_strips(axes, pattern.domain, points, places, primitives)
    _draw_points(axes, points, places, pattern.domain)
    _draw_corners(axes, frame)
    edges, insides = (None if factors is None else factors[patch] for factors in labels)
    if edges is not None:
        for edge, factor in zip(frame.edges, edges, strict=False):
            x, y = edge.place
            text = f"{edge.name}:  {factor:.4g}"
            axes.text(x, y, text, rotation=edge.turn, ha="center", va="center", color=_INK)
    _draw_heading(figure, pattern, len(points), len(primitives), edges, insides)


def _draw_strips(
    axes: Axes, domain: str, points: npt.NDArray[np.int64], places: Places, triangles: Any
) -> None:
    """Fill the triangles, darker further in, and draw them and the rings between the strips."""
    from matplotlib.collections import PolyCollection

    strips = strips_of_triangles(domain, points, triangles)
    share = strips / max(int(strips.max(initial=0)), 1)
    colours = np.outer(1 - share, _OUTER) + np.outer(share, _INNER)
    fill = PolyCollection(list(places[triangles]), facecolors=colours, edgecolors="none")
    axes.add_collection(fill)
    edges, on_ring = edges_of_triangles(points, triangles, strips)
    _draw_lines(axes, places[edges[~on_ring]], _LINE, 0.6)
    _draw_lines(axes, places[edges[on_ring]], _INK, 1.4)


def _draw_lines(axes: Axes, lines: Places, colour: str, width: float) -> None:
    """Draw segments (n, 2, 2) as one path, which keeps files small."""
    gaps = np.full((len(lines), 1, 2), np.nan)
    x, y = np.concatenate([lines, gaps], axis=1).reshape(-1, 2).T
    axes.plot(x, y, color=colour, linewidth=width, solid_capstyle="round", zorder=2)


def _draw_points(axes: Axes, points: npt.NDArray[np.int64], places: Places, domain: str) -> None:
    """Mark points: filled on the boundary, hollow inside."""
    if len(points) > _MOST_DOTS:
        return
    outside = (points == 0) | (points == FIXED_ONE)
    on_edge = outside.any(axis=1)
    if domain == "triangle":
        on_edge |= points.sum(axis=1) == FIXED_ONE
    size = 14.0 if len(points) < 300 else 6.0
    for chosen, colour in ((~on_edge, "white"), (on_edge, _INK)):
        x, y = places[chosen].T
        axes.scatter(x, y, s=size, facecolors=colour, edgecolors=_INK, linewidths=0.7, zorder=3)


def _draw_corners(axes: Axes, frame: _Frame) -> None:
    """Mark the control points at the corners of the domain, each with its u, v."""
    corners = np.array(frame.corners) @ np.array([frame.u, frame.v])
    x, y = corners.T
    axes.scatter(x, y, s=46, marker="s", facecolors=_CONTROL, edgecolors="white", zorder=4)
    middle = corners.mean(axis=0)
    for (u, v), corner in zip(frame.corners, corners, strict=True):
        across, down = corner + 0.075 * np.sign(corner - middle)
        axes.text(across, down, f"{u}, {v}", ha="center", va="center", color=_CONTROL, fontsize=8)


def _draw_heading(
    figure: Figure,
    pattern: Pattern,
    point_count: int,
    primitive_count: int,
    edges: Sequence[float] | Factors | None,
    insides: Sequence[float] | Factors | None,
) -> None:
    kind = _KINDS.get(pattern.partitioning, pattern.partitioning.replace("_", " "))
    primitives = "segments" if pattern.domain == "isoline" else "triangles"
    facts = f"{point_count} points, {primitive_count} {primitives}"
    if insides is not None and len(insides):
        facts = f"inside {', '.join(f'{factor:.4g}' for factor in insides)}:  {facts}"
    if pattern.domain == "isoline" and edges is not None:
        facts = f"factors {edges[0]:.4g}, {edges[1]:.4g}:  {facts}"
    figure.text(0.5, 0.955, f"{pattern.domain}, {kind}", ha="center", color=_INK, fontsize=12)
    figure.text(0.5, 0.905, facts, ha="center", color=_LINE)
