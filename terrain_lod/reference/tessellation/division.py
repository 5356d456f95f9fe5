"""The tessellator in one dimension: where points lie, in which order they appear, how rows join.

After the Direct3D 11.3 Functional Specification, chapter Tessellator.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Final

ONE: Final = 1 << 16  # 16.16 fixed point

Triangle = tuple[int, int, int]


def fixed_factor(factor: float, partitioning: str) -> int:
    """Return a factor in 16.16: clamped to its partitioning's range, NaN to the least, rounded."""
    least, most = {"fractional_odd": (1, 63), "fractional_even": (2, 64)}.get(partitioning, (1, 64))
    clamped = least if not factor > least else min(factor, most)
    if partitioning == "integer":
        clamped = math.ceil(clamped)
    elif partitioning == "pow2":
        clamped = 1 << math.ceil(math.log2(clamped))
    return round(Fraction(clamped) * ONE)  # ties to even


@dataclass(frozen=True)
class Division:
    """An edge of the finer of two divisions that a factor blends: places 0..ONE of its points.

    ``half`` counts the steps in each half, without the one in the middle of an odd division.
    """

    places: tuple[int, ...]
    odd: bool

    @property
    def half(self) -> int:
        return (len(self.places) - 1) // 2


def divide(factor: int, partitioning: str) -> Division:
    """Return how a fixed-point factor divides an edge."""
    odd = partitioning == "fractional_odd"
    if partitioning in ("integer", "pow2"):
        odd = factor // ONE % 2 == 1
    # half the segments, the one in the middle of an odd division counted as one
    halved = (factor + 1) // 2 + (ONE // 2 if odd else 0)
    coarse, weight = divmod(halved, ONE)
    fine = coarse + (weight > 0)
    coarse_segments, fine_segments = 2 * coarse - odd, 2 * fine - odd
    # the newest point starts from its inner neighbour, the very first pair from the ends
    newest = ruler_newest(coarse - odd) if weight else fine
    first_half = []
    for point in range(fine):
        old = point - (point > newest)
        blend = old * _length(coarse_segments) * (ONE - weight)
        blend += point * _length(fine_segments) * weight
        first_half.append((blend + ONE // 2) // ONE)
    middle = [] if odd else [ONE // 2]
    mirrored = [ONE - place for place in reversed(first_half)]
    return Division((*first_half, *middle, *mirrored), odd)


def _length(segments: int) -> int:
    """Return the length of one of so many segments, to the nearest."""
    return (2 * ONE + segments) // (2 * segments)


def ruler_rank(place: int) -> int:
    """Return when the point at `place`, in 32nds of half an edge, appears as its steps grow.

    ::

        place  0           8          16          24          32 (middle)
        rank   0           2           1           3
               0     4     2     5     1     6     3     7
    """
    if place == 0:
        return 0
    trailing = (place & -place).bit_length() - 1
    return (1 << (4 - trailing)) + (place >> (trailing + 1))


def ruler_newest(steps: int) -> int:
    """Return which point is added when so many steps become one more."""
    if steps == 0:
        return 0
    places = sorted(place for place in range(32) if ruler_rank(place) <= steps)
    return [ruler_rank(place) for place in places].index(steps)


def stitch(
    outer: Sequence[int], inner: Sequence[int], outer_half: int, inner_half: int
) -> Iterator[Triangle]:
    """Yield clockwise triangles between two rows of points.

    The inner row lacks the first and the last step of its division, which has `inner_half` steps
    in each half. Both rows step in ruler order; at the same place the inner one steps first, in
    the second half last.
    """
    o = i = 0

    def step_outer() -> Triangle:
        nonlocal o
        o += 1
        return outer[o - 1], outer[o], inner[i]

    def step_inner() -> Triangle:
        nonlocal i
        i += 1
        return inner[i - 1], outer[o], inner[i]

    outer_odd, inner_odd = len(outer) % 2 == 0, len(inner) % 2 == 0
    steps: list[Callable[[], Triangle]] = []
    for place in range(32):
        if place > 0 and ruler_rank(place) < inner_half:
            steps.append(step_inner)
        if ruler_rank(place) < outer_half:
            steps.append(step_outer)
    middle = [step_inner] * inner_odd + [step_outer] * outer_odd
    for step in (*steps, *middle, *reversed(steps)):
        yield step()
