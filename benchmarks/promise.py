"""Promised error against what it costs: pydelatin beside us in one run, and the ladder's growth.

    python benchmarks/promise.py against [--ground ridge] [--samples 512] [--metres 1 5 30]
    python benchmarks/promise.py view [--samples 512]
    python benchmarks/promise.py ladder [--megapixels 1 4 16 64]
    python benchmarks/promise.py tree [--ground ridge] [--tiles 4 6 8] [--heights fitted]
    python benchmarks/promise.py heights [--ground ridge] [--metres 5 30]

`against`: from raster in host memory to mesh in host memory, ladder included; and triangles.
`view`: one pixel over a low flight against the one static mesh that keeps a pixel over all of it.
`ladder`: seconds a megapixel as the raster grows, of what odd factors are chosen from.
`tree`: triangles and time of patches of every size, beside the flat grid and pydelatin; vertices on
the ground, or floating.
`heights`: vertices that float beside those on the ground: triangles, time, shading, jumps.

Works are run in turn, and ratios taken within a round: noise meets all alike.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial
from statistics import median

import numpy as np

import terrain_lod as tl
from terrain_lod.camera.path import flyover
from terrain_lod.reports.compare.peers import PEERS
from terrain_lod.terrain.ladder import ladder_on_device

TILES = (4, 6, 8, 15)
DELATIN = next(peer for peer in PEERS if peer.name == "pydelatin")


def fractal(samples: int, roughness: float = 0.9) -> tl.Heightmap:
    """Return seeded rugged ground, 30 m a sample: its spectrum falls as wavelength^(1 + roughness).

    2,500 m of relief where there are 512 samples; a larger one is as rugged and goes on rising.

    Saupe: *Algorithms for random fractals*, in The Science of Fractal Images, 1988.
    """
    rng = np.random.default_rng(0)
    frequency = np.hypot(*np.meshgrid(np.fft.rfftfreq(samples), np.fft.fftfreq(samples)))
    frequency[0, 0] = 1.0
    noise = np.fft.rfft2(rng.normal(size=(samples, samples)))
    heights = np.fft.irfft2(noise * frequency ** -(1 + roughness), s=(samples, samples))
    low, high = heights.min(), heights.max()
    relief = 2500.0 * (samples / 512) ** roughness
    scaled = (heights - low) * (relief / (high - low))
    return tl.Heightmap(scaled, spacing=30.0, name=f"fractal {roughness:g}")


def ground_of(name: str, samples: int) -> tl.Heightmap:
    """Return a fractal, or a sample mirrored beyond its borders and cut to `samples` squared."""
    if name.startswith("fractal"):
        return fractal(samples, float(name.removeprefix("fractal") or 0.9))
    ground = tl.sample(name)
    over = [(0, max(samples - extent, 0)) for extent in ground.shape]
    heights = np.pad(ground.heights, over, mode="reflect")[:samples, :samples]
    return tl.Heightmap(heights, spacing=ground.spacing, base=ground.base, name=name)


def seconds_of(work: Callable[[], tl.Mesh]) -> tuple[float, tl.Mesh]:
    start = time.perf_counter()
    mesh = work()
    return time.perf_counter() - start, mesh


def from_nothing(ground: tl.Heightmap, tile: int, metres: float) -> tl.Mesh:
    return tl.Terrain(ground, tile=tile).mesh(lod=tl.MaxErrorLod(metres))


def against(
    name: str, samples: int, tolerances: list[float], tiles: list[int], rounds: int
) -> None:
    """Print time and triangles of every tile size as ratios to pydelatin's."""
    ground = ground_of(name, samples)
    print(f"{name}, {samples} x {samples} samples")
    for metres in tolerances:
        works: dict[str, Callable[[], tl.Mesh]] = {
            f"tiles of {tile}": partial(from_nothing, ground, tile, metres) for tile in tiles
        }
        for work in works.values():  # builds kernels
            work()
        works["pydelatin"] = partial(DELATIN.mesh, ground, metres)
        times: dict[str, list[float]] = {work: [] for work in works}
        meshes = {}
        for _ in range(rounds):
            for label, work in works.items():
                seconds, meshes[label] = seconds_of(work)
                times[label].append(seconds)
        base = times["pydelatin"]
        for label, found in times.items():
            faster = median(b / a for a, b in zip(found, base, strict=True))
            count = len(meshes[label].triangles)
            measured = tl.vertical_error(meshes[label], ground).maximum
            print(
                f"  {metres:5g} m  {label:12} {median(found) * 1e3:9.1f} ms {faster:7.2f} x as "
                f"fast {count:9,} triangles {count / len(meshes['pydelatin'].triangles):6.2f} x "
                f"measured {measured:.4g} m"
            )


