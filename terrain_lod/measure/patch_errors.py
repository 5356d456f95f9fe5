"""How far is each patch of a mesh from the ground?"""

from __future__ import annotations

import warnings

import numpy as np
import numpy.typing as npt

from ..arguments import instance
from ..device.device import Device
from ..errors import InputError
from ..ground.grid import TileGrid
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh
from .error import vertical_error


def patch_errors(
    mesh: Mesh, ground: Heightmap, *, device: Device | None = None
) -> npt.NDArray[np.float32]:
    """Measure the largest vertical error of each patch of a terrain's mesh.

    Parameters
    ----------
    mesh : Mesh
        Of :meth:`terrain_lod.Terrain.mesh`.
    ground : Heightmap
        That the terrain was made of; with detail, ``ground.with_detail(detail)``.
    device : Device, optional

    Returns
    -------
    (P,) float32
        In the raster's unit, patch by patch; NaN where nothing was measured.
        A sample on a border counts for every patch that it borders.

    Raises
    ------
    InputError
        If the mesh has no patches, or `ground` is not what they are patches of.
    DeviceMemoryError
        If the device cannot hold mesh and raster.

    Examples
    --------
    >>> surface = mesh.to_pyvista()                                 # doctest: +SKIP
    >>> errors = patch_errors(mesh, ground)                         # doctest: +SKIP
    >>> surface["error"] = errors[surface["patch"]]                 # doctest: +SKIP
    """
    instance("a Mesh", mesh, Mesh), instance("a Heightmap for ground", ground, Heightmap)
    if mesh.patches is None:
        raise InputError("expected a mesh of a terrain, got one without patches")
    grid = mesh.patches.grid
    place, own = (*mesh.origin[:2].tolist(),), (*ground.origin,)
    if place != own or grid != TileGrid.of(ground, grid.tile):
        raise InputError(
            f"expected the ground that the mesh was made of, {_described(grid, place)}, got "
            f"{_described(TileGrid.of(ground, grid.tile), own)}: measure a terrain with detail "
            "against ground.with_detail(detail)"
        )
    worst = vertical_error(mesh, ground, field=True, device=device).field
    assert worst is not None  # asked for
    worst = np.abs(worst, out=worst)
    # neighbours share their border samples
    areas = mesh.patches.areas.tolist()
    parts = [
        worst[top : top + down + 1, left : left + across + 1] for top, left, down, across in areas
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of patches without any data
        return np.array([np.nanmax(part) for part in parts], np.float32)


def _described(grid: TileGrid, origin: tuple[float, float]) -> str:
    (dx, dy), (x, y) = grid.spacing, origin
    return f"{grid.rows} x {grid.columns} samples {dx:g} x {dy:g} apart from ({x:.10g}, {y:.10g})"
