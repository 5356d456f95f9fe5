"""Semi-uniform tessellation in exact fractions, one patch after the other.

Dyken, Reimers, Seland: *Semi-uniform adaptive patch tessellation*, Computer Graphics Forum 28(8),
2009, section 3, with their snap function and another; and the same of quads.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil, floor

Barycentric = tuple[Fraction, Fraction, Fraction]
Corners = tuple[Barycentric, Barycentric, Barycentric]
Place = tuple[Fraction, Fraction]
Quad = tuple[Place, Place, Place]


def sigma(t: Fraction, level: int) -> Fraction:
    """Return where a dyadic number is on a level: there, or where its origin one level up is.

    The origin of an odd multiple of a step is the neighbour that is a multiple of four; of 1/2,
    where a walk ends: 1.
    """
    while t.denominator > 2**level:
        step = Fraction(1, t.denominator)
        t += step if t == step == Fraction(1, 2) or (t / step) % 4 == 3 else -step
    return t


def nearest(t: Fraction, level: int) -> Fraction:
    """Return the nearest point of a level, equation 1; of two the one nearer to an end.

    The middle at level 0, which that leaves open, goes to where a walk ends: 1.
    """
    scaled, half = t * 2**level, Fraction(1, 2)
    return Fraction(ceil(scaled - half) if t < half else floor(scaled + half), 2**level)


def phi(u: Barycentric, levels: Sequence[int]) -> Barycentric:
    """Return a point of the lattice, snapped onto the level of the edge it lies on.

    Edges are walked by u = 0, v = 0, w = 0 from v = 1. Corners, on two edges, stay on both.
    """
    for edge in range(3):
        if u[edge] == 0:
            ahead = sigma(u[edge - 1], levels[edge])
            snapped = [Fraction(0)] * 3
            snapped[edge - 1], snapped[edge - 2] = ahead, 1 - ahead
            return snapped[0], snapped[1], snapped[2]
    return u


def dyadic(level: int) -> list[Corners]:
    """Return the triangles of the dyadic refinement of the domain, clockwise with v down."""
    steps = 2**level

    def point(i: int, j: int) -> Barycentric:
        return Fraction(i, steps), Fraction(j, steps), Fraction(steps - i - j, steps)

    triangles = []
    for i in range(steps):
        for j in range(steps - i):
            triangles.append((point(i, j), point(i + 1, j), point(i, j + 1)))
            if i + j < steps - 1:
                triangles.append((point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)))
    return triangles


def semi_uniform(levels: Sequence[int], *, keep_degenerate: bool = True) -> list[Corners]:
    """Return the triangles of a patch."""
    triangles = [
        (phi(a, levels), phi(b, levels), phi(c, levels)) for a, b, c in dyadic(max(levels))
    ]
    return [corners for corners in triangles if keep_degenerate or len(set(corners)) == 3]


def snapped_quad(levels: Sequence[int], *, snap: str = "nested") -> list[Quad]:
    """Return the triangles of a quad as (u, v), clockwise with v down, empty ones too."""
    move, steps = {"nested": sigma, "nearest": nearest}[snap], 2 ** max(levels)

    def point(i: int, j: int) -> tuple[Fraction, Fraction]:
        u, v = Fraction(i, steps), Fraction(j, steps)
        # walked from u = 0, v = 1 around by v = 0, each edge from 0 to 1
        if i == 0:
            v = 1 - move(1 - v, levels[0])
        elif j == 0:
            u = move(u, levels[1])
        elif i == steps:
            v = move(v, levels[2])
        elif j == steps:
            u = 1 - move(1 - u, levels[3])
        return u, v

    triangles = []
    for i in range(steps):
        for j in range(steps):
            triangles.append((point(i, j), point(i + 1, j), point(i, j + 1)))
            triangles.append((point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)))
    return triangles
