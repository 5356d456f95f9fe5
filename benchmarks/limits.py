"""What speed is promised to reach: of this checkout, and of another beside it.

    python benchmarks/limits.py [--against PATH] [--only first million] [--rounds 5]

A row of the table is measured in a process of its own, of each checkout in turn, so that noise
meets both alike. Prints medians of the rounds, the goal, and how many times as much the other has
(the median of ratios within a round). The first round builds kernels and is not counted.

    first       seconds of a new process: import, ground, device, Terrain, mesh of 512 x 512
    million     hull, tessellator and domain stage of a million triangles, in copies of their bytes
    tessellate  30,000 quads of random factors, in copies of their bytes
    ladder 15   milliseconds of a megapixel's errors at odd factors, in tiles of 15; and of 7
    frame       milliseconds from a camera to a mesh of ridge in host memory, one pixel, tiles of 7
    full mesh   milliseconds from ground to 2.1 million triangles in host memory
    analysis    4,096 x 4,096 samples in tiles of 15, in bare reads

A copy is of memory in use. First calls and frames are wall time, the others the device's own.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Final, NamedTuple

HERE: Final = Path(__file__).resolve().parent


class Row(NamedTuple):
    """What is measured, in which unit, and what a CPU of two cores has to reach."""

    measure: Callable[[], float]
    unit: str
    goal: str


def imported() -> float:
    """Return the seconds that the import takes, nothing else being imported yet."""
    start = perf_counter()
    import terrain_lod  # noqa: F401

    return perf_counter() - start


def first_call() -> float:
    """Return the seconds to a first mesh, of a process that has imported nothing yet."""
    start = perf_counter()
    import numpy as np

    import terrain_lod as tl

    rows, columns = np.indices((512, 512), np.float32)
    tl.Terrain(tl.Heightmap(np.sin(rows / 20) * columns, spacing=1.0)).mesh()
    return perf_counter() - start


def million() -> float:
    """Return the device time of a million triangles, in copies."""
    import terrain_lod as tl
    from measure import bare_copy, interleaved, ratio
    from terrain import fractal, maximum_for_a_million
    from terrain_lod.terrain.domain import displace_on_device
    from terrain_lod.terrain.hull import hull_on_device
    from terrain_lod.terrain.meshing import Tessellated

    device = tl.Device.open()
    terrain = tl.Terrain(fractal(2049), levels=1, device=device)
    tiles, (x, y, z) = terrain._tiles, terrain.ground.centre
    camera = tl.Camera((x, y, z + 3000), (x + 2000, y - 2000, z), fov=60)
    lod = tl.DistanceLod(maximum=maximum_for_a_million(terrain, camera))

    def made() -> Tessellated:
        factors = hull_on_device(tiles, lod, camera, cull=False)
        made = Tessellated.of(tiles.patch_set, factors, "fractional_odd")
        displace_on_device(made.patches, made.pattern)
        return made

    pattern = made().pattern
    nbytes = 24 * pattern.points.shape[0] + 12 * pattern.primitives.shape[0]
    times = interleaved(device, {"million": made, "copy": bare_copy(device, nbytes)})
    return ratio(times, "million", "copy")


def tessellator() -> float:
    """Return the device time of many quads, in copies."""
    import numpy as np

    import terrain_lod as tl
    from measure import bare_copy, interleaved, ratio
    from terrain_lod.tessellation.tessellator import tessellate_device

    device, rng = tl.Device.open(), np.random.default_rng(0)
    edges, insides = (rng.uniform(1, 15, (30_000, n)).astype(np.float32) for n in (4, 2))
    work = partial(
        tessellate_device,
        *("quad", device.array(edges), device.array(insides), "fractional_odd"),
        clockwise=True,
    )
    pattern = work()
    nbytes = 8 * pattern.points.shape[0] + 12 * pattern.primitives.shape[0]
    times = interleaved(device, {"work": work, "copy": bare_copy(device, nbytes)})
    return ratio(times, "work", "copy")


def ladder(tile: int) -> float:
    """Return the milliseconds of device time that a megapixel's ladder takes."""
    import terrain_lod as tl
    from measure import interleaved
    from terrain import fractal
    from terrain_lod.terrain.ladder import ladder_on_device

    device = tl.Device.open()
    tiles = tl.Terrain(fractal(1024), tile=tile, levels=1, device=device)._tiles
    work = partial(ladder_on_device, tiles.ground, tiles.analysis)
    return 1e3 * median(interleaved(device, {"work": work}, repeats=7)["work"])


