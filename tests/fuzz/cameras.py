"""Damaged files of cameras, and JSON that is none: what is read can take a picture."""

from __future__ import annotations

import json
import random
from pathlib import Path
from typing import Any, Final

import numpy as np

from fuzz.damage import damaged
from fuzz.kind import require
from terrain_lod.camera.camera import Camera
from terrain_lod.camera.camera_file import load_camera, load_cameras

_WHOLE: Final = {
    "eye": [1000.0, -2000.0, 900.0], "target": [0, 0, 100], "up": [0, 0, 1], "fov": 50,
    "size": [640, 480], "near": None, "far": 1e5, "height": None,
}  # fmt: skip
_ODD: Final = (
    None, True, False, 0, -1, 1, 1e39, 1e308, -1e308, 5e-324, 10**400, "12", "", [], [1], [1, 2],
    [1, 2, 3], [0, 0, 0], [1e308, -1e308, 1e308], [None, 1, 2], ["1", 2, 3], [[1, 2, 3]], {},
    {"eye": 1}, [640, 1 << 40], [0, 0], [1.5, 2], float("nan"), float("inf"), "\ud800",
)  # fmt: skip


def trial(chance: random.Random, folder: Path) -> None:
    camera: dict[str, Any] = dict(_WHOLE)
    for _ in range(chance.choice((0, 1, 1, 2))):
        camera[chance.choice((*_WHOLE, "eyes"))] = chance.choice(_ODD)
    content: Any = chance.choice(
        (camera, {"camera": camera}, [camera, _WHOLE], chance.choice(_ODD))
    )
    data = json.dumps(content).encode()
    path = folder / "damaged.json"
    path.write_bytes(damaged(data, chance) if chance.random() < 0.3 else data)
    found = load_cameras(path) if chance.random() < 0.3 else [load_camera(path)]
    for camera_read in found:
        _look(camera_read)


def _look(camera: Camera) -> None:
    """Ask a camera what pictures ask."""
    width, height = camera.size
    require(width >= 1 and height >= 1, f"a picture of {width} x {height}")
    numbers = [*camera.eye, *camera.target, *camera.up, camera.near, camera.fov]
    require(bool(np.isfinite(np.array(numbers, np.float64)).all()), "a camera that is not finite")
