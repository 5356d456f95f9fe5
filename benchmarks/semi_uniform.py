"""Semi-uniform PN-triangles, after table 1 of Dyken, Reimers, Seland (2009).

    python benchmarks/semi_uniform.py [--levels 3 5] [--largest 100000] [--launches 200]

Base meshes of the paper's sizes, seen from several sides, refined uniformly and where the
silhouette is: level by level from queues, and each patch by itself. Times are those of a frame from
factors to vertices, on the wall; the paper's two GPUs beside them also draw it. Of patches by
themselves, so many are timed as --launches says, taken evenly from the mesh.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from statistics import median
from time import perf_counter
from typing import NamedTuple

import numpy as np
from pn import wavy_torus

import terrain_lod as tl
from terrain_lod.curved.adjacency import Adjacency
from terrain_lod.curved.patch_factors import EdgeFactor, SilhouetteFactor, UniformFactor
from terrain_lod.curved.pn import (
    DevicePatchMesh,
    edge_factors_on_device,
    evaluate_on_device,
    levels_on_device,
    nets_on_device,
    patch_factors_on_device,
)
from terrain_lod.tessellation.pattern import DevicePattern
from terrain_lod.tessellation.semi_uniform import semi_uniform_device

VIEWS = 5


class Paper(NamedTuple):
    """Million triangles a second on a GeForce 7800 GT and on an 8800 GT.

    Uniform is method B, a launch a patch D, queues on the GPU G, which the 7800 cannot run.
    """

    triangles: int
    adaptive: int
    uniform: tuple[float, float]
    launches: tuple[float, float]
    queues: float


PAPER = {
    3: (
        Paper(200, 11_000, (15, 21), (6.8, 7.8), 9.8),
        Paper(800, 25_000, (23, 31), (9.4, 12), 22),
        Paper(1_000, 42_000, (23, 33), (12, 16), 35),
        Paper(1_546, 31_000, (25, 29), (10, 13), 25),
        Paper(4_000, 80_000, (26, 30), (14, 18), 55),
        Paper(6_100, 71_000, (27, 37), (13, 17), 49),
        Paper(23_000, 325_000, (27, 36), (18, 21), 90),
        Paper(96_966, 914_000, (27, 37), (18, 21), 101),
    ),
    5: (
        Paper(200, 155_000, (44, 276), (32, 113), 108),
        Paper(800, 347_000, (47, 389), (34, 168), 151),
        Paper(1_000, 595_000, (47, 390), (37, 225), 200),
        Paper(1_546, 412_000, (47, 406), (35, 176), 166),
        Paper(4_000, 1_055_000, (49, 414), (38, 232), 222),
        Paper(6_100, 876_000, (48, 415), (37, 210), 210),
        Paper(23_000, 4_151_000, (48, 428), (41, 264), 245),
        Paper(96_966, 11_945_000, (50, 417), (41, 275), 263),
    ),
}


class Scene:
    """A base mesh on a device, and the levels that cameras around it ask for."""

    def __init__(self, triangles: int, device: tl.Device) -> None:
        mesh = wavy_torus(triangles)
        self.count = len(mesh.triangles)
        adjacency = Adjacency.of(mesh)
        self.patches = DevicePatchMesh.upload(mesh.vertices, mesh.normals, adjacency, device)
        self.nets = nets_on_device(self.patches)
        directions = np.random.default_rng(3).normal(size=(VIEWS, 3))
        eyes = 12 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
        self.views = [
            tl.Camera(tuple(eye.tolist()), (0, 0, 0), up=(0.1, 0.2, 1), fov=60).view((0, 0, 0))
            for eye in eyes
        ]

    def levels(self, formula: EdgeFactor, view: int, maximum: int) -> tl.device.DeviceArray:
        """Return whole levels of all edges, as a frame finds them."""
        factors = edge_factors_on_device(self.patches, formula, 1.0, self.views[view])
        made = patch_factors_on_device(
            self.patches, self.nets, factors, self.views[view], cull=False, back_cosine=None
        )
        return levels_on_device(made.edge, maximum)

    def frame(self, formula: EdgeFactor, view: int, maximum: int) -> DevicePattern:
        """Make all vertices of a frame, a launch a level."""
        levels = self.levels(formula, view, maximum)
        pattern = semi_uniform_device(levels, maximum=maximum, keep_degenerate=True, clockwise=True)
        evaluate_on_device(self.nets, pattern)
        return pattern

    def by_patches(self, formula: EdgeFactor, maximum: int, most: int) -> float:
        """Return triangles a second when each patch goes by itself through all stages."""
        device, some = self.patches.device, np.linspace(0, self.count - 1, min(self.count, most))
        chosen = some.astype(int)
        levels = [
            device.array(row[None]) for row in self.levels(formula, 0, maximum).host()[chosen]
        ]
        nets = [device.array(net[None]) for net in self.nets.host()[chosen]]

        def frame() -> int:
            triangles = 0
            for level, net in zip(levels, nets, strict=True):
                pattern = semi_uniform_device(
                    level, maximum=maximum, keep_degenerate=True, clockwise=True
                )
                evaluate_on_device(net, pattern)
                triangles += pattern.primitives.shape[0]
            return triangles

        return frame() / seconds(device, frame, 1)


def seconds(device: tl.Device, work: Callable[[], object], repeats: int = 5) -> float:
    """Return the median time of `work` on the wall; the first call builds kernels."""
    work()
    device.finish()
    times = []
    for _ in range(repeats):
        begin = perf_counter()
        work()
        device.finish()
        times.append(perf_counter() - begin)
    return median(times)


def row(paper: Paper, level: int, device: tl.Device, most_launches: int) -> str:
    """Return what one base mesh comes to, beside the paper's."""
    scene = Scene(paper.triangles, device)
    # the whole segments of the silhouette's levels: 1 .. 2^level
    uniform, adaptive = UniformFactor(2.0**level), SilhouetteFactor(maximum=2.0**level)
    counts = [scene.frame(adaptive, view, level).primitives.shape[0] for view in range(VIEWS)]
    evenly = scene.count * 4**level / seconds(device, lambda: scene.frame(uniform, 0, level), 3)
    alone = scene.by_patches(adaptive, level, most_launches)
    queued = sum(counts) / sum(
        seconds(device, lambda view=view: scene.frame(adaptive, view, level), 3)
        for view in range(VIEWS)
    )
    here = " ".join(f"{speed / 1e6:9.3g}" for speed in (evenly, alone, queued))
    return (
        f"{scene.count:7,} {scene.count * 4**level:11,} {sum(counts) / VIEWS:11,.0f} "
        f"{paper.adaptive:11,} {here}   {paper.uniform[0]:5g} {paper.uniform[1]:5g}  "
        f"{paper.launches[0]:5g} {paper.launches[1]:5g}  {paper.queues:5g}"
    )


def main() -> None:
    """Print a table a level."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--levels", type=int, nargs="+", default=[3, 5], choices=(3, 5))
    parser.add_argument("--largest", type=int, default=100_000, help="triangles of a base mesh")
    parser.add_argument("--launches", type=int, default=200, help="patches timed one by one")
    parser.add_argument("--device", help="part of a device's name, cpu or gpu")
    options = parser.parse_args()
    device = tl.Device.open(options.device)
    print(device.info)
    for level in options.levels:
        print(
            f"\nlevels up to {level}, in million triangles a second\n"
            "                    triangles                            here            "
            "    paper: 7800 GT, 8800 GT\n"
            "   base     uniform    adaptive  paper's ad.   uniform  launches    queues"
            "     uniform      launches  queues"
        )
        for paper in PAPER[level]:
            if paper.triangles <= options.largest:
                print(row(paper, level, device, options.launches), flush=True)


if __name__ == "__main__":
    main()
