"""Displaced meshes and decals in float64: ``kernels/displaced*.cl`` and ``kernels/decal*.cl``."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from ...mesh.open_edges import weld
from .patch_culling import back_cosine_of, frustum_depth

Array = npt.NDArray[np.float64]

_EDGES = ((1, 2), (2, 0), (0, 1))


def bilinear(raster: npt.NDArray[Any], x: float, y: float, *, repeats: bool) -> float:
    """Return a map's value at x to the right and y up, both 0 to 1 across it."""
    rows, columns = raster.shape
    column, row = x * columns - 0.5, (1 - y) * rows - 0.5
    if not repeats:
        column, row = np.clip(column, 0, columns - 1), np.clip(row, 0, rows - 1)
    left, above = int(np.floor(column)), int(np.floor(row))
    value = 0.0
    for i, down in ((above, 1 - (row - above)), (above + 1, row - above)):
        for j, across in ((left, 1 - (column - left)), (left + 1, column - left)):
            place = (i % rows, j % columns) if repeats else (min(i, rows - 1), min(j, columns - 1))
            value += down * across * float(raster[place])
    return value


def displacement(
    patch: npt.NDArray[np.int32],
    dominant: npt.NDArray[np.int32],
    normals: Array,
    shared: Array,
    textures: Array,
    weights: Array,
) -> tuple[Array, Array]:
    """Return the unit direction and the texture coordinates at (3,) weights of one patch.

    Parameters
    ----------
    patch : (12,) int32
    dominant : (6,) int32
        Vertices that speak for the ends of edges 0, 1, 2.
    normals, shared : (V, 3)
        Of the vertices, and the means at their positions.
    textures : (V, 2)
    """
    on_edges = np.flatnonzero(weights == 0)
    if len(on_edges) == 2:  # a corner
        vertex = patch[9 + int(np.argmax(weights))]
        return _unit(shared[vertex]), textures[vertex]
    if len(on_edges) == 0:
        return _unit(weights @ normals[patch[:3]]), weights @ textures[patch[:3]]
    side = int(on_edges[0])
    direction, texture = np.zeros(3), np.zeros(2)
    for end, corner in enumerate(_EDGES[side]):
        place = 2 * side + end
        own, other = patch[corner], patch[3 + place]
        both = shared[own] if other < 0 else _unit(normals[own] + normals[other])
        direction += weights[corner] * both
        texture += weights[corner] * textures[dominant[place]]
    return _unit(direction), texture


def dented(
    position: Array, normal_there: Array, decals: npt.NDArray[np.void], depths: npt.NDArray[Any]
) -> tuple[Array, Array]:
    """Return where all decals move a position to, each from where it was at first, and the normal.

    That is turned by the inverse transpose of the derivative of the moved position.
    """
    moved, derivative = position.copy(), np.eye(3)
    for decal in decals:
        normal, tangent = (decal[name].astype(np.float64) for name in ("normal", "tangent"))
        off = position - decal["point"]
        radius = float(decal["radius"])
        if np.linalg.norm(off) <= radius:
            upward, scale = np.cross(normal, tangent), float(decal["scale"])
            x, y = (off @ along / radius / 2 + 0.5 for along in (tangent, upward))

            def depth(x: float, y: float) -> float:
                return bilinear(depths, x, y, repeats=False)

            moved -= normal * (float(decal["bias"]) + scale * depth(x, y))
            rows, columns = depths.shape
            across = columns * (depth(x + 0.5 / columns, y) - depth(x - 0.5 / columns, y))
            up = rows * (depth(x, y + 0.5 / rows) - depth(x, y - 0.5 / rows))
            derivative -= np.outer(normal, scale * (across * tangent + up * upward) / radius / 2)
    turned = np.linalg.det(derivative) * np.linalg.solve(derivative.T, normal_there)
    return moved, _unit(turned)


