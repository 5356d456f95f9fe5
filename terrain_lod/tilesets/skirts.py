"""Walls around a tile, which hide what is between it and tiles of another level."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from .mend import TileMesh


def with_skirts(mesh: TileMesh, height: float) -> tuple[TileMesh, npt.NDArray[np.int64]]:
    """Return a tile with walls of this height, in whole quanta, below its border.

    Returns
    -------
    mesh : TileMesh
        The walls' vertices come behind all others.
    above : (V',) int64
        The vertex that each of its vertices stands below; itself where it is not the walls'.
    """
    begin, end = mesh.triangles.ravel(), np.roll(mesh.triangles, -1, axis=1).ravel()
    on_border = np.zeros(len(begin), bool)
    for axis in (0, 1):
        for line in (0, mesh.level.size):
            on_line = mesh.places[:, axis] == line
            on_border |= on_line[begin] & on_line[end]
    begin, end = begin[on_border], end[on_border]
    rim, numbers = np.unique(np.concatenate([begin, end]), return_inverse=True)
    below_begin, below_end = len(mesh.places) + numbers.reshape(2, -1)
    walls = np.concatenate(
        [
            np.stack([begin, below_begin, below_end], axis=1),
            np.stack([begin, below_end, end], axis=1),
        ]
    )
    down = int(np.ceil(height / mesh.level.quantum))
    walled = replace(
        mesh,
        places=np.concatenate([mesh.places, mesh.places[rim]]),
        quanta=np.concatenate([mesh.quanta, mesh.quanta[rim] - down]),
        triangles=np.concatenate([mesh.triangles, walls]).astype(np.int32),
    )
    return walled, np.concatenate([np.arange(len(mesh.places)), rim])
