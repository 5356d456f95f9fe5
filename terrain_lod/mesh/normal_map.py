"""Normals that a mesh lacks, as a picture: the value that meshes carry and files hold."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arguments import array
from ..errors import InputError


@dataclass(frozen=True, eq=False)
class NormalMap:
    """A normal map in the tangent space of glTF 2.0, over a mesh's texture coordinates.

    A texel says ``2 colour / 255 - 1``: x along the tangent, y along the bitangent, z along the
    normal of the mesh. All three are blended over a triangle and not made unit length again, as
    MikkTSpace wants it; the bitangent is ``w cross(normal, tangent)``, and points to the top of the
    picture.

    Attributes
    ----------
    pixels : (R, C, 3) uint8
        The first row is the top, where v = 1.
    tangents : (V, 4) float32
        Unit tangent of each vertex towards u, and w, which is 1 or -1.
    """

    pixels: npt.NDArray[np.uint8]
    tangents: npt.NDArray[np.float32]

    def __post_init__(self) -> None:
        pixels = np.asarray(self.pixels)
        if pixels.ndim != 3 or pixels.shape[2] != 3 or pixels.dtype != np.uint8:
            raise InputError(
                f"expected pixels of shape (R, C, 3) and dtype uint8, got {pixels.shape} "
                f"{pixels.dtype}"
            )
        object.__setattr__(self, "pixels", pixels)
        object.__setattr__(self, "tangents", array("tangents", self.tangents, ("V", 4)))

    def __repr__(self) -> str:
        rows, columns, _ = self.pixels.shape
        return f"NormalMap({columns} x {rows} texels)"