def tree(
    name: str, samples: int, tolerances: list[float], tiles: list[int], heights: str
) -> list[float]:
    """Print triangles of patches of every size and of the flat grid: shares of pydelatin's."""
    ground, best = ground_of(name, samples), []
    for metres in tolerances:
        base = len(DELATIN.mesh(ground, metres).triangles)
        found = []
        for tile in tiles:
            terrain, flat = tl.Terrain(ground, tile=tile), tl.Terrain(ground, tile=tile, levels=1)
            lod = tl.MaxErrorLod(metres)
            other = flat.mesh(lod=lod)
            work = partial(terrain.mesh, lod=lod, heights=heights)
            mesh, (seconds, _) = work(), seconds_of(work)
            assert mesh.achieved
            worst = tl.vertical_error(mesh, ground).maximum / metres
            share = len(mesh.triangles) / base
            found.append(share)
            print(
                f"{name} {metres:3g} m, tiles of {tile}: {share:.2f} x pydelatin's {base:,}, flat "
                f"grid {len(other.triangles) / base:.2f} x; worst {worst:.4f} of what was asked, "
                f"{mesh.achieved.rounds} rounds, again in {1e3 * seconds:.0f} ms",
                flush=True,
            )
        best.append(found[0])
    return best


def heights(name: str, samples: int, tolerances: list[float], tile: int, views: int) -> None:
    """Print what floating vertices cost and save: triangles, time, shading, jumps of a flight."""
    ground = ground_of(name, samples)
    terrain, cameras = tl.Terrain(ground, tile=tile), flyover(ground, 10 * views, fov=55)[:views]
    pixel = tl.ScreenErrorLod(1.0)
    for each in ("ground", "fitted"):
        for metres in tolerances:
            lod = tl.MaxErrorLod(metres)
            work = partial(terrain.mesh, lod=lod, heights=each)
            mesh, (seconds, _) = work(), seconds_of(work)
            steepest, rms = tl.normal_error(mesh, ground)
            print(
                f"{name} {metres:3g} m, {each}: {len(mesh.triangles):,} triangles in "
                f"{1e3 * seconds:.0f} ms, normals {rms:.1f} degrees off the ground's RMS, "
                f"{steepest:.0f} at most"
            )
        made = [seconds_of(partial(terrain.mesh, at, lod=pixel, heights=each)) for at in cameras]
        meshes = [mesh for _, mesh in made]
        pops = tl.pop_metric(meshes, ground, cameras)
        print(
            f"{name} 1 pixel, {each}: {median(len(mesh.triangles) for mesh in meshes):,.0f} "
            f"triangles in {1e3 * median(seconds for seconds, _ in made):.0f} ms, jumps of "
            f"{pops.maximum:.2f} pixels at most, {pops.rms:.3f} RMS",
            flush=True,
        )


