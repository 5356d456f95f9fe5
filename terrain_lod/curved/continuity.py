"""How smoothly pieces are joined: gaps, angles and jumps of curvature, of curves and of patches.

Pieces meet with G0 where there is no gap, with G1 where tangents or normals agree as well, with G2
where curvatures do. Of patches with common normals along an edge, only the normal curvature across
the edge can differ (Pegna, Wolter: *Geometrical Criteria to Guarantee Curvature Continuity of Blend
Surfaces*, 1992).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import comb
from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import flag
from ..files.meshes.bpt import as_nets
from .bezier_curves import as_pieces

Array = npt.NDArray[np.float64]

# corner points of edges u = 0, v = 0, u = 1, v = 1 in a net, and the coordinate that is fixed
_EDGES: Final = (((0, 0), (0, 3)), ((0, 0), (3, 0)), ((3, 0), (3, 3)), ((0, 3), (3, 3)))
_SAMPLES: Final = 33
# corners are in one place within this share of all extents
_SAME: Final = 1e-6


@dataclass(frozen=True, eq=False)
class Continuity:
    """What joints of J pieces miss, each joint's largest; NaN where a piece has no direction there.

    Attributes
    ----------
    gaps : (J,) float64
        Distances, in world units.
    angles : (J,) float64
        Between tangents, or between normals, in degrees.
    curvatures : (J,) float64
        Differences of curvature vectors, or of normal curvatures across the edge, in 1 / units.
    pieces : (J, 2) int64
        Which two meet.
    """

    gaps: Array
    angles: Array
    curvatures: Array
    pieces: npt.NDArray[np.int64]

    def __repr__(self) -> str:
        largest = (np.nanmax(each, initial=0) for each in (self.gaps, self.angles, self.curvatures))
        gap, angle, curvature = largest
        return (
            f"Continuity({len(self.gaps)} joints: gaps up to {gap:.3g}, angles up to {angle:.3g} "
            f"degrees, curvature jumps up to {curvature:.3g})"
        )


def curve_continuity(points: npt.ArrayLike, *, closed: bool = False) -> Continuity:
    """Measure the joints of a piecewise Bézier curve.

    Parameters
    ----------
    points : (K, N + 1, 3) array_like
        Control points of K pieces of degree N.
    closed : bool, optional
        Whether the last piece is joined to the first.

    Raises
    ------
    InputError
        If the control points are not such.
    """
    pieces = as_pieces(points)
    first = np.arange(len(pieces) - (not flag("closed", closed)))
    joined = np.stack([first, (first + 1) % len(pieces)], axis=1)
    before = _end(pieces[joined[:, 0], ::-1])
    after = _end(pieces[joined[:, 1]])
    return Continuity(
        np.linalg.norm(before[0] - after[0], axis=1),
        _degrees(-before[1], after[1]),
        np.linalg.norm(before[2] - after[2], axis=1),
        joined,
    )


def _end(pieces: Array) -> tuple[Array, Array, Array]:
    """Return point, unit tangent and curvature vector where pieces begin; (J, 3) each."""
    degree = pieces.shape[1] - 1
    first = degree * (pieces[:, 1] - pieces[:, 0])
    second = np.zeros_like(first)
    if degree > 1:
        second = degree * (degree - 1) * (pieces[:, 2] - 2 * pieces[:, 1] + pieces[:, 0])
    square = (first**2).sum(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):
        bend = np.cross(np.cross(first, second), first) / square**2
        return pieces[:, 0], first / np.sqrt(square), bend


def patch_continuity(nets: npt.ArrayLike) -> Continuity:
    """Measure the joints of bicubic Bézier patches, at 33 points of every edge that two share.

    Parameters
    ----------
    nets : (P, 4, 4, 3) array_like
        Patches share an edge where its corners are in the same places; collapsed edges are none.
        Which way normals point does not count.

    Raises
    ------
    InputError
        If there are not 16 finite control points a patch.
    """
    patches = as_nets(nets)
    places = patches.reshape(-1, 3)
    unit = _SAME * (float(np.ptp(places, axis=0).max(initial=0.0)) or 1.0)
    edges: dict[tuple[tuple[float, ...], ...], list[tuple[int, int, bool]]] = {}
    for patch, net in enumerate(patches):
        for edge, corners in enumerate(_EDGES):
            ends = [tuple(np.rint(net[corner] / unit).tolist()) for corner in corners]
            if ends[0] != ends[1]:
                turned = ends[0] > ends[1]
                edges.setdefault(tuple(sorted(ends)), []).append((patch, edge, turned))
    joined = [(one, other) for sides in edges.values() for one, other in pairwise(sides)]
    found = [
        tuple(np.nanmax(each) if np.isfinite(each).any() else np.nan for each in _differences(
            _along(patches[one[0]], *one[1:]), _along(patches[other[0]], *other[1:])))
        for one, other in joined
    ]  # fmt: skip
    gaps, angles, curvatures = np.array(found, np.float64).reshape(-1, 3).T
    pieces = np.array([(one[0], other[0]) for one, other in joined], np.int64).reshape(-1, 2)
    return Continuity(gaps, angles, curvatures, pieces)


def _differences(
    one: tuple[Array, Array, Array], other: tuple[Array, Array, Array]
) -> tuple[Array, Array, Array]:
    side = np.sign((one[1] * other[1]).sum(axis=1))
    return (
        np.linalg.norm(one[0] - other[0], axis=1),
        _degrees(one[1] * side[:, None], other[1]),
        np.abs(one[2] * side - other[2]),
    )


def _along(net: Array, edge: int, turned: bool) -> tuple[Array, Array, Array]:
    """Return points and normals (33, 3) along an edge, and normal curvatures across it, (33,)."""
    t = np.linspace(1, 0, _SAMPLES) if turned else np.linspace(0, 1, _SAMPLES)
    fixed = np.full(_SAMPLES, float(edge > 1 if edge % 2 == 0 else edge == 3))
    u, v = (fixed, t) if edge % 2 == 0 else (t, fixed)

    def at(du: int, dv: int) -> Array:
        return np.asarray(np.einsum("ni,nj,ijk->nk", _bernstein(u, du), _bernstein(v, dv), net))

    point, along_u, along_v = at(0, 0), at(1, 0), at(0, 1)
    normal = np.cross(along_u, along_v)
    with np.errstate(divide="ignore", invalid="ignore"):
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        e, f, g = ((a * b).sum(axis=1) for a, b in
                   ((along_u, along_u), (along_u, along_v), (along_v, along_v)))  # fmt: skip
        bends = [(at(*each) * normal).sum(axis=1) for each in ((2, 0), (1, 1), (0, 2))]
        # the direction of the tangent plane that is perpendicular to the edge
        x, y = (g, -f) if edge % 2 == 0 else (-f, e)
        bend = bends[0] * x * x + 2 * bends[1] * x * y + bends[2] * y * y
        return point, normal, bend / (e * x * x + 2 * f * x * y + g * y * y)


def _bernstein(t: Array, derivative: int) -> Array:
    """Return the four cubic Bernstein polynomials at `t`, or a derivative of theirs; (N, 4)."""
    degree = 3 - derivative
    basis = np.stack(
        [comb(degree, k) * t**k * (1 - t) ** (degree - k) for k in range(degree + 1)], axis=1
    )
    for step in range(degree + 1, 4):
        padded = np.pad(basis, ((0, 0), (1, 1)))
        basis = step * (padded[:, :-1] - padded[:, 1:])
    return np.asarray(basis)


def _degrees(one: Array, other: Array) -> Array:
    """Return angles between unit vectors (N, 3); exact for small ones."""
    half = np.linalg.norm(one - other, axis=1) / 2
    return np.asarray(np.degrees(2 * np.arcsin(np.clip(half, 0, 1))))
