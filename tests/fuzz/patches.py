"""Damaged files of Bézier patches: what is read is a net of finite points."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Final

import numpy as np

from fuzz.damage import damaged
from fuzz.kind import require
from terrain_lod.files.meshes.bpt import load_bpt

_POINT: Final = "".join(f"{i % 4} {i // 4} {(i * 7) % 5 / 10}\n" for i in range(16))
_FILES: Final = (
    f"2\n3 3\n{_POINT}3 3\n{_POINT}".encode(),
    f"1\r\n3 3\r\n{_POINT}\r\n\r\n".encode(),
    b"0\n",
)


def trial(chance: random.Random, folder: Path) -> None:
    path = folder / "damaged.bpt"
    path.write_bytes(damaged(chance.choice(_FILES), chance))
    nets = load_bpt(path)
    require(nets.shape[1:] == (4, 4, 3), f"nets of shape {nets.shape}")
    require(bool(np.isfinite(nets).all()), "points that are not finite")