def view(name: str, samples: int, tiles: list[int], views: int) -> None:
    """Print triangles and pictures a second of a low flight, and the static mesh it stands for."""
    ground = ground_of(name, samples)
    cameras = flyover(ground, views, fov=55)
    static, metres = _static_mesh(ground, cameras)
    print(f"{name}, {samples} x {samples}: pydelatin keeps a pixel with {metres:.3g} m,", end=" ")
    print(f"{len(static.triangles):,} triangles")
    for tile in tiles:
        terrain = tl.Terrain(ground, tile=tile)
        lod = tl.ScreenErrorLod(1.0)
        terrain.mesh(cameras[0], lod=lod)
        made = [seconds_of(partial(terrain.mesh, camera, lod=lod)) for camera in cameras]
        worst = max(
            tl.screen_error(m, ground, c).maximum for (_, m), c in zip(made, cameras, strict=True)
        )
        counts = [len(mesh.triangles) for _, mesh in made]
        stages = median(sum(mesh.timings.values()) for _, mesh in made)
        print(
            f"  tiles of {tile:2}: {median(counts):9,.0f} triangles ({max(counts):,} at most), "
            f"{median(counts) / len(static.triangles):.2f} x, {1 / stages:6.1f} a second on the "
            f"device, {1 / median(s for s, _ in made):6.1f} with the mesh in host memory, "
            f"{worst:.3f} pixels"
        )


def _static_mesh(ground: tl.Heightmap, cameras: tuple[tl.Camera, ...]) -> tuple[tl.Mesh, float]:
    """Return the coarsest of pydelatin's meshes that keeps a pixel, to 10 % of its tolerance."""
    low, high = 1e-3, 100.0
    best = DELATIN.mesh(ground, low)
    while high / low > 1.1:
        middle = float(np.sqrt(low * high))
        mesh = DELATIN.mesh(ground, middle)
        if max(tl.screen_error(mesh, ground, camera).maximum for camera in cameras) <= 1.0:
            best, low = mesh, middle
        else:
            high = middle
    return best, low


def ladder(megapixels: list[int], tiles: list[int], rounds: int) -> None:
    """Print what the ladder costs a megapixel; smallest and largest raster in turn."""
    device = tl.Device.open()
    for tile in tiles:
        works = {}
        for size in megapixels:
            samples = int(1024 * np.sqrt(size))
            heights = np.random.default_rng(0).random((samples, samples), np.float32)
            terrain = tl.Terrain(tl.Heightmap(heights), tile=tile, device=device)
            parts = terrain._tiles.ground, terrain._tiles.analysis
            works[size] = partial(ladder_on_device, *parts)
            works[size]()
        device.finish()
        times: dict[int, list[float]] = {size: [] for size in works}
        for _ in range(rounds):
            for size, work in works.items():
                start = time.perf_counter()
                work()
                device.finish()
                times[size].append((time.perf_counter() - start) / size)
        costs = {size: median(found) for size, found in times.items()}
        each = ", ".join(f"{size}: {1e3 * cost:.1f}" for size, cost in costs.items())
        spread = max(costs.values()) / min(costs.values())
        print(f"ladder, tiles of {tile}: ms a megapixel {each}; {spread:.2f} x apart", flush=True)


def main() -> None:
    """Run the chosen part."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=("against", "view", "ladder", "tree", "heights"))
    parser.add_argument("--ground", nargs="+", default=["ridge"])
    parser.add_argument("--samples", type=int, default=512)
    parser.add_argument("--metres", type=float, nargs="+", default=[1.0, 5.0, 30.0])
    parser.add_argument("--megapixels", type=int, nargs="+", default=[1, 4, 16, 64])
    parser.add_argument("--tiles", type=int, nargs="+", default=list(TILES))
    parser.add_argument("--heights", choices=("ground", "fitted"), default="ground")
    parser.add_argument("--views", type=int, default=12)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    if options.part == "ladder":
        ladder(options.megapixels, options.tiles, options.rounds)
        return
    if options.part == "tree":
        shares = [
            share
            for name in options.ground
            for share in tree(name, options.samples, options.metres, options.tiles, options.heights)
        ]
        mean = float(np.exp(np.mean(np.log(shares))))
        print(
            f"tiles of {options.tiles[0]}, {options.heights} heights: {mean:.3f} x pydelatin's, "
            "the geometric mean"
        )
        return
    for name in options.ground:
        if options.part == "heights":
            heights(name, options.samples, options.metres, options.tiles[0], options.views)
        elif options.part == "against":
            against(name, options.samples, options.metres, options.tiles, options.rounds)
        else:
            view(name, options.samples, options.tiles, options.views)


if __name__ == "__main__":
    main()
