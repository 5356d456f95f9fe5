"""The picture that lies over a mesh: packed, and beside an OBJ file."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
from PIL import Image

from ...errors import InputError
from ...mesh.mesh import Mesh
from ...paths import replacing

# of 100: no one sees a difference above that
_QUALITY: Final = 92


def packed(picture: Any, mesh: Mesh) -> bytes:
    """Return a picture as JPEG.

    Parameters
    ----------
    picture : (H, W, 3) uint8
        Row 0 at the top, where v is 1.

    Raises
    ------
    InputError
        If it is no such array, or the mesh does not say where its vertices are in it.
    """
    shown: npt.NDArray[Any] = np.asarray(picture)
    if shown.ndim != 3 or shown.shape[2] != 3 or shown.dtype != np.uint8 or not shown.size:
        raise InputError(f"expected a picture (H, W, 3) of bytes, got {shown.shape} {shown.dtype}")
    if max(shown.shape) > 65_500:
        raise InputError(f"expected a picture of at most 65500 pixels a side, got {shown.shape}")
    if mesh.textures is None:
        raise InputError("expected a mesh with texture coordinates for a picture, got one without")
    stream = io.BytesIO()
    Image.fromarray(shown).save(stream, "JPEG", quality=_QUALITY)
    return stream.getvalue()


def write_beside(content: bytes, path: Path) -> str:
    """Write picture and material of an OBJ file beside it; return what the file begins with."""
    picture, material = path.with_suffix(".jpg"), path.with_suffix(".mtl")
    with replacing(picture) as temporary:
        temporary.write_bytes(content)
    with replacing(material) as temporary:
        temporary.write_text(
            f"newmtl drape\nKa 0 0 0\nKd 1 1 1\nKs 0 0 0\nmap_Kd {picture.name}\n", encoding="utf-8"
        )
    return f"mtllib {material.name}\nusemtl drape\n"
