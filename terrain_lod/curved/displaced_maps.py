"""Maps of heights for displaced meshes: what they must be, and the segments that they ask for."""

from __future__ import annotations

from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import array, finite, positive
from ..errors import InputError
from ..mesh.mesh import Mesh
from ..mesh.soundness import sound_mesh
from .adjacency import Adjacency
from .patch_factors import MAX_FACTOR, checked_factor

# segments along an edge of the lattice that a map's variation is measured on
_SAMPLED: Final = 16
_SAMPLED_TOGETHER: Final = 4096  # triangles
_LARGEST_COORDINATE: Final = 1 << 20

Array = npt.NDArray[np.float64]


def variation_factors(
    mesh: Mesh,
    heights: npt.ArrayLike,
    textures: npt.ArrayLike | None = None,
    *,
    scale: float = 1.0,
    tolerance: float,
    maximum: float = MAX_FACTOR,
) -> npt.NDArray[np.float32]:
    """Return the factors that a map's own variation asks for.

    The heights over each triangle are sampled on a lattice of 16 segments and compared with the
    plane through those at its corners. A surface that leaves its plane by d is followed within the
    tolerance by about sqrt(d / tolerance) segments, as a parabola is.

    Parameters
    ----------
    mesh : Mesh
    heights, textures, scale
        As for :func:`terrain_lod.displace`.
    tolerance : float
        In world units, above 0.
    maximum : float, optional
        The most segments, 1 to 64.

    Returns
    -------
    (T, 3) float32
        At an edge the larger of both sides', 1 where the map is plane.
    """
    mesh, scale = sound_mesh(mesh), finite("scale", scale)
    tolerance, maximum = positive("tolerance", tolerance), checked_factor("maximum", maximum)
    raster, coordinates = checked_map(heights), checked_textures(textures, mesh)
    i, j = np.meshgrid(np.arange(_SAMPLED + 1), np.arange(_SAMPLED + 1), indexing="ij")
    inside = i + j <= _SAMPLED
    weights = np.stack([i, j, _SAMPLED - i - j], axis=-1)[inside] / _SAMPLED
    off = np.empty(len(mesh.triangles))
    # so many at a time, for all their samples are in memory
    for first in range(0, len(off), _SAMPLED_TOGETHER):
        some = slice(first, first + _SAMPLED_TOGETHER)
        corners = coordinates[mesh.triangles[some]].astype(np.float64)
        sampled = map_heights(raster, np.einsum("nk,tkc->tnc", weights, corners))
        plane = map_heights(raster, corners) @ weights.T
        off[some] = np.abs(sampled - plane).max(axis=1)
    wanted = np.clip(np.sqrt(abs(scale) * off / tolerance), 1, maximum)
    adjacency = Adjacency.of(mesh)
    of_edge = np.zeros(len(adjacency.sides))
    np.maximum.at(of_edge, adjacency.edges, wanted[:, None])
    factors: npt.NDArray[np.float32] = of_edge[adjacency.edges].astype(np.float32)
    return factors


def map_heights(heights: npt.NDArray[np.float32], textures: Array) -> Array:
    """Return the map at texture coordinates (..., 2), as ``curved/displaced.cl`` finds it."""
    rows, columns = heights.shape
    x = textures[..., 0] % 1.0 * columns - 0.5
    y = (1.0 - textures[..., 1] % 1.0) * rows - 0.5
    left, above = np.floor(x).astype(int), np.floor(y).astype(int)
    a, b, c, d = (
        heights[(above + down) % rows, (left + right) % columns].astype(np.float64)
        for down in (0, 1)
        for right in (0, 1)
    )
    upper, lower = a + (b - a) * (x - left), c + (d - c) * (x - left)
    found: Array = upper + (lower - upper) * (y - above)
    return found


def checked_map(heights: npt.ArrayLike) -> npt.NDArray[np.float32]:
    """Return a map as (R, C) float32, or say what it should be."""
    raster = array("heights of a map", heights, ("R", "C"), np.float32)
    if not raster.size:
        raise InputError(f"expected a map of heights, got shape {raster.shape}")
    return raster


def checked_textures(textures: npt.ArrayLike | None, mesh: Mesh) -> npt.NDArray[np.float32]:
    """Return texture coordinates, given or the mesh's own, or say what they should be."""
    if textures is None:
        if mesh.textures is None:
            raise InputError("expected texture coordinates, got none, and the mesh has none either")
        textures = mesh.textures
    coordinates = array("texture coordinates", textures, (len(mesh.vertices), 2), np.float32)
    largest = float(np.abs(coordinates).max(initial=0.0))
    if largest > _LARGEST_COORDINATE:
        raise InputError(
            f"expected texture coordinates within {_LARGEST_COORDINATE}, where float32 still has "
            f"places in a map, got {largest:g}"
        )
    return coordinates
