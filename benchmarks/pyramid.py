"""Ground larger than memory: what building a pyramid takes, and what flying over it holds.

    python benchmarks/pyramid.py build --largest 0.4        # of 0.1, 0.4 and 1.6 gigasamples
    python benchmarks/pyramid.py killed --times 50
    python benchmarks/pyramid.py flight --side 10000 --frames 50
    python benchmarks/pyramid.py virtual --side 100000 --regions 4

Heights come from a function, so that ground of any size is there without being stored. Everything
is written into --folder, and removed at the end.
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import terrain_lod as tl
from terrain_lod.pyramid.build import worker_bytes
from terrain_lod.pyramid.division import Division
from terrain_lod.pyramid.region import Region, into_chunks

SPACING = 30.0
STEP = 1 / 16
WAVES = 40


class Waves:
    """Hills of all sizes as an array that is worked out where it is read."""

    def __init__(self, rows: int, columns: int) -> None:
        self.shape, self.dtype = (rows, columns), np.dtype(np.float32)
        chance = np.random.default_rng(7)
        # from 20,000 samples long down to 6, as high as they are long, or nearly
        self.lengths = np.geomspace(20_000, 6, WAVES)
        self.heights = 0.01 * SPACING * self.lengths**0.9
        self.ways, self.shifts = chance.uniform(0, 2 * np.pi, (2, WAVES))

    def __getitem__(self, part: tuple[slice, slice]) -> npt.NDArray[np.float32]:
        down, across = (
            (
                np.arange(*piece.indices(extent))[:, None]
                * turn(self.ways)
                * 2
                * np.pi
                / self.lengths
            )
            for piece, extent, turn in zip(part, self.shape, (np.sin, np.cos), strict=True)
        )
        down += self.shifts
        # sin(a + b), for all rows and columns at once
        heights: npt.NDArray[np.float32] = (np.sin(down) * self.heights).astype(
            np.float32
        ) @ np.cos(across).T.astype(np.float32) + (np.cos(down) * self.heights).astype(
            np.float32
        ) @ np.sin(across).T.astype(np.float32)
        # as data have it: no codec could pack what is noise below that
        np.round(heights / STEP, out=heights)
        heights *= STEP
        return heights


def write_tiff(path: Path, side: int) -> None:
    import rasterio

    waves = Waves(side, side)
    profile = {"driver": "GTiff", "width": side, "height": side, "count": 1, "dtype": "float32",
               "tiled": True, "blockxsize": 512, "blockysize": 512, "crs": "EPSG:25832",
               "BIGTIFF": "YES",
               "transform": rasterio.Affine(SPACING, 0, 0, 0, -SPACING, 0)}  # fmt: skip
    with rasterio.open(path, "w", **profile) as file:
        for row in range(0, side, 2048):
            rows = slice(row, min(row + 2048, side))
            file.write(waves[rows, :], 1, window=((rows.start, rows.stop), (0, side)))


def read_once(path: Path) -> float:
    """Return the seconds of CPU that reading a raster through rasterio takes, by rows of blocks."""
    import rasterio

    began = time.process_time()
    with rasterio.open(path) as file:
        for row in range(0, file.height, 512):
            file.read(1, window=((row, min(row + 512, file.height)), (0, file.width)))
    return time.process_time() - began


def child(*arguments: str) -> dict[str, float]:
    """Run a part of this script in a process of its own, and return what it prints."""
    command = [sys.executable, __file__, *arguments]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return {name: float(value) for name, value in (line.split("=") for line in text.split())}


def measured_build(source: str, store: str) -> None:
    """Print seconds, those of CPU too, and peak memory of a build in this process alone."""
    began, cpu = time.perf_counter(), time.process_time()
    tl.build(source, store)
    seconds, cpu = time.perf_counter() - began, time.process_time() - cpu
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    print(f"seconds={seconds} cpu={cpu} peak={peak}")


def errors_seconds(side: int) -> float:
    """Return the seconds of CPU that measuring all errors of a raster takes, by its largest region.

    Regions are alike, and all work is done in this process alone.
    """
    division = Division(side, side)
    heights = Waves(side, side)[division.region_slices(0, 0)]
    began = time.process_time()
    Region(division, heights).nodes()
    return (time.process_time() - began) * side**2 / heights.size


def build(folder: Path, largest: float) -> None:
    print("gigasamples | rasterio reads | errors alone | build | on the clock | "
          "CPU s a gigasample | build / (read + errors) | peak | said before | "
          "bytes a sample")  # fmt: skip
    for giga in (0.1, 0.4, 1.6):
        if giga > largest:
            break
        side = int(np.sqrt(giga * 1e9))
        source, store = folder / "waves.tif", folder / "waves.tlod"
        write_tiff(source, side)
        read, errors = read_once(source), errors_seconds(side)
        found = child("measured", str(source), str(store))
        read = (read + read_once(source)) / 2
        size = sum(file.stat().st_size for file in store.rglob("*") if file.is_file())
        giga, cpu = side**2 / 1e9, found["cpu"]
        print(
            f"{giga:.2f} | {read:.1f} s | {errors:.1f} s | {cpu:.1f} s | {found['seconds']:.0f} s "
            f"| {cpu / giga:.0f} | {cpu / (read + errors):.2f} | {found['peak'] / 1e9:.2f} GB "
            f"| {worker_bytes(Division(side, side)) / 1e9:.2f} GB | {size / side**2:.2f}",
            flush=True,
        )
        source.unlink()
        shutil.rmtree(store)


def contents(store: Path) -> dict[str, bytes]:
    return {str(f.relative_to(store)): f.read_bytes() for f in store.rglob("*") if f.is_file()}


def killed(folder: Path, times: int) -> None:
    """Kill builds at random moments, and compare what comes of going on."""
    source, whole, store = (folder / name for name in ("waves.npy", "whole.tlod", "waves.tlod"))
    np.save(source, Waves(1500, 1900)[:, :])
    command = [sys.executable, __file__, "small", str(source)]
    began = time.perf_counter()
    subprocess.run([*command, str(whole)], check=True)
    seconds, expected = time.perf_counter() - began, contents(whole)
    deaths = wrong = 0
    while deaths < times:
        process = subprocess.Popen([*command, str(store)])
        time.sleep(random.uniform(0.3, 1.0) * seconds)
        process.send_signal(signal.SIGKILL)
        deaths += process.wait() == -signal.SIGKILL
        for name, content in contents(store).items() if store.exists() else ():
            torn = content != expected.get(name) and name != "zarr.json"
            wrong += torn and not name.endswith(".partial")
        if store.exists() and random.random() < 0.3:
            # go on to the end, and begin anew
            subprocess.run([*command, str(store)], check=True)
            wrong += contents(store) != expected
            shutil.rmtree(store)
    if store.exists():
        subprocess.run([*command, str(store)], check=True)
        wrong += contents(store) != expected
    print(f"{deaths} builds killed, {wrong} files or stores that differ from one never killed")


def flight(folder: Path, side: int, frames: int, memory: str) -> None:
    """Fly low over a pyramid, and over a cut of it in memory."""
    waves, store = Waves(side, side), folder / "waves.tlod"
    tl.build(waves, store, spacing=SPACING)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    terrain = tl.open(store, memory=memory)
    low, high = terrain.height_range
    lod, extent = tl.ScreenErrorLod(1.0), (side - 1) * SPACING
    kept = cracks = 0
    cold, warm, worst, triangles, held = [], [], 0.0, [], 0
    for frame in range(frames):
        x = extent * (0.2 + 0.3 * frame / frames)
        ground = float(terrain.height_at([[x, -extent / 2]])[0])
        eye = x, -extent / 2, ground + 300
        camera = tl.Camera(eye, (x + 3000, -extent / 2 + 1500, ground))
        for times in (cold, warm):
            began = time.perf_counter()
            mesh = terrain.mesh(camera, lod=lod)
            times.append(time.perf_counter() - began)
        kept += mesh.achieved.kept
        held = max(held, terrain.held)
        triangles.append(len(mesh.triangles))
        if frame % 5 == 0:
            cracks += tl.crack_report(mesh).cracks
            worst = max(worst, outside(mesh, waves, camera, x))
    print(f"{side:,}² samples, {frames} frames at one pixel, 1920 x 1080, memory {memory}")
    print(f"kept {kept} of {frames}; measured outside on every fifth: {worst:.3f} pixels, "
          f"{cracks} cracked edges")  # fmt: skip
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(f"ground held at most {held / 1e6:.0f} MB; the process grew by "
          f"{(peak - before) / 1e3:.0f} MB, meshes and device included")  # fmt: skip
    print(f"new frame {np.median(cold):.2f} s, the same again {np.median(warm):.2f} s, "
          f"{int(np.median(triangles)):,} triangles (medians)")  # fmt: skip
    cut = min(side, 4097)
    first = int(x / SPACING - cut / 2), int(extent / 2 / SPACING - cut / 2)
    heights = waves[first[1] : first[1] + cut, first[0] : first[0] + cut]
    place = (first[0] * SPACING, -first[1] * SPACING)
    whole = tl.Terrain(tl.Heightmap(heights, spacing=SPACING, origin=place), tile=8)
    whole.mesh(camera, lod=lod, partitioning="integer")
    began = time.perf_counter()
    there = whole.mesh(camera, lod=lod, partitioning="integer")
    print(f"in memory, {cut}² samples of it, the same again {time.perf_counter() - began:.2f} s, "
          f"{len(there.triangles):,} triangles")  # fmt: skip
    print(f"heights {low:.0f} to {high:.0f} m")


def outside(mesh: tl.Mesh, waves: Waves, camera: tl.Camera, x: float) -> float:
    """Return the largest error in pixels in a window of the source around the eye."""
    size = 1500
    column = int(np.clip(x / SPACING, 0, waves.shape[1] - size))
    row = int(np.clip(-camera.eye[1] / SPACING - size / 2, 0, waves.shape[0] - size))
    window = waves[row : row + size, column : column + size]
    ground = tl.Heightmap(window, spacing=SPACING, origin=(column * SPACING, -row * SPACING))
    return tl.screen_error(mesh, ground, camera).maximum


def virtual(folder: Path, side: int, regions: int) -> None:
    """Build a sample of the regions of a raster that is stored nowhere, and reckon the whole."""
    division, waves = Division(side, side), Waves(side, side)
    count = division.regions[0] * division.regions[1]
    times: dict[str, list[float]] = {"heights": [], "errors": [], "chunks": []}
    for place in random.Random(3).sample(list(np.ndindex(division.regions)), regions):
        began = time.perf_counter()
        heights = waves[division.region_slices(*place)]
        read = time.perf_counter()
        region = Region(division, heights)
        region.nodes()
        judged = time.perf_counter()
        for level in division.fine:
            into_chunks(region.lattice(level), division.chunk)
        for name, seconds in zip(
            times, (read - began, judged - read, time.perf_counter() - judged), strict=True
        ):
            times[name].append(seconds)
    print(f"{side:,}² = {side**2 / 1e9:.1f} gigasamples, {count} regions, "
          f"{len(division.levels)} levels; {regions} regions sampled")  # fmt: skip
    for name, seconds in times.items():
        print(f"  {name}: {np.mean(seconds):.2f} s a region, {np.mean(seconds) * count / 3600:.2f} "
              "hours of one worker for all")  # fmt: skip
    print(f"  a worker takes at most {worker_bytes(division) / 1e9:.2f} GB")


def main() -> None:
    # parts of this script that it runs in processes of their own
    if sys.argv[1:2] == ["measured"]:
        return measured_build(*sys.argv[2:])
    if sys.argv[1:2] == ["small"]:
        tl.build(np.load(sys.argv[2], mmap_mode="r"), sys.argv[3], chunk=64, spacing=SPACING)
        return None
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("build", "killed", "flight", "virtual"))
    parser.add_argument("--folder", type=Path, default=Path("out/pyramid"))
    parser.add_argument("--largest", type=float, default=0.4, help="gigasamples")
    parser.add_argument("--times", type=int, default=50)
    parser.add_argument("--side", type=int, default=10_000, help="samples")
    parser.add_argument("--frames", type=int, default=50)
    parser.add_argument("--memory", default="512MB")
    parser.add_argument("--regions", type=int, default=4)
    given = parser.parse_args()
    folder = given.folder / str(os.getpid())
    folder.mkdir(parents=True)
    runs: dict[str, Any] = {
        "build": lambda: build(folder, given.largest),
        "killed": lambda: killed(folder, given.times),
        "flight": lambda: flight(folder, given.side, given.frames, given.memory),
        "virtual": lambda: virtual(folder, given.side, given.regions),
    }
    try:
        return runs[given.what]()
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
