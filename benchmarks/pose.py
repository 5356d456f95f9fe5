"""Posing a character again and again, beside the evaluation alone and beside smoothing it anew.

    python benchmarks/pose.py [--factor 5]

Device times in turn within one run; frames a second are the caller's, download included.
"""

from __future__ import annotations

import argparse
import time
from statistics import median

from character import character

import terrain_lod as tl
from measure import interleaved, ratio
from terrain_lod.curved.pn import evaluate_on_device


def main() -> None:
    """Print both ratios and frames a second."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--factor", type=float, default=5.0)
    options = parser.parse_args()
    device, mesh = tl.Device.open(), character()
    figure = tl.curved.PosedMesh(mesh, factor=options.factor, device=device)
    works = {
        "pose": lambda: figure.pose(mesh.vertices, mesh.normals),
        "evaluation": lambda: evaluate_on_device(figure._base.nets, figure._pattern),
        "anew": lambda: tl.pn_triangles(mesh, options.factor, device=device),
    }
    times = interleaved(device, works)
    frames = []
    for _ in range(15):
        start = time.perf_counter()
        works["pose"]()
        frames.append(time.perf_counter() - start)
    print(
        f"{len(mesh.triangles):,} triangles become {len(figure.rest.triangles):,}: a pose takes "
        f"{ratio(times, 'pose', 'evaluation'):.2f} x the evaluation alone, smoothing anew "
        f"{ratio(times, 'anew', 'evaluation'):.2f} x; {1 / median(frames):.0f} frames a second"
    )


if __name__ == "__main__":
    main()
