"""Speed of the stages: analysis against a bare read, a million triangles against a bare copy, and
what detail costs and saves beside the same ground stored whole.

    python benchmarks/terrain.py [--samples 4096]

Prints device times, medians of interleaved rounds, and ratios within the run.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from statistics import median

import numpy as np

import terrain_lod as tl
from measure import bare_copy, bare_read, interleaved, ratio, share_of_stated, wall_seconds
from terrain_lod.ground.grid import TileGrid
from terrain_lod.terrain.analysis import analyse_on_device
from terrain_lod.terrain.domain import displace_on_device
from terrain_lod.terrain.hull import hull_on_device
from terrain_lod.terrain.ladder import ladder_on_device
from terrain_lod.terrain.meshing import Tessellated


def fractal(samples: int) -> tl.Heightmap:
    """Return seeded ground with detail at all scales."""
    rng = np.random.default_rng(0)
    steps = rng.normal(size=(samples, samples)).astype(np.float32)
    return tl.Heightmap(steps.cumsum(axis=0).cumsum(axis=1), spacing=30.0)


def analysis(samples: int, device: tl.Device) -> None:
    """Print what analysing costs, in bare reads of the raster."""
    terrain = tl.Terrain(fractal(samples), device=device)
    ground = terrain._tiles.ground
    works: dict[str, Callable[[], object]] = {"bare read": bare_read(device, ground.heights)}
    for tile in (7, 15, 31, 63):
        cut = replace(ground, grid=TileGrid.of(terrain.ground, tile))
        works[f"tiles of {tile}"] = partial(analyse_on_device, cut)
    times = interleaved(device, works)
    print(f"analysis of {samples} x {samples} samples, {ground.heights.nbytes / 2**20:.0f} MiB")
    for name, seconds in times.items():
        speed = ground.heights.nbytes / median(seconds)
        wall, share = wall_seconds(device, works[name]), 100 / ratio(times, name, "bare read")
        print(
            f"  {name:12} {median(seconds) * 1e3:8.3f} ms, {wall * 1e3:8.3f} from call to result, "
            f"{speed / 1e9:8.1f} GB/s, {share:4.0f} % of a bare read, "
            f"{share_of_stated(device, speed)}"
        )


def million_triangles(samples: int, device: tl.Device) -> None:
    """Print what hull, tessellator and domain stage cost for a million triangles."""
    terrain = tl.Terrain(fractal(samples), levels=1, device=device)
    x, y, z = terrain.ground.centre
    camera = tl.Camera((x, y, z + 3000), (x + 2000, y - 2000, z), fov=60)
    lod = tl.DistanceLod(maximum=maximum_for_a_million(terrain, camera))
    tiles = terrain._tiles
    hull = partial(hull_on_device, tiles, lod, camera, cull=False)
    factors = hull()
    patches = tiles.patch_set
    tessellate = partial(Tessellated.of, patches, factors, "fractional_odd")
    pattern = tessellate().pattern
    points, triangles = pattern.points.shape[0], pattern.primitives.shape[0]
    # positions and normals, and the triangles' indices
    nbytes = points * 24 + triangles * 12
    stages = {
        "hull": hull,
        "tessellate": tessellate,
        "displace": partial(displace_on_device, patches, pattern),
    }
    times = interleaved(device, {**stages, "bare copy": bare_copy(device, nbytes)})
    times["in all"] = [sum(round_) for round_ in zip(*(times[s] for s in stages), strict=True)]
    print(f"{triangles:,} triangles, {points:,} vertices, {nbytes / 2**20:.0f} MiB")
    for name, seconds in times.items():
        print(
            f"  {name:12} {median(seconds) * 1e3:8.2f} ms "
            f"{ratio(times, name, 'bare copy'):8.2f} x bare copy"
        )


def maximum_for_a_million(terrain: tl.Terrain, camera: tl.Camera) -> float:
    """Return the highest factor of a distance LOD that makes about a million triangles."""
    low, high = 1.0, 15.0
    for _ in range(12):
        middle = (low + high) / 2
        lod = tl.DistanceLod(maximum=middle)
        factors = hull_on_device(terrain._tiles, lod, camera, cull=False)
        count = Tessellated.of(terrain._tiles.patch_set, factors, "fractional_odd").triangle_count
        low, high = (middle, high) if count < 1_000_000 else (low, middle)
    return high


def with_detail(samples: int, steps: int, device: tl.Device) -> None:
    """Print what ground costs that is found where it is read, beside the same in one piece."""
    ground = fractal(samples)
    heights = np.random.default_rng(1).normal(size=(128, 128)).astype(np.float32)
    small = tl.Heightmap(heights, spacing=30.0 / steps)
    stored = ground.with_detail(small)
    x, y, _ = ground.centre
    eye = tl.Terrain(ground, device=device).height_at([(x, y)])[0] + 300
    camera = tl.Camera((x, y, eye), (x + 900, y + 900, eye - 200), fov=60)
    terrains = {}
    for name, make in (
        ("detail", lambda: tl.Terrain(ground, detail=small, device=device)),
        ("one piece", lambda: tl.Terrain(stored, device=device)),
    ):
        before = device.allocated
        terrains[name] = make()
        print(f"{name}: {(device.allocated - before) / 2**20:.1f} MiB on the device")
    works = {}
    for name, terrain in terrains.items():
        tiles = terrain._tiles
        factors = hull_on_device(tiles, tl.UniformLod(5.0), None, cull=False)
        whole = Tessellated.of(tiles.patch_set, factors, "fractional_odd").pattern
        works |= {
            f"analyse, {name}": partial(analyse_on_device, tiles.ground),
            f"ladder, {name}": partial(ladder_on_device, tiles.ground, tiles.analysis),
            f"displace, {name}": partial(displace_on_device, tiles.patch_set, whole),
            f"mesh, {name}": partial(terrain.mesh, camera, lod=tl.ScreenErrorLod(2.0)),
        }
    times = interleaved(device, works, repeats=5)
    rows, columns = stored.shape
    print(f"{rows} x {columns} samples, {steps} x {steps} a cell")
    for work in ("analyse", "ladder", "displace", "mesh"):
        one, other = f"{work}, detail", f"{work}, one piece"
        print(
            f"  {work:12} {median(times[one]) * 1e3:8.2f} ms with detail, "
            f"{ratio(times, one, other):5.2f} x in one piece"
        )


def main() -> None:
    """Run all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=4096, help="along a side of the raster")
    parser.add_argument("--only", choices=["analysis"], help="stop after this")
    parser.add_argument("--device", help="part of a device's name, cpu or gpu")
    options = parser.parse_args()
    device = tl.Device.open(options.device)
    print(device.info)
    analysis(options.samples, device)
    if options.only == "analysis":
        return
    million_triangles(min(options.samples, 2049), device)
    with_detail(min(options.samples, 512), 8, device)


if __name__ == "__main__":
    main()
