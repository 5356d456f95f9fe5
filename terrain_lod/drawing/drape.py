"""A picture laid over the ground, its rows and columns along those of the raster."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from PIL import Image

from ..errors import FileError, InputError
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh

_LARGEST: Final = 4096  # pixels along one side, in reach of every driver


@dataclass(frozen=True, eq=False)
class Drape:
    """A picture and the ground that it covers, edge to edge.

    Attributes
    ----------
    picture : (H, W, 3) uint8
        Row 0 north.
    ground : Heightmap

    Raises
    ------
    InputError
        If the picture is no such array.
    """

    picture: npt.NDArray[np.uint8]
    ground: Heightmap

    def __post_init__(self) -> None:
        picture = self.picture
        if picture.ndim != 3 or picture.shape[2] != 3 or picture.dtype != np.uint8:
            raise InputError(
                f"expected a picture (H, W, 3) of bytes, got {picture.shape} {picture.dtype}"
            )
        step = -(-max(picture.shape) // _LARGEST)
        object.__setattr__(self, "picture", np.ascontiguousarray(picture[::step, ::step]))

    @classmethod
    def load(cls, path: Path, ground: Heightmap) -> Drape:
        """Return the drape with the picture of a file.

        Raises
        ------
        FileError
            If there is no such file, or it is no picture.
        """
        try:
            with Image.open(path) as image:
                return cls(np.asarray(image.convert("RGB")), ground)
        except OSError as error:
            reason = error.strerror or "it is no picture that Pillow knows"
            raise FileError(f"cannot read {path}: {reason}") from None

    def coordinates(self, mesh: Mesh) -> npt.NDArray[np.float32]:
        """Return where each vertex is in the picture: u east, v north, 0 to 1; (V, 2).

        Each sample of the ground is the middle of a pixel, if there are as many.
        """
        rows, columns = self.ground.shape
        shift = np.subtract(mesh.origin[:2], self.ground.origin).astype(np.float32)
        dx, dy = (np.float32(step) for step in self.ground.spacing)
        u = ((mesh.vertices[:, 0] + shift[0]) / dx + np.float32(0.5)) / np.float32(columns)
        v = ((mesh.vertices[:, 1] + shift[1]) / dy - np.float32(0.5)) / np.float32(rows) + 1
        return np.stack([u, v], axis=1).astype(np.float32)

    def lay(self, mesh: Mesh, surface: Any, actor: Any) -> None:
        """Lay the picture over pyvista's `surface` of a mesh, shown by `actor`."""
        import pyvista

        surface.active_texture_coordinates = self.coordinates(mesh)
        actor.texture = pyvista.Texture(self.picture)
