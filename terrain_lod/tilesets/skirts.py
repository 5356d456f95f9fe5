"""Walls around a tile, which hide what is between it and tiles of another level."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from .tile_mesh import TileMesh


def with_skirts(mesh: TileMesh, height: float) -> tuple[TileMesh, npt.NDArray[np.int64]]:
    """Return a tile with walls of this height, in whole quanta, below its border.

    Returns
    -------
    mesh : TileMesh
        The walls' vertices come behind all others.
    above : (V',) int64
        The vertex that each of its vertices stands below; itself where it is not the walls'.
    """
    size = mesh.level.size
    sides = []
    # counter-clockwise around the tile
    for axis, line, forward in ((0, 0, True), (1, size, True), (0, size, False), (1, 0, False)):
        side = np.flatnonzero(mesh.places[:, 1 - axis] == line)
        along = np.argsort(mesh.places[side, axis])
        sides.append(side[along if forward else along[::-1]][:-1])
    rim = np.concatenate(sides)
    below = len(mesh.places) + np.arange(len(rim))
    following, below_following = np.roll(rim, -1), np.roll(below, -1)
    walls = np.concatenate(
        [
            np.stack([rim, below, below_following], axis=1),
            np.stack([rim, below_following, following], axis=1),
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
