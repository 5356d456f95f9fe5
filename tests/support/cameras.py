"""Cameras of all sorts over a ground."""

from __future__ import annotations

import numpy as np

import terrain_lod as tl


def cameras_over(ground: tl.Heightmap, count: int, seed: int = 0) -> list[tl.Camera]:
    """Return cameras above, beside, behind and inside the ground's box, parallel ones too."""
    random = np.random.default_rng(seed)
    width, depth = ground.extent
    low, high = ground.height_range
    cameras = []
    for index in range(count):
        at = random.uniform(-0.3, 1.3, 2) * (width, -depth) + ground.origin
        eye = (*at, random.uniform(low, high + 0.2 * width))
        heading, pitch = random.uniform(0, 2 * np.pi), random.uniform(-1.2, 0.3)
        view = np.array([np.cos(heading), np.sin(heading), np.tan(pitch)])
        cameras.append(
            tl.Camera(
                eye,
                tuple(eye + view),
                fov=random.uniform(20, 100),
                size=(1280, 720),
                height=width / 3 if index % 5 == 4 else None,
            )
        )
    return cameras
