"""From whatever holds heights to a source."""

from __future__ import annotations

import os
from typing import Any

from ..arguments import file_path, told
from ..errors import InputError
from ..files.rasters.labelled import is_labelled
from ..ground.heightmap import Heightmap
from .arrays import Array, Ground
from .folder import Folder
from .raster_file import RasterFile
from .source import Source


def source_of(ground: Any, **options: Any) -> Source:
    """Return ground as what is read window by window.

    Parameters
    ----------
    ground : path, array or Heightmap
        A file that :func:`terrain_lod.load` reads, a folder of such tiles, an array of NumPy,
        xarray, dask or zarr, a memory map, or a heightmap.
    **options
        Those of :func:`terrain_lod.load` that are of heights and their place.

    Raises
    ------
    FileError, InputError, MissingExtraError
        If it is none of these, or no ground.
    """
    if isinstance(ground, Heightmap):
        if any(option is not None for option in options.values()):
            raise InputError("expected no options of reading with a Heightmap, which is read")
        return Ground(ground)
    if isinstance(ground, str | os.PathLike):
        path = file_path("ground", ground)
        return (Folder if path.is_dir() else RasterFile).of(path, **options)
    if is_labelled(ground) or all(
        hasattr(ground, name) for name in ("shape", "dtype", "__getitem__")
    ):
        if options.pop("band", None) is not None:
            raise InputError("expected band= with a file, got it with an array")
        return Array.of(ground, **options)
    raise InputError(
        f"expected a file, a folder of tiles, an array or a Heightmap, got {told(ground)}"
    )
