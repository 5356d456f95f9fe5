"""Speed of queries: heights and rays of the ground and of meshes, and updates of moving ground.

    python benchmarks/queries.py [--samples 1025] [--count 100000]

Prints medians of rounds, from arrays on the host to arrays on the host.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from statistics import median
from time import perf_counter

import numpy as np

import terrain_lod as tl


def fractal(samples: int) -> tl.Heightmap:
    """Return seeded ground with detail at all scales, some kilometres wide."""
    steps = np.random.default_rng(0).normal(size=(samples, samples)).astype(np.float32)
    heights = steps.cumsum(axis=0).cumsum(axis=1)
    return tl.Heightmap(heights / heights.std() * 400, spacing=30.0, origin=(5e5, 4e6))


def seconds(work: Callable[[], object], rounds: int = 7) -> float:
    """Return the median time of `work`, warm."""
    work()
    times = []
    for _ in range(rounds):
        start = perf_counter()
        work()
        times.append(perf_counter() - start)
    return median(times)


def looks(ground: tl.Heightmap, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return an eye above the ground and the directions of a picture's pixels."""
    x, y, z = ground.centre
    width, depth = ground.extent
    eye = (x - 0.4 * width, y - 0.4 * depth, z + 0.1 * width)
    camera = tl.Camera(eye, (x, y, z), fov=60)
    right, upward, forward = camera.axes
    random = np.random.default_rng(1)
    across, up = random.uniform(-1, 1, (2, count, 1))
    half_width, half_height = camera.half_extents
    return np.array(camera.eye), forward + across * half_width * right + up * half_height * upward


def queries(terrain: tl.Terrain, count: int) -> None:
    """Print queries a second of the ground and of two meshes."""
    ground = terrain.ground
    random = np.random.default_rng(2)
    width, depth = ground.extent
    points = ground.origin + random.uniform(0, 1, (count, 2)) * (width, -depth)
    eye, directions = looks(ground, count)
    surfaces: dict[str, tl.Terrain | tl.MeshQueries] = {"ground": terrain}
    for lod in (tl.UniformLod(15), tl.MaxErrorLod(20.0)):
        mesh = terrain.mesh(lod=lod)
        start = perf_counter()
        surface = tl.MeshQueries(mesh, device=terrain.device)
        terrain.device.finish()
        surfaces[f"{len(mesh.triangles):,} triangles"] = surface
        print(
            f"  lists of {len(mesh.triangles):,} triangles {(perf_counter() - start) * 1e3:.1f} ms"
        )
    for name, surface in surfaces.items():
        heights = seconds(lambda s=surface: s.height_at(points))
        rays = seconds(lambda s=surface: s.cast(eye, directions))
        hit = surface.cast(eye, directions).hit.mean()
        print(
            f"  {name:22} heights {count / heights / 1e6:7.2f} M/s   "
            f"rays {count / rays / 1e6:7.3f} M/s, {hit:.0%} of them hit"
        )


def updates(terrain: tl.Terrain) -> None:
    """Print what replacing samples costs, against analysing everything."""
    anew = seconds(lambda: tl.Terrain(terrain.ground, device=terrain.device), rounds=3)
    ladder = seconds(
        lambda: tl.Terrain(terrain.ground, device=terrain.device)._with_ladder(), rounds=2
    )
    terrain._with_ladder()
    print(f"  made anew {anew * 1e3:.1f} ms, with its ladder {ladder * 1e3:.1f} ms")
    for side in (1, 30, 300):
        part = slice(100, 100 + side)
        heights = terrain.ground.elevation[part, part] + 1
        count = terrain.update(part, part, heights)
        once = seconds(lambda p=part, h=heights: terrain.update(p, p, h))
        print(f"  {side:4} x {side:<4} samples, {count:4} tiles {once * 1e3:8.2f} ms")


def main() -> None:
    """Run both."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=1025, help="along a side of the raster")
    parser.add_argument("--count", type=int, default=100_000, help="of queries a call")
    parser.add_argument("--device", help="part of a device's name, cpu or gpu")
    options = parser.parse_args()
    device = tl.Device.open(options.device)
    print(device.info)
    terrain = tl.Terrain(fractal(options.samples), device=device)
    print(f"{options.count:,} queries of {options.samples} x {options.samples} samples")
    queries(terrain, options.count)
    print("updates")
    updates(terrain)


if __name__ == "__main__":
    main()
