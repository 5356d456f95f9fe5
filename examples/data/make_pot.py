"""Write pot.bpt: a tea pot's body, a profile of our own turned around the z axis.

Each cubic of the profile becomes four bicubic patches of a quarter turn. A cubic is within 0.03 %
of a quarter circle when its inner control points are 0.5523 radii along the tangents: Dokken,
Daehlen, Lyche, Morken, "Good approximation of circles by curvature-continuous Bezier curves",
Computer Aided Geometric Design 7, 1990.

    python examples/data/make_pot.py
"""

from pathlib import Path

import numpy as np

from terrain_lod.files.meshes.bpt import save_bpt

# radius and height; each row a cubic that begins where the one before ends
PROFILE = [
    [(0.0, 0.0), (0.6, 0.0), (1.0, 0.0), (1.15, 0.08)],  # bottom
    [(1.15, 0.08), (1.45, 0.24), (1.75, 0.6), (1.75, 1.0)],  # belly
    [(1.75, 1.0), (1.75, 1.5), (1.35, 1.75), (1.0, 1.85)],  # shoulder
    [(1.0, 1.85), (0.7, 2.05), (0.35, 2.1), (0.2, 2.15)],  # lid
    [(0.2, 2.15), (0.1, 2.18), (0.22, 2.25), (0.3, 2.35)],  # neck of the knob
    [(0.3, 2.35), (0.38, 2.45), (0.25, 2.6), (0.0, 2.6)],  # knob
]
CIRCLE = 4 / 3 * (np.sqrt(2) - 1)


def quarters(profile: list[tuple[float, float]]) -> list[np.ndarray]:
    """Return four patches (4, 4, 3) around the axis: u counter-clockwise, v along the profile."""
    radius, height = np.array(profile).T
    # four points of a quarter of the unit circle
    x, y = np.array([1.0, 1.0, CIRCLE, 0.0]), np.array([0.0, CIRCLE, 1.0, 1.0])
    patches = []
    for _ in range(4):
        columns = [np.outer(x, radius), np.outer(y, radius), np.outer(np.ones(4), height)]
        patches.append(np.stack(columns, axis=-1))
        # a quarter turn of coordinates is exact: neighbours share the bits of their edge
        x, y = -y, x
    return patches


if __name__ == "__main__":
    nets = np.array([patch for curve in PROFILE for patch in quarters(curve)])
    print(save_bpt(nets, Path(__file__).with_name("pot.bpt")))
