"""Semi-uniform patterns between whole levels in float64: what ``kernels/pn_blend.cl`` computes."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil

import numpy as np
import numpy.typing as npt

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

    if max(weights) == 1:
        return surface(weights)
    if 0 in weights:
        return _on_edge(surface, levels, weights)
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
        ends.append(_on_lattice(surface, levels, (at[0], at[1], at[2])))
    return _grown(ends[0], ends[1], surface(weights), level)


def _grown(a: Array, b: Array, full: Array, level: float) -> Array:
    part = level - (ceil(level) - 1)
    found: Array = (1 - part) * (a + b) / 2 + part * full
    return found


def _on_lattice(surface: Callable[[Weights], Array], levels: Array, at: Weights) -> Array:
    """Return a point of the next coarser lattice, moved as its edge's level has it."""
    if 0 not in at:
        return surface(at)
    edge = at.index(0)
    # edges are walked from corner edge + 1 to edge + 2, edge 1 and 2 too: u to v, w to u
    start, end = ((1, 2), (2, 0), (0, 1))[edge]
    steps = 2 ** ceil(float(levels[edge]))
    exact = at[end] * steps
    nearest = ceil(exact - 0.5) if at[end] < 0.5 else int(np.floor(exact + 0.5))
    moved = [0.0, 0.0, 0.0]
    moved[end] = nearest / steps
    moved[start] = 1 - moved[end]
    place = (moved[0], moved[1], moved[2])
    return surface(place) if max(place) == 1 else _on_edge(surface, levels, place)


def _on_edge(surface: Callable[[Weights], Array], levels: Array, at: Weights) -> Array:
    """Return a point of an edge's own level."""
    edge = at.index(0)
    start, end = ((1, 2), (2, 0), (0, 1))[edge]
    level = float(levels[edge])
    steps = 2 ** ceil(level)
    if round(at[end] * steps) % 2 == 0:
        return surface(at)
    ends = []
    for sign in (1, -1):
        moved = list(at)
        moved[end] += sign / steps
        moved[start] -= sign / steps
        ends.append(surface((moved[0], moved[1], moved[2])))
    return _grown(ends[0], ends[1], surface(at), level)
