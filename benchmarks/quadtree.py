"""Patches of every size: time, launches and bytes that come down, first and asked again.

    python benchmarks/quadtree.py against [--ground ridge canyon jacksboro fractal] [--metres 30]
    python benchmarks/quadtree.py large [--samples 8192 16384] [--pixels 1]

`against`: from raster in host memory to mesh in host memory, tree included, beside pydelatin.
`large`: one pixel at 1920 x 1080 over a rugged fractal, from 100 m up and from 100 km.

Wall time is from the call to the mesh in host memory; device time is that of the kernels alone.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from promise import DELATIN, fractal, ground_of

import terrain_lod as tl
from terrain_lod.device.device import Device, DeviceArray


@dataclass
class Cost:
    """What one call came to; bytes are those brought down to the host."""

    wall: float = np.inf
    device: float = 0.0
    launches: int = 0
    bytes: int = 0
    stages: str = ""

    def __str__(self) -> str:
        return (
            f"{1e3 * self.wall:8.1f} ms, {1e3 * self.device:8.2f} on the device, "
            f"{self.launches:3} launches, {self.bytes / 1e6:7.2f} MB down"
        )


@contextmanager
def bytes_down() -> Iterator[list[int]]:
    """Collect the sizes of all arrays that are brought down."""
    sizes: list[int] = []
    bring_down = DeviceArray.host

    def counted(array: DeviceArray) -> Any:
        sizes.append(array.nbytes)
        return bring_down(array)

    DeviceArray.host = counted  # type: ignore[method-assign]
    try:
        yield sizes
    finally:
        DeviceArray.host = bring_down  # type: ignore[method-assign]


def cost_of(work: Callable[[], tl.Mesh]) -> tuple[Cost, tl.Mesh]:
    device = Device.open()
    device.finish()
    with bytes_down() as sizes, device.timed() as timeline:
        start = time.perf_counter()
        mesh = work()
        wall = time.perf_counter() - start
        seconds = timeline.seconds
    stages = ", ".join(f"{name} {1e3 * each:.2f}" for name, each in seconds.items())
    return Cost(wall, sum(seconds.values()), timeline.launches, sum(sizes), stages), mesh


def against(name: str, samples: int, metres: float, tile: int, rounds: int) -> None:
    """Print the least of a few rounds, in turn with pydelatin."""
    ground, lod = ground_of(name, samples), tl.MaxErrorLod(metres)
    best = {"first": Cost(), "again": Cost(), "pydelatin": Cost()}
    for _ in range(rounds):
        made: list[tl.Terrain] = []

        def first(made: list[tl.Terrain] = made) -> tl.Mesh:
            made.append(tl.Terrain(ground, tile=tile))
            return made[0].mesh(lod=lod, partitioning="integer")

        found = {"first": cost_of(first)}
        found["again"] = cost_of(partial(made[0].mesh, lod=lod, partitioning="integer"))
        found["pydelatin"] = cost_of(partial(DELATIN.mesh, ground, metres))
        for label, (cost, _) in found.items():
            best[label] = min(best[label], cost, key=lambda each: each.wall)
    counts = {label: len(mesh.triangles) for label, (_, mesh) in found.items()}
    print(f"{name}, {samples} x {samples}, {metres:g} m, tiles of {tile}")
    for label, cost in best.items():
        faster = best["pydelatin"].wall / cost.wall
        print(f"  {label:10}{cost}, {faster:5.2f} x as fast, {counts[label]:,} triangles")


def large(samples: int, pixels: float, tile: int, rounds: int) -> None:
    """Print what a view costs when it is first asked for, and the least of when it is again."""
    warm = tl.Terrain(fractal(256), tile=tile)  # builds kernels
    warm.mesh(lod=tl.MaxErrorLod(30.0), partitioning="integer")
    ground = fractal(samples)
    width, depth = ground.extent
    west, north, *_ = ground.origin
    middle = np.array([west + width / 2, north - depth / 2])
    terrain = tl.Terrain(ground, tile=tile)
    top = float(terrain.height_at(middle[None])[0])
    # low along the ground, and straight down from afar
    for up, along in ((100.0, 1000.0), (100_000.0, 1.0)):
        eye = (*middle, top + up)
        ahead = (eye[0] + along, eye[1], top)
        camera = tl.Camera(eye, ahead, fov=55, size=(1920, 1080))
        work = partial(terrain.mesh, camera, lod=tl.ScreenErrorLod(pixels), partitioning="integer")
        first, mesh = cost_of(work)
        again = min((cost_of(work)[0] for _ in range(rounds)), key=lambda cost: cost.wall)
        print(
            f"{samples} x {samples}, tiles of {tile}, {up:g} m up: {len(mesh.triangles):,} "
            f"triangles in {mesh.patches.count:,} patches, {mesh.achieved.rounds} rounds"
        )
        print(f"  first {first}\n        {first.stages}")
        print(f"  again {again}\n        {again.stages}", flush=True)


def main() -> None:
    """Run the chosen part."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=("against", "large"))
    parser.add_argument("--ground", nargs="+", default=["ridge", "canyon", "jacksboro", "fractal"])
    parser.add_argument("--samples", type=int, nargs="+")
    parser.add_argument("--metres", type=float, default=30.0)
    parser.add_argument("--pixels", type=float, default=1.0)
    parser.add_argument("--tile", type=int, default=4)
    parser.add_argument("--rounds", type=int, default=8)
    options = parser.parse_args()
    if options.part == "large":
        for samples in options.samples or (8192, 16384):
            large(samples, options.pixels, options.tile, options.rounds)
        return
    for samples in options.samples or (512,):
        for name in options.ground:
            against(name, samples, options.metres, options.tile, options.rounds)


if __name__ == "__main__":
    main()
