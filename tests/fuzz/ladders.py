"""Damaged files of error ladders, and ladders that lie: a promise is kept all the same."""

from __future__ import annotations

import random
from collections.abc import Callable
from functools import cache
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

import numpy as np

from fuzz.damage import damaged
from fuzz.kind import require
from support.grounds import rough
from terrain_lod.ground.heightmap import Heightmap
from terrain_lod.measure.error import vertical_error
from terrain_lod.terrain.lod_promises import MaxErrorLod
from terrain_lod.terrain.terrain import Terrain

_PROMISE: Final = 1.0
_ODD: Final = (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e-40, 1e30)


def trial(chance: random.Random, folder: Path) -> None:
    path = folder / "damaged.npz"
    make = chance.choice((damaged, damaged, _with_odd_errors, _of_another_type))
    path.write_bytes(make(_ladder(), chance))
    terrain = Terrain(_ground())
    terrain.load_ladder(path)
    mesh = terrain.mesh(lod=MaxErrorLod(_PROMISE))
    require(bool(np.isfinite(mesh.vertices).all()), "a mesh that is not finite")
    # finished triangles are measured, whatever a ladder says
    error = vertical_error(mesh, _ground()).maximum
    require(error <= _PROMISE + 1e-4, f"promised {_PROMISE}, measured {error:g}")


@cache
def _ground() -> Heightmap:
    return rough(40, 33)


@cache
def _ladder() -> bytes:
    with TemporaryDirectory() as folder:
        return Terrain(_ground()).save_ladder(Path(folder) / "whole.npz").read_bytes()


def _with_odd_errors(content: bytes, chance: random.Random) -> bytes:
    def change(values: np.ndarray) -> np.ndarray:
        flat = values.ravel()
        for _ in range(chance.randint(1, 3)):
            flat[chance.randrange(flat.size)] = chance.choice(_ODD)
        return values

    return _rewritten(content, chance, change)


def _of_another_type(content: bytes, chance: random.Random) -> bytes:
    dtype = chance.choice(("f8", "f2", "i4", "U4", "?", "c8", "M8[s]"))
    return _rewritten(content, chance, lambda values: values.astype(np.int8).astype(dtype))


def _rewritten(
    content: bytes, chance: random.Random, change: Callable[[np.ndarray], np.ndarray]
) -> bytes:
    """Return a ladder of which one array is changed."""
    arrays = dict(np.load(BytesIO(content)))
    name = chance.choice([name for name in arrays if name != "key"])
    arrays[name] = change(arrays[name])
    file = BytesIO()
    np.savez(file, **arrays)
    return file.getvalue()
