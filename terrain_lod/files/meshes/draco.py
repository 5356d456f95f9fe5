"""KHR_draco_mesh_compression, decoded by Google's library; called in a child process alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ...errors import MissingExtraError
from .raw import Integers

DRACO: Final = "KHR_draco_mesh_compression"


def draco_primitive(
    data: bytes, identifiers: dict[str, int], names: Sequence[str]
) -> tuple[list[npt.NDArray[Any] | None], Integers]:
    """Return the attributes of these names, (V, n) each or None, and the corners.

    Parameters
    ----------
    data : bytes
    identifiers : dict of str to int
        Draco's unique id of each attribute.
    names : sequence of str

    Raises
    ------
    ValueError
        If the data is damaged.
    MissingExtraError
        If there is no DracoPy here.
    """
    try:
        import DracoPy
    except ImportError:
        raise MissingExtraError(
            "expected a glTF without Draco compression, got one with: to read it, install "
            "'terrain_lod[compress]'"
        ) from None
    try:
        mesh = DracoPy.decode(data)
        found = {item["unique_id"]: item["data"] for item in mesh.attributes}
        corners = np.asarray(mesh.faces, np.int64).ravel()
    except Exception as error:  # it has no base class of its own
        raise ValueError(f"its Draco data cannot be decoded: {error}") from None
    return [found.get(identifiers.get(name)) for name in names], corners
