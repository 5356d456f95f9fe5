"""The Direct3D 11 tessellator as its specification walks it: rings, from the outside in.

Plain integers, one patch after the other, each ring stitched to the next by stepping along both.
The kernels compute the same points in the same order, and the same triangles, but each in closed
form; they give the triangles in another order: compare :func:`sorted_primitives`.

After the Direct3D 11.3 Functional Specification, chapter Tessellator.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ...tessellation.pattern import Pattern
from .division import ONE, Division, Triangle, divide, fixed_factor, stitch

Point = tuple[int, int]


@dataclass(frozen=True)
class PatchPattern:
    """Points, and triangles or lines between them, of one patch."""

    points: list[Point]
    primitives: list[tuple[int, ...]]


Rows = list[list[int]]  # of a ring's sides: indices of their points, in the direction of the walk


def _boundary(
    points: list[Point], sides: Sequence[Division], point: Callable[[int, int], Point]
) -> Rows:
    """Append the points around a patch and return its sides; each ends where the next begins.

    ``point(edge, along)`` is the point at `along` of the walk along an edge, 0 to ONE.
    """
    starts = [len(points)]
    for edge, side in enumerate(sides):
        points += [point(edge, place) for place in side.places[:-1]]
        starts.append(len(points))
    ends = [*starts[1:-1], starts[0]]
    return [[*range(a, b), end] for a, b, end in zip(starts[:-1], starts[1:], ends, strict=True)]


def _quad_point(edge: int, along: int) -> Point:
    """Return a boundary point: the walk begins at u = 0, v = 1 and is clockwise, v down."""
    return ((0, ONE - along), (along, 0), (ONE, along), (ONE - along, ONE))[edge]


def _triangle_point(edge: int, along: int) -> Point:
    """Return a boundary point: the walk begins at v = 1, then w = 1, then u = 1."""
    return ((0, ONE - along), (along, 0), (ONE - along, along))[edge]


def quad(edges: Sequence[int], insides: Sequence[int], partitioning: str) -> PatchPattern:
    """Return points and clockwise triangles of a quad patch that is neither culled nor whole."""
    sides = [divide(factor, partitioning) for factor in edges]
    u, v = (divide(factor, partitioning) for factor in insides)
    points: list[Point] = []
    rings = [_boundary(points, sides, _quad_point)]
    # the lattice inside, row by row
    index = {}
    for j in range(1, len(v.places) - 1):
        for i in range(1, len(u.places) - 1):
            index[i, j] = len(points)
            points.append((u.places[i], v.places[j]))
    triangles: list[tuple[int, ...]] = []
    ring = 1
    while 2 * ring < min(len(u.places), len(v.places)):
        left, right = ring, len(u.places) - 1 - ring
        top, bottom = ring, len(v.places) - 1 - ring
        columns, rows = range(left, right + 1), range(top, bottom + 1)
        rings.append(
            [
                [index[left, j] for j in reversed(rows)],
                [index[i, top] for i in columns],
                [index[right, j] for j in rows],
                [index[i, bottom] for i in reversed(columns)],
            ]
        )
        for edge in range(4):
            # both rows of an inner ring's strip go on with one division
            inner_half = (v, u)[edge % 2].half - (ring - 1)
            outer_half = sides[edge].half if ring == 1 else inner_half
            outer, inner = rings[-2][edge], rings[-1][edge]
            triangles += stitch(outer, inner, outer_half, inner_half)
        ring += 1
    west, north, east, south = rings[-1]
    if len(north) >= len(west) == 2:
        triangles += _centre(north, south[::-1], rising=lambda cell: True)
    elif len(north) == 2:
        middle = (len(west) - 2) / 2
        triangles += _centre(west, east[::-1], rising=lambda cell: cell != middle)
    return PatchPattern(points, triangles)


def _centre(row: list[int], other: list[int], rising: Callable[[int], bool]) -> Iterator[Triangle]:
    """Yield the row of cells that is left in the middle, one side of it clockwise first.

    ::

        row    a---b      rising /  or falling \\
        other  c---d
    """
    for cell, (a, b, c, d) in enumerate(zip(row, row[1:], other, other[1:], strict=False)):
        yield from ((a, b, c), (b, d, c)) if rising(cell) else ((a, b, d), (a, d, c))


def triangle(edges: Sequence[int], insides: Sequence[int], partitioning: str) -> PatchPattern:
    """Return points and clockwise triangles of a triangle patch, neither culled nor whole."""
    sides = [divide(factor, partitioning) for factor in edges]
    inside = divide(insides[0], partitioning)
    points: list[Point] = []
    triangles: list[tuple[int, ...]] = []
    outer = _boundary(points, sides, _triangle_point)
    for ring in range(1, (len(inside.places) + 1) // 2):
        inner = _triangle_ring(points, inside, ring)
        # both rows of an inner ring's strip go on with one division
        inner_half = inside.half - (ring - 1)
        for edge in range(3):
            outer_half = sides[edge].half if ring == 1 else inner_half
            triangles += stitch(outer[edge], inner[edge], outer_half, inner_half)
        outer = inner
    if inside.odd:
        triangles.append((outer[0][0], outer[1][0], outer[2][0]))
    return PatchPattern(points, triangles)


def _triangle_ring(points: list[Point], inside: Division, ring: int) -> Rows:
    """Append a ring's points and return its sides.

    Its sides are the inside division pushed in from the boundary by 2/3 of the place of its
    first point, so that the middle, 1/2, comes to lie at 1/3.
    """
    depth = (inside.places[ring] * (2 * ONE // 3) + ONE // 2) // ONE
    places = inside.places[ring : len(inside.places) - ring]
    if len(places) == 1:
        points.append((ONE // 3, ONE // 3))
        return [[len(points) - 1]] * 3
    # each end loses half of the way in
    alongs = [place - (depth + 1) // 2 for place in places]
    first, steps = len(points), len(places) - 1
    points += [(depth, along) for along in alongs[:0:-1]]
    points += [(along, depth) for along in alongs[:-1]]
    points += [(along, ONE - along - depth) for along in alongs[:0:-1]]
    ring_indices = [*range(first, first + 3 * steps), first]
    return [ring_indices[edge * steps : (edge + 1) * steps + 1] for edge in range(3)]


def isoline(factors: Sequence[float], partitioning: str) -> PatchPattern:
    """Return points and segments of lines of constant v; there is none at v = 1."""
    lines = divide(fixed_factor(factors[0], "integer"), "integer").places[:-1]
    places = divide(fixed_factor(factors[1], partitioning), partitioning).places
    points = [(u, v) for v in lines for u in places]
    starts = range(0, len(points), len(places))
    segments: list[tuple[int, ...]] = [
        (k, k + 1) for start in starts for k in range(start, start + len(places) - 1)
    ]
    return PatchPattern(points, segments)


def tessellate_patch(
    domain: str, edge_factors: Sequence[float], inside_factors: Sequence[float], partitioning: str
) -> PatchPattern:
    """Return one patch; triangles clockwise with u to the right and v down."""
    if not all(factor > 0 for factor in edge_factors):
        return PatchPattern([], [])
    if domain == "isoline":
        return isoline(edge_factors, partitioning)
    edges = [fixed_factor(factor, partitioning) for factor in edge_factors]
    insides = [fixed_factor(factor, partitioning) for factor in inside_factors]
    if max(*edges, *insides) == ONE:
        if domain == "quad":
            return PatchPattern([(0, ONE), (0, 0), (ONE, 0), (ONE, ONE)], [(0, 1, 2), (0, 2, 3)])
        return PatchPattern([(0, ONE), (0, 0), (ONE, 0)], [(0, 1, 2)])
    # one inside would leave no ring between the edges and the inside
    least = ONE + 1 if partitioning == "fractional_odd" else 2 * ONE
    insides = [max(factor, least) for factor in insides]
    return (quad if domain == "quad" else triangle)(edges, insides, partitioning)


def tessellate(
    domain: str,
    edge_factors: npt.ArrayLike,
    inside_factors: npt.ArrayLike | None = None,
    *,
    partitioning: str = "fractional_odd",
    topology: str = "clockwise",
) -> Pattern:
    """Return the pattern of :func:`terrain_lod.tessellate`, primitives in an order of its own."""
    edges = np.asarray(edge_factors, np.float32).tolist()
    insides: list[list[float]] = [[]] * len(edges)
    if inside_factors is not None:
        insides = np.asarray(inside_factors, np.float32).tolist()
    patches = [
        tessellate_patch(domain, edge, inside, partitioning)
        for edge, inside in zip(edges, insides, strict=True)
    ]
    point_offsets = np.cumsum([0, *(len(patch.points) for patch in patches)])
    offsets = np.cumsum([0, *(len(patch.primitives) for patch in patches)])
    points = np.array([point for patch in patches for point in patch.points], np.uint32)
    corners = 2 if domain == "isoline" else 3
    primitives = np.array(
        [
            [corner + base for corner in primitive]
            for patch, base in zip(patches, point_offsets.tolist(), strict=False)
            for primitive in patch.primitives
        ],
        np.int32,
    ).reshape(-1, corners)
    if topology == "counter_clockwise" and corners == 3:
        primitives = primitives[:, [0, 2, 1]]
    return Pattern.of(
        domain, partitioning, points.reshape(-1, 2), primitives, point_offsets, offsets
    )


def sorted_primitives(primitives: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
    """Return primitives in one order, each turned so that its smallest corner comes first."""
    corners = primitives.shape[1]
    turns = np.argmin(primitives, axis=1)[:, None] + np.arange(corners)
    turned = np.take_along_axis(primitives, turns % corners, axis=1)
    return turned[np.lexsort(turned.T[::-1])]