def frame() -> float:
    """Return the milliseconds that a frame takes with its mesh in host memory."""
    import terrain_lod as tl
    from measure import wall_seconds

    ground = tl.sample("ridge")
    terrain = tl.Terrain(ground, tile=7)
    camera = tl.default_camera(ground)
    work = partial(terrain.mesh, camera, lod=tl.ScreenErrorLod(1.0))
    work()
    return 1e3 * wall_seconds(terrain.device, work)


def full_mesh() -> float:
    """Return the milliseconds that 2.1 million triangles take to host memory."""
    import terrain_lod as tl
    from measure import wall_seconds
    from terrain import fractal

    terrain = tl.Terrain(fractal(1025))
    terrain.mesh()
    return 1e3 * wall_seconds(terrain.device, terrain.mesh, repeats=5)


def analysis() -> float:
    """Return the device time of an analysis, in bare reads."""
    import terrain_lod as tl
    from measure import bare_read, interleaved, ratio
    from terrain import fractal
    from terrain_lod.terrain.analysis import analyse_on_device

    device = tl.Device.open()
    ground = tl.Terrain(fractal(4096), tile=15, levels=1, device=device)._tiles.ground
    works = {
        "work": partial(analyse_on_device, ground),
        "read": bare_read(device, ground.heights),
    }
    return ratio(interleaved(device, works, repeats=7), "work", "read")


ROWS: Final = {
    "import": Row(imported, "s", "0.25"),
    "first": Row(first_call, "s", "1.0"),
    "million": Row(million, "copies", "4"),
    "tessellate": Row(tessellator, "copies", ""),
    "ladder 15": Row(partial(ladder, 15), "ms", "8"),
    "ladder 7": Row(partial(ladder, 7), "ms", "5"),
    "frame": Row(frame, "ms", ""),
    "full mesh": Row(full_mesh, "ms", ""),
    "analysis": Row(analysis, "reads", "1.3"),
}


def package_of(checkout: Path, folder: Path) -> Path:
    """Lay out a checkout's package as an installed one in `folder`, by links, and return it."""
    package = folder / "terrain_lod"
    package.mkdir(parents=True)
    for path in (checkout / "terrain_lod").iterdir():
        if path.name != "__pycache__":
            (package / path.name).symlink_to(path)
    for name in ("kernels", "heightmaps"):
        if not (package / name).exists():
            (package / name).symlink_to(checkout / name)
    return folder


def measured(row: str, package: Path, cache: Path) -> float | None:
    """Return what a process of its own measures of a package; None where it cannot."""
    environment = {**os.environ, "PYTHONPATH": str(package), "POCL_CACHE_DIR": str(cache)}
    # as users have it: what is imported a second time is not compiled again
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    environment["PYTHONPYCACHEPREFIX"] = str(cache / "bytecode")
    command = [sys.executable, __file__, "--row", row]
    child = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if child.returncode:
        print(f"{row}: {child.stderr.strip().splitlines()[-1]}", file=sys.stderr)
        return None
    return float(json.loads(child.stdout.splitlines()[-1]))


def table(checkouts: dict[str, Path], rows: list[str], rounds: int) -> None:
    """Measure and print, a line a row."""
    print(f"{'':12}{''.join(f'{name:>12}' for name in checkouts)}{'goal':>8}")
    with tempfile.TemporaryDirectory() as scratch:
        packages = {
            name: package_of(path, Path(scratch) / name) for name, path in checkouts.items()
        }
        caches = {name: Path(scratch) / f"{name} kernels" for name in checkouts}
        for row in rows:
            found: dict[str, list[float]] = {name: [] for name in checkouts}
            for counted in range(-1, rounds):
                values = {
                    name: measured(row, package, caches[name]) for name, package in packages.items()
                }
                for name, value in values.items():
                    if counted >= 0 and value is not None:
                        found[name].append(value)
            line = "".join(
                f"{median(values):12.3g}" if values else f"{'-':>12}" for values in found.values()
            )
            _, unit, goal = ROWS[row]
            pairs = [of for of in zip(*found.values(), strict=False) if len(of) == 2]
            times = f"   {median(old / new for old, new in pairs):.2f} x" if pairs else ""
            print(f"{row:12}{line}{goal:>8} {unit}{times}", flush=True)


def main() -> None:
    """Print the table, or measure one row of it."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--against", type=Path, help="folder of another checkout")
    parser.add_argument("--only", nargs="+", choices=list(ROWS), default=list(ROWS))
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--row", choices=list(ROWS), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.row:
        print(json.dumps(ROWS[options.row].measure()))
        return
    checkouts = {} if options.against is None else {"other": options.against.resolve()}
    for path in checkouts.values():
        if not (path / "terrain_lod").is_dir():
            parser.error(f"expected a checkout with a folder terrain_lod, got {path}")
    table({**checkouts, "this": HERE.parent}, options.only, options.rounds)


if __name__ == "__main__":
    main()