def reached(
    corners: Array,
    edges: npt.NDArray[np.int32],
    bulges: Array,
    decals: npt.NDArray[np.void],
    in_view: npt.NDArray[np.bool_],
) -> tuple[Array, Array]:
    """Return how near decals come to being out of reach: above 0 where one reaches.

    Parameters
    ----------
    corners : (T, 3, 3)
        Of the plane triangles.
    edges : (T, 3) int32
        Numbers of their edges, opposite each corner.
    bulges : (T,)
        How far curved patches may leave their planes.
    decals : layout.DECAL records
    in_view : (T,) bool
        What is out of view is not reached.

    Returns
    -------
    (E,), (T,)
        For each edge by all triangles there, and for what is above each triangle; in world units.
    """
    of_edge = np.full(edges.max(initial=-1) + 1, -np.inf)
    above = np.full(len(corners), -np.inf)
    for triangle, points in enumerate(corners):
        plane = _unit(np.cross(points[1] - points[0], points[2] - points[0]))
        for decal in decals:
            hit, radius = decal["point"].astype(np.float64), decal["radius"] + bulges[triangle]
            inside = radius - abs((hit - points[0]) @ plane)
            for side, (i, j) in enumerate(_EDGES):
                along = points[j] - points[i]
                t = np.clip((hit - points[i]) @ along / (along @ along or 1.0), 0, 1)
                near = radius - np.linalg.norm(points[i] + t * along - hit)
                edge = edges[triangle, side]
                of_edge[edge] = max(of_edge[edge], near)
                inside = min(inside, np.cross(_unit(along), hit - points[i]) @ plane)
            above[triangle] = max(above[triangle], inside)
    above[~in_view] = -np.inf
    of_edge[np.setdiff1d(edges, edges[in_view])] = -np.inf
    return of_edge, above


def seen(
    controls: Array,
    bulges: Array,
    decals: npt.NDArray[np.void],
    moves: Array,
    view: npt.NDArray[Any],
    back_cosine: float,
) -> tuple[Array, Array]:
    """Return how surely patches are in view, (T,), and decals seen, (D,): above 0 where they are.

    Parameters
    ----------
    controls : (T, 10, 3)
        Control points of the patches.
    moves : (D,)
        The most that each decal moves a point by.
    """
    depths, fronts = np.empty(len(controls)), np.empty(len(controls))
    reach = np.empty((len(controls), len(decals)))
    alone, everywhere = np.array([[0, 1, 2]], np.int32), np.ones(1, bool)
    for patch, points in enumerate(controls):
        for k, decal in enumerate(decals):
            near, above = reached(
                points[None, :3], alone, bulges[patch : patch + 1], decal[None], everywhere
            )
            reach[patch, k] = max(near.max(), above.max())
        moved = moves[reach[patch] > 0].sum()
        around = np.concatenate([points - moved, points + moved])
        depths[patch] = frustum_depth(around, view)
        fronts[patch] = back_cosine - back_cosine_of(points, view)
    of_patch = np.minimum(depths, fronts)
    return depths, np.minimum(reach, of_patch[:, None]).max(axis=0)


def renewed_normals(
    moved: npt.NDArray[np.float32],
    before: npt.NDArray[np.float32],
    triangles: npt.NDArray[np.int32],
) -> Array:
    """Return the normals of a surface whose points were moved; (N, 3).

    The sum of the cross products of all triangles at the point's position whose normal there was
    the same `before`; that one where they cancel.
    """
    groups = weld(moved) * (weld(before).max(initial=0) + 1) + weld(before)
    _, group = np.unique(groups, return_inverse=True)
    a, b, c = (moved[triangles[:, k]].astype(np.float64) for k in range(3))
    across = np.cross(b - a, c - a)
    sums = np.zeros((group.max(initial=-1) + 1, 3))
    for corner in range(3):
        np.add.at(sums, group[triangles[:, corner]], across)
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    unit = (sums / np.where(lengths > 0, lengths, 1.0))[group]
    found: Array = np.where(lengths[group] > 0, unit, before)
    return found


def _unit(vector: Array) -> Array:
    return np.asarray(vector / (np.linalg.norm(vector) or 1.0))
