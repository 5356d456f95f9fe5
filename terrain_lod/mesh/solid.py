"""Solids for printing: a surface, walls along its borders, and a flat base."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import finite, positive
from ..errors import InputError
from .mesh import Mesh
from .normals import vertex_normals
from .open_edges import Indices, topology, weld
from .soundness import sound_mesh

Points = npt.NDArray[np.float64]
# where two parts touch in a point, one of them ends this share of an edge before it
_APART: Final = 0.01


def solid(mesh: Mesh, *, base: float, size: float | None = None) -> Mesh:
    """Return the closed body between a surface and a flat base, walls along borders and holes.

    Where borders touch in a point, as holes at one corner do, no printer can follow: one of the
    parts ends a hundredth of an edge before that.

    Parameters
    ----------
    mesh : Mesh
        Of ground: no two of its points above each other, and without cracks.
    base : float
        How far the base is below the lowest point, in the units of the solid.
    size : float, optional
        The longer horizontal side of the solid, which then begins at (0, 0, 0): millimetres, as
        slicers take numbers for those. Without it the solid stands where the mesh does.

    Returns
    -------
    Mesh
        Vertices are shared by triangles. It has no patches, and with `size` no CRS.

    Raises
    ------
    InputError
        If base or size is not above 0, or if the mesh is empty or has edges of several triangles.
    """
    base = finite("base", base)
    if base <= 0:
        raise InputError(f"expected a base below the lowest point, base > 0, got {base:g}")
    if not len(mesh.triangles):
        raise InputError("expected triangles to make a solid of, got an empty mesh")
    sound_mesh(mesh)
    numbers = weld(mesh.vertices)
    top = np.zeros((numbers.max() + 1, 3))
    top[numbers] = mesh.vertices
    surface = topology(numbers[mesh.triangles])
    if surface.unbalanced:
        raise InputError(
            f"expected a surface to make a solid of, got {surface.unbalanced} edges of several "
            "triangles"
        )
    top, triangles = _parted(top, surface.triangles, surface.open_edges)
    borders = topology(triangles).open_edges
    origin, crs = mesh.origin, mesh.crs
    if size is not None:
        low, high = top.min(axis=0), top.max(axis=0)
        top = (top - low) * (positive("size", size) / (high - low)[:2].max())
        origin, crs = np.zeros(3), None
        top[:, 2] += base
    foot = top.copy()
    foot[:, 2] = top[:, 2].min() - base
    start, end = borders.T
    below = len(top)
    corners = np.concatenate(
        [
            triangles,
            below + triangles[:, ::-1],
            np.stack([end, start, below + start], axis=1),
            np.stack([end, below + start, below + end], axis=1),
        ]
    )
    used, corners = np.unique(corners, return_inverse=True)
    points = np.concatenate([top, foot])[used].astype(np.float32)
    made = corners.reshape(-1, 3).astype(np.int32)
    normals = vertex_normals(points, made).astype(np.float32)
    return Mesh(points, normals, made, origin=origin, crs=crs)


def _parted(points: Points, triangles: Indices, borders: Indices) -> tuple[Points, Indices]:
    """Return a surface whose parts touch nowhere in a single point.

    A point where several borders begin is the corner of as many fans of triangles. The first keeps
    it; each other gets a point of its own, a little nearer to the fan.
    """
    starts, counts = np.unique(borders[:, 0], return_counts=True)
    triangles, new = triangles.copy(), list[npt.NDArray[np.float64]]()
    for point in starts[counts > 1]:
        around = np.flatnonzero((triangles == point).any(axis=1))
        for fan in _fans(triangles, around, point)[1:]:
            part = triangles[fan]
            others, uses = np.unique(part[part != point], return_counts=True)
            # an edge within the fan is on the surface; a single triangle is its own surface
            within = others[uses > 1]
            towards = points[within[:1] if len(within) else others].mean(axis=0)
            part[part == point] = len(points) + len(new)
            triangles[fan] = part
            new.append(points[point] + _APART * (towards - points[point]))
    return np.concatenate([points, np.reshape(new, (-1, 3))]), triangles


def _fans(triangles: Indices, around: Indices, point: int) -> list[Indices]:
    """Return the triangles about a point in groups that share edges."""
    rest, fans = set(around.tolist()), []
    while rest:
        fan, last = list[int](), [rest.pop()]
        while last:
            fan.append(last.pop())
            corners = set(triangles[fan[-1]].tolist()) - {point}
            near = [other for other in rest if corners & set(triangles[other].tolist())]
            last += near
            rest.difference_update(near)
        fans.append(np.array(sorted(fan)))
    return fans
