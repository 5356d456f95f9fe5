"""Normal maps in float64: ``kernels/mesh/normal_map.cl``, and how a map is read again.

Weights come from a linear system and whole arrays, texel by texel in the map's order; the frame is
inverted as a matrix.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from ...mesh.mesh import Mesh
from ...mesh.normal_map import NormalMap

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


def normal_map(coarse: Mesh, fine: Mesh, shape: tuple[int, int], way: Array | None) -> Array:
    """Return what each texel says before it is rounded to colours; (R, C, 3), NaN outside.

    Parameters
    ----------
    coarse : Mesh
        With texture coordinates and a normal map, whose tangents are taken.
    fine : Mesh
    shape : (int, int)
        Rows and columns.
    way : (3,) array or None
        Where the fine mesh is looked for, both ways; along the coarse mesh's normals if None.
    """
    assert coarse.textures is not None
    assert coarse.normal_map is not None
    said = np.full((*shape, 3), np.nan)
    textures = coarse.textures.astype(np.float64)[coarse.triangles]
    corners = fine.vertices.astype(np.float64)[fine.triangles]
    faces = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    for row, column in np.ndindex(shape):
        at = np.array([(column + 0.5) / shape[1], 1 - (row + 0.5) / shape[0]])
        weights = _weights(at, textures)
        holding = np.flatnonzero((weights >= 0).all(axis=1))
        if not len(holding):
            continue
        triangle, weight = coarse.triangles[holding[-1]], weights[holding[-1]]
        point = weight @ coarse.vertices[triangle] + coarse.origin - fine.origin
        n = weight @ coarse.normals[triangle]
        t = weight @ coarse.normal_map.tangents[triangle, :3]
        b = coarse.normal_map.tangents[triangle[0], 3] * np.cross(n, t)
        look = n / np.linalg.norm(n) if way is None else way
        says = np.array([0.0, 0.0, 1.0])
        hit = _nearest(corners, faces, point, look)
        if hit is not None:
            face, of_corners = hit
            normal = of_corners @ fine.normals[fine.triangles[face]]
            says = np.linalg.solve(np.stack([t, b, n], axis=1), normal)
            says[2] = max(says[2], 0.0)
            says /= np.linalg.norm(says)
        said[row, column] = says
    return said


def mapped_normals(mesh: Mesh, triangles: Indices, weights: Array) -> Array:
    """Return the normals that a renderer shades points of a mesh with; (N, 3) unit length.

    Parameters
    ----------
    mesh : Mesh
        With a normal map, which is read bilinearly.
    triangles : (N,)
    weights : (N, 3)
        Of the triangles' corners.
    """
    assert mesh.textures is not None
    of_map: NormalMap | None = mesh.normal_map
    assert of_map is not None
    corners = mesh.triangles[triangles]
    n, t, at = (
        np.einsum("nc,ncd->nd", weights, values[corners].astype(np.float64))
        for values in (mesh.normals, of_map.tangents[:, :3], mesh.textures)
    )
    b = of_map.tangents[corners[:, 0], 3:] * np.cross(n, t)
    says = 2 * _bilinear(of_map.pixels.astype(np.float64) / 255, at) - 1
    normals = says[:, :1] * t + says[:, 1:2] * b + says[:, 2:] * n
    unit: Array = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return unit


def _bilinear(picture: Array, at: Array) -> Array:
    """Return a picture's colours at texture coordinates, clamped to its edges."""
    rows, columns, _ = picture.shape
    column = np.clip(at[:, 0] * columns - 0.5, 0, columns - 1)
    row = np.clip((1 - at[:, 1]) * rows - 0.5, 0, rows - 1)
    left, top = np.floor(column).astype(int), np.floor(row).astype(int)
    right, bottom = np.minimum(left + 1, columns - 1), np.minimum(top + 1, rows - 1)
    across, down = (column - left)[:, None], (row - top)[:, None]
    above = (1 - across) * picture[top, left] + across * picture[top, right]
    below = (1 - across) * picture[bottom, left] + across * picture[bottom, right]
    blended: Array = (1 - down) * above + down * below
    return blended


def _weights(at: Array, corners: Array) -> Array:
    """Return the weights of the corners (T, 3, 2) at a point; -1 where they span nothing."""
    a, b, c = np.moveaxis(corners, 1, 0)

    def doubled(p: Array, q: Array, r: Array) -> Array:
        area: Array = (q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0]
        return area

    here = np.broadcast_to(at, a.shape)
    with np.errstate(invalid="ignore", divide="ignore"):
        weights: Array = np.stack(
            [doubled(here, b, c), doubled(a, here, c), doubled(a, b, here)], axis=1
        ) / doubled(a, b, c).reshape(-1, 1)
    return np.where(np.isfinite(weights), weights, -1.0)


def _nearest(corners: Array, faces: Array, point: Array, way: Array) -> tuple[int, Array] | None:
    """Return the nearest triangle that faces along `way` on the line through `point`."""
    a, b, c = np.moveaxis(corners, 1, 0)
    slope = faces @ way
    with np.errstate(invalid="ignore", divide="ignore"):
        t = ((a - point) * faces).sum(axis=1) / slope
        at = point + t[:, None] * way
        squared = (faces * faces).sum(axis=1)
        of_b = (np.cross(at - a, c - a) * faces).sum(axis=1) / squared
        of_c = (np.cross(b - a, at - a) * faces).sum(axis=1) / squared
    weights = np.stack([1 - of_b - of_c, of_b, of_c], axis=1)
    hit = (slope > 0) & (weights >= -1e-12).all(axis=1)
    if not hit.any():
        return None
    nearest = int(np.argmin(np.where(hit, abs(t), np.inf)))
    return nearest, weights[nearest]
