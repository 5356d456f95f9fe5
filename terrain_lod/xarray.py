"""``array.terrain_lod``: what xarray's arrays can do once this module is imported.

>>> import terrain_lod.xarray
>>> mesh = array.terrain_lod.mesh(lod=tl.MaxErrorLod(2.0))      # doctest: +SKIP
"""

from __future__ import annotations

from typing import Any

from .camera.camera import Camera
from .errors import MissingExtraError
from .files.rasters.labelled import EXTRA
from .files.rasters.loading import load
from .ground.heightmap import Heightmap
from .mesh.mesh import Mesh
from .terrain.lod import AnyLod
from .terrain.terrain import Terrain

try:
    import xarray
except ImportError:
    raise MissingExtraError(f"expected xarray, got no such package: {EXTRA}") from None


@xarray.register_dataarray_accessor("terrain_lod")
class GroundAccessor:
    """An array of heights as ground.

    Parameters
    ----------
    array : xarray.DataArray
    """

    def __init__(self, array: Any) -> None:
        self._array = array

    def heightmap(self, **options: Any) -> Heightmap:
        """Return the ground; the options are those of :func:`terrain_lod.load`."""
        return load(self._array, **options)

    def mesh(
        self, camera: Camera | None = None, *, lod: AnyLod | None = None, **options: Any
    ) -> Mesh:
        """Return its triangles, as :meth:`terrain_lod.Terrain.mesh` makes them.

        Other options are those of :func:`terrain_lod.load`.
        """
        return Terrain(self.heightmap(**options)).mesh(camera, lod=lod)
