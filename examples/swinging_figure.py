"""A swinging figure
=================

A figure of a few boxes, smoothed once, then posed again and again on the device.
"""

import numpy as np
from PIL import Image

import terrain_lod as tl

# boxes of a figure: legs, body, arms and head, as (x, z)
cells = {(-1, 0), (1, 0), (-1, 1), (1, 1), (-1, 2), (0, 2), (1, 2), (-1, 3), (0, 3), (1, 3),
         (-2, 3), (-3, 3), (2, 3), (3, 3), (0, 4), (0, 5)}  # fmt: skip
quads = []
for x, z in cells:
    for axis, step in ((0, -1), (0, 1), (1, -1), (1, 1), (2, -1), (2, 1)):
        if axis == 1 or ((x + step, z) if axis == 0 else (x, z + step)) not in cells:
            square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])[:: step or 1] * 2 - 1
            square[:, 2] = step
            quads.append(np.roll(square, axis + 1, axis=1) / 2 + (x, 0, z))
corners, faces = np.unique(np.concatenate(quads), axis=0, return_inverse=True)
control = tl.curved.ControlMesh(corners, faces.reshape(-1, 4))
mesh = tl.curved.catmull_clark(control, factor=2, partitioning="integer")
figure = tl.curved.PosedMesh(mesh, factor=5)


def turned(vectors: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Return vectors turned in the x-z plane, each by its own angle."""
    x, y, z = vectors.T
    sine, cosine = np.sin(angles), np.cos(angles)
    return np.stack([x * cosine + z * sine, y, z * cosine - x * sine], axis=1)


frames, seconds = [], []
for time in np.linspace(0, 2 * np.pi, 9)[:-1]:
    # arms swing about the shoulders, all of it sways about the feet
    swing = 0.9 * np.sin(time) * np.clip((np.abs(mesh.vertices[:, 0]) - 1.2) / 0.8, 0, 1) ** 2
    shoulder = np.sign(mesh.vertices[:, :1]) * (1.5, 0, 0) + (0, 0, 3)
    sway = 0.05 * np.cos(time) * mesh.vertices[:, 2]
    vertices = turned(turned(mesh.vertices - shoulder, swing) + shoulder, sway)
    frame = figure.pose(vertices, turned(turned(mesh.normals, swing), sway))
    assert not tl.crack_report(frame, closed=True)
    seconds.append(sum(frame.timings.values()))
    camera = tl.Camera((3, -11, 5), (0, 0, 2.4), fov=40, size=(240, 240))
    frames.append(tl.render(frame, camera=camera, style="plain"))
print(f"{figure}: closed in {len(frames)} frames, {1 / np.median(seconds):.0f} a second")
Image.fromarray(np.concatenate(frames[:6], axis=1)).save("swinging_figure.png")
