"""Tessellation factors: what they mean, and how much they make.

A domain is a unit square or triangle with coordinates u and v (w = 1 - u - v); a patch's factors
say how many segments its edges and its inside have:

============ ================================ =================== ===============================
domain       edge factors                     inside factors      primitives
============ ================================ =================== ===============================
quad         u = 0, v = 0, u = 1, v = 1       along u, along v    triangles
triangle     u = 0, v = 0, w = 0              one                 triangles
isoline      number of lines, segments a line none                lines along u, none at v = 1
============ ================================ =================== ===============================

Where an edge factor is 0, negative or NaN, the patch is culled. Others are clamped to the range of
the partitioning, which also says how many segments they make:

=============== ======= ========================================================================
partitioning    range   segments
=============== ======= ========================================================================
integer         1 .. 64 the next whole number
pow2            1 .. 64 the next power of two
fractional_odd  1 .. 63 the next odd number, all alike but two, which grow out of nothing
fractional_even 2 .. 64 the next even number, likewise
=============== ======= ========================================================================

Drivers take pow2 for integer and leave the rounding to the hull shader (Microsoft's page on
``dcl_tessellator_partitioning``); here the rounding is done.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
import numpy.typing as npt

from ..arguments import array, one_of
from ..device.layout import FIXED_ONE, PARTITIONINGS
from ..errors import InputError

if TYPE_CHECKING:
    from ..device.device import DeviceArray

Factors = npt.NDArray[np.float32]
Counts = npt.NDArray[np.int64]


class Domain(NamedTuple):
    """Factors of a patch, and corners of a primitive."""

    edges: int
    insides: int
    corners: int


DOMAINS: Final = {
    "quad": Domain(edges=4, insides=2, corners=3),
    "triangle": Domain(edges=3, insides=1, corners=3),
    "isoline": Domain(edges=2, insides=0, corners=2),
}


@dataclass(frozen=True, eq=False)
class DeviceFactors:
    """Factors of P quads on the device: what a hull stage hands to the tessellator.

    Attributes
    ----------
    edge : DeviceArray, (P, 4) float32
        u = 0, v = 0, u = 1, v = 1; all 0 where the patch is culled.
    inside : DeviceArray, (P, 2) float32
        Along u and v.
    """

    edge: DeviceArray
    inside: DeviceArray


def checked_factors(
    domain: str,
    edge_factors: npt.ArrayLike,
    inside_factors: npt.ArrayLike | None,
    partitioning: str,
) -> tuple[Factors, Factors | None]:
    """Return the factors as arrays, or say what does not fit."""
    one_of("domain", domain, DOMAINS)
    one_of("partitioning", partitioning, PARTITIONINGS)
    edge_count, inside_count, _ = DOMAINS[domain]
    edges = rows_of(f"edge_factors of a {domain}", edge_factors, edge_count)
    if inside_count == 0:
        if inside_factors is not None:
            raise InputError("expected no inside_factors for isolines: leave them out")
        return edges, None
    if inside_factors is None:
        raise InputError(f"expected inside_factors (P, {inside_count}) for a {domain}, got none")
    insides = rows_of(f"inside_factors of a {domain}", inside_factors, inside_count)
    if len(insides) != len(edges):
        raise InputError(
            f"expected edge and inside factors of as many patches, got {len(edges)} and "
            f"{len(insides)}"
        )
    return edges, insides


def rows_of(name: str, factors: npt.ArrayLike, width: int) -> Factors:
    """Return `factors` as (P, width) float32; what is beyond that is infinite, and clamped."""
    if isinstance(factors, list | tuple) and not factors:
        factors = np.empty((0, width))
    return array(name, factors, ("P", width), np.float32, is_finite=False)


def counts(
    domain: str,
    edge_factors: npt.ArrayLike,
    inside_factors: npt.ArrayLike | None = None,
    partitioning: str = "fractional_odd",
) -> tuple[Counts, Counts]:
    """Return how many points and how many triangles or lines each patch makes, in closed form.

    Parameters are those of :func:`terrain_lod.tessellate`.

    Returns
    -------
    points, primitives : (P,) int64

    Raises
    ------
    InputError
        If a word is unknown, or factors are too few or too many.

    Examples
    --------
    >>> counts("quad", [[64, 64, 64, 64]], [[64, 64]], "integer")
    (array([4225]), array([8192]))
    """
    edges, insides = checked_factors(domain, edge_factors, inside_factors, partitioning)
    drawn = (edges > 0).all(axis=1).astype(np.int64)  # not where one is NaN
    if insides is None:
        lines = _segments(edges[:, 0], "integer")
        segments = _segments(edges[:, 1], partitioning)
        return drawn * lines * (segments + 1), drawn * lines * segments
    boundary = _segments(edges, partitioning).sum(axis=1)
    # all factors one: the domain as it is; otherwise there is a ring inside at the least
    factors = _fixed(np.concatenate([edges, insides], axis=1), partitioning)
    whole = (factors == FIXED_ONE).all(axis=1)
    least = 3 if partitioning == "fractional_odd" else 2
    inside = np.maximum(_segments(insides, partitioning), least)
    if domain == "quad":
        points = (inside - 1).prod(axis=1)
        triangles = 2 * points - 2
    else:
        rings, odd = np.divmod(inside[:, 0], 2)
        points = 3 * rings**2 - (1 - odd) * (3 * rings - 1)
        triangles = 6 * rings**2 - np.where(odd, 2, 6 * rings)
    corners = DOMAINS[domain].edges
    return (
        drawn * np.where(whole, corners, boundary + points),
        drawn * np.where(whole, corners - 2, boundary + triangles),
    )


def _fixed(factors: Factors, partitioning: str) -> Counts:
    """Return factors in 16.16: clamped, NaN to the least, and rounded."""
    least = 2 if partitioning == "fractional_even" else 1
    most = 63 if partitioning == "fractional_odd" else 64
    clamped = np.fmin(np.fmax(factors, least), most)
    if partitioning in ("integer", "pow2"):
        clamped = np.ceil(clamped)
    if partitioning == "pow2":
        clamped = np.exp2(np.ceil(np.log2(clamped)))
    fixed: Counts = np.rint(clamped * FIXED_ONE).astype(np.int64)
    return fixed


def _segments(factors: Factors, partitioning: str) -> Counts:
    """Return the segments that factors make of their edges."""
    segments: Counts = -(-_fixed(factors, partitioning) // FIXED_ONE)
    if partitioning in ("integer", "pow2"):
        return segments
    odd = int(partitioning == "fractional_odd")
    segments += segments % 2 != odd
    return segments
