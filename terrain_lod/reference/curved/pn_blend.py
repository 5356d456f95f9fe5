"""Semi-uniform patterns between whole levels in float64: what ``curved/pn_blend.cl`` computes."""

from __future__ import annotations

from fractions import Fraction
from math import ceil

import numpy as np
import numpy.typing as npt

from ..tessellation.semi_uniform import sigma
from .pn import positions_at

Array = npt.NDArray[np.float64]
Weights = tuple[float, float, float]


def blended_position(controls: Array, levels: Array, weights: Weights) -> Array:
    """Return where a point of a patch's pattern stands.

    Parameters
    ----------
    controls : (10, 3)
        Control points of the patch.
    levels : (3,)
        Of the edges u = 0, v = 0, w = 0.
    weights : (float, float, float)
        u, v, w of a point of the semi-uniform pattern, dyadic fractions.

    Returns
    -------
    (3,) float64
    """

    def surface(at: Weights) -> Array:
        found: Array = positions_at(controls[None], np.array([at]))[0]
        return found

    turned = [_is_turned(controls, edge) for edge in range(3)]
    if 0 in weights:
        return surface(_on_edge(levels, turned, weights))
    level = float(max(levels))
    steps = 2 ** ceil(level)
    odd = [round(weight * steps) % 2 for weight in weights]
    if not any(odd):
        return surface(weights)
    # of three numbers that sum to a power of two, two are odd: the coarser lattice's line through
    # the point changes those
    first, second = (place for place in range(3) if odd[place])
    ends = []
    for sign in (1, -1):
        at = list(weights)
        at[first] += sign / steps
        at[second] -= sign / steps
        place = _on_edge(levels, turned, (at[0], at[1], at[2]))
        ends.append(surface(place))
    part = level - (ceil(level) - 1)
    found: Array = (1 - part) * (ends[0] + ends[1]) / 2 + part * surface(weights)
    return found


def _is_turned(controls: Array, edge: int) -> bool:
    """Return whether the walk along an edge, from corner edge + 1, begins at the lesser end."""
    start, end = ((1, 2), (2, 0), (0, 1))[edge]
    return tuple(controls[start]) < tuple(controls[end])


def _on_edge(levels: Array, turned: list[bool], at: Weights) -> Weights:
    """Return where a point of any lattice is: on an edge, on its way between the edge's levels."""
    if 0 not in at:
        return at
    edge = at.index(0)
    start, end = ((1, 2), (2, 0), (0, 1))[edge]
    # the middle of level 1 goes to the end of the walk: mirrored if it should not
    along = Fraction(at[start] if turned[edge] else at[end])
    level = ceil(float(levels[edge]))
    place = sigma(along, level)
    before = sigma(place, max(level - 1, 0))
    part = float(levels[edge]) - (level - 1)
    moved = float(before) + part * float(place - before)
    weights = [0.0, 0.0, 0.0]
    weights[start], weights[end] = (moved, 1 - moved) if turned[edge] else (1 - moved, moved)
    return weights[0], weights[1], weights[2]
