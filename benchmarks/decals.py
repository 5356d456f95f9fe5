"""Decals that a camera does not see: what is saved, and whether a picture shows it.

    python benchmarks/decals.py [--cameras 10] [--decals 40]

A ring that was shot at, from cameras around it: triangles and device time with all decals refined,
with those in view, and with those that are not turned away as well. Exits with 1 if a pixel
differs.
"""

from __future__ import annotations

import argparse
import sys
from functools import partial
from pathlib import Path
from statistics import median

import numpy as np

import terrain_lod as tl
from measure import interleaved, ratio
from terrain_lod.drawing.picture import draw

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from support.curved_meshes import torus

WAYS = {
    "all": {"cull": False},
    "in view": {},
    "facing": {"back_faces": 0.0},
}


def main() -> None:
    """Run all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cameras", type=int, default=10)
    parser.add_argument("--decals", type=int, default=40)
    options = parser.parse_args()
    device, random, ring = tl.Device.open(), np.random.default_rng(6), torus(64, 32)
    eyes = random.normal(size=(options.decals, 3)) * 9
    shots = tl.curved.shoot(
        ring,
        eyes,
        random.normal(size=eyes.shape) - eyes,
        random.uniform(0.1, 0.4, options.decals),
        scale=0.06,
    )
    bowl = np.clip(1 - np.hypot(*np.mgrid[-1:1:96j, -1:1:96j]) ** 2, 0, None)
    changed, saved, faster = 0, [], []
    for number in range(options.cameras):
        toward = random.normal(size=3)
        eye = toward / np.linalg.norm(toward) * random.uniform(4, 8)
        target = tuple((random.normal(size=3) * 0.3).tolist())
        camera = tl.Camera(tuple(eye.tolist()), target, size=(800, 600), near=0.01)
        press = partial(tl.curved.dent, ring, shots, bowl, curved=True, camera=camera)
        meshes = {name: press(**how) for name, how in WAYS.items()}
        times = interleaved(
            device, {n: partial(press, **how) for n, how in WAYS.items()}, repeats=5
        )
        pictures = [draw(mesh, camera, style="plain") for mesh in meshes.values()]
        changed += sum(not np.array_equal(pictures[0], other) for other in pictures[1:])
        counts = [len(mesh.triangles) for mesh in meshes.values()]
        saved.append(1 - counts[2] / counts[0])
        faster.append(1 - ratio(times, "facing", "all"))
        print(
            f"  camera {number}: {counts[0]:,} triangles, {counts[1]:,} in view, {counts[2]:,} "
            f"facing; {faster[-1]:.0%} of the time saved",
            flush=True,
        )
    print(
        f"median of {len(saved)} cameras: {median(saved):.0%} of the triangles and "
        f"{median(faster):.0%} of the device time saved; {changed} pictures changed"
    )
    sys.exit(bool(changed))


if __name__ == "__main__":
    main()
