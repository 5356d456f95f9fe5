"""Semi-uniform tessellation in exact fractions, one patch after the other.

Dyken, Reimers, Seland: *Semi-uniform adaptive patch tessellation*, Computer Graphics Forum 28(8),
2009, section 3; but for the snap function.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

Barycentric = tuple[Fraction, Fraction, Fraction]
Corners = tuple[Barycentric, Barycentric, Barycentric]


def sigma(t: Fraction, level: int) -> Fraction:
    """Return where a dyadic number is on a level: there, or where its origin one level up is.

    The origin of an odd multiple of a step is the neighbour that is a multiple of four; of 1/2,
    where a walk ends: 1.
    """
    while t.denominator > 2**level:
        step = Fraction(1, t.denominator)
        t += step if t == step == Fraction(1, 2) or (t / step) % 4 == 3 else -step
    return t


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
