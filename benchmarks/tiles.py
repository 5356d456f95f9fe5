"""Tiles of quantized-mesh beside a loop of pydelatin and quantized-mesh-encoder, in one run.

    python benchmarks/tiles.py [--ground fractal jacksboro] [--samples 1024] [--metres 1 5 30]

Both make the tiles of the deepest level, from the ground in memory to files, normals included, and
take turns tile by tile: ratios are those of the sums. The loop takes the same lattice of 257 x 257
heights a tile as we do and asks pydelatin for an error on it. Errors are measured at the samples,
on the Earth, for both. What holds on the lattice does not hold at the samples: so the loop is timed
twice, asked for the same error, and asked for the first of a half, a quarter, ... of it with which
it keeps that error at the samples (the time of that one alone counts). Where even a sixteenth does
not, that is what is compared.

    pip install pydelatin quantized-mesh-encoder
"""

from __future__ import annotations

import argparse
import gzip
import resource
import tempfile
import time
from pathlib import Path

import numpy as np
from promise import ground_of
from pydelatin import Delatin
from quantized_mesh_encoder import VertexNormalsExtension, encode
from quantized_mesh_encoder.constants import WGS84

import terrain_lod as tl
from terrain_lod.tilesets.globe import write_globe_tile
from terrain_lod.tilesets.job import Job
from terrain_lod.tilesets.levels import CELLS, Level, reach
from terrain_lod.tilesets.quantized_mesh import MOST, smallest_quantum
from terrain_lod.tilesets.residuals import Surface
from terrain_lod.tilesets.schemes import Geographic, bounds_of, lines
from terrain_lod.tilesets.source import Source

DEGREE = 111_320.0


def placed(name: str, samples: int) -> tl.Heightmap:
    """Return ground on the equator, a sample each 30 m, in degrees."""
    ground = ground_of(name, samples)
    return tl.Heightmap(
        ground.elevation, spacing=30.0 / DEGREE, origin=(10.0, 0.3), crs="EPSG:4326", name=name
    )


def by_the_loop(job: Job, tile: tuple[int, int, int], metres: float) -> tuple[int, float]:
    """Write a tile with pydelatin and quantized-mesh-encoder; return triangles and error."""
    longitudes, latitudes = lines(job.scheme, tile, CELLS)
    far = reach(job.source, job.scheme, tile[0])
    heights = job.source.heights(*np.meshgrid(longitudes, latitudes), far)
    made = Delatin(np.nan_to_num(heights).astype(np.float32), max_error=metres)
    column, row = made.vertices[:, 0], CELLS - made.vertices[:, 1]
    west, south, east, north = bounds_of(job.scheme, tile)
    places = np.stack([column, row], axis=1) / CELLS
    positions = np.stack(
        [
            west + places[:, 0] * (east - west),
            south + places[:, 1] * (north - south),
            made.vertices[:, 2],
        ],
        axis=1,
    )
    normals = VertexNormalsExtension(indices=made.triangles, positions=positions, ellipsoid=WGS84)
    with (job.folder / "{}-{}-{}.loop".format(*tile)).open("wb") as file:
        encode(file, positions, made.triangles, bounds=[west, south, east, north],
               extensions=[normals])  # fmt: skip
    return len(made.triangles), positions, made.triangles


def error_of(job: Job, tile, positions, triangles) -> float:
    """Return the largest distance of samples from a mesh of any vertices."""
    bounds = bounds_of(job.scheme, tile)
    middle = np.array([(bounds[0] + bounds[2]) / 2, (bounds[1] + bounds[3]) / 2])
    turned = triangles[:, ::-1] if _clockwise(positions, triangles) else triangles
    surface, worst = Surface(*positions.T.astype(float), turned, middle), 0.0
    for samples in job.source.samples(bounds):
        owners = surface.owners(samples, job.source)
        samples, owners = samples.chosen(owners >= 0), owners[owners >= 0]
        worst = max(worst, float(surface.residuals(surface.seen(samples), owners).max(initial=0.0)))
    return worst


def _clockwise(positions, triangles) -> bool:
    a, b, c = (positions[triangles[0, i], :2] for i in range(3))
    return (b - a)[0] * (c - a)[1] < (b - a)[1] * (c - a)[0]


def compare(name: str, samples: int, metres: float) -> None:
    """Print one row: seconds a megasample, triangles, bytes and errors of both."""
    source = Source.of(placed(name, samples))
    scheme = Geographic()
    z = next(z for z in range(22) if reach(source, scheme, z) <= 1)
    quantum = smallest_quantum(0.0, source.height_range[1])
    with tempfile.TemporaryDirectory() as folder:
        job = Job(source, scheme, {z: Level(metres, 0.0, quantum, MOST)}, Path(folder), False)
        columns, rows = job.tiles(z)
        tiles = [(z, x, y) for y in rows[1:-1] for x in columns[1:-1]]
        write_globe_tile(job, tiles[0])  # kernels are built once
        seconds, kept = np.zeros(3), 0
        triangles, size, packed = (np.zeros(2) for _ in range(3))
        errors = np.zeros((len(tiles), 2))
        for number, tile in enumerate(tiles):
            began = time.perf_counter()
            record = write_globe_tile(job, tile)
            half = time.perf_counter()
            count, positions, corners = by_the_loop(job, tile, metres)
            end = time.perf_counter()
            for which, path in enumerate((record.path, "{}-{}-{}.loop".format(*tile))):
                content = (job.folder / path).read_bytes()
                size[which] += len(content)
                packed[which] += len(gzip.compress(content, 6))
            errors[number] = record.error, error_of(job, tile, positions, corners)
            asked, error, alike = metres, errors[number, 1], end - half
            while error > metres and asked > metres / 16:
                asked /= 2
                start = time.perf_counter()
                _, *finer = by_the_loop(job, tile, asked)
                alike = time.perf_counter() - start
                error = error_of(job, tile, *finer)
            kept += error <= metres
            seconds += half - began, end - half, alike
            triangles += record.triangles, count
    used = len(tiles) * CELLS**2 / 1e6
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print(
        f"| {name} | {metres:g} m | {len(tiles)} | {seconds[0] / used:.2f} | "
        f"{seconds[1] / used:.2f} | {seconds[1] / seconds[0]:.2f} x | "
        f"{seconds[2] / seconds[0]:.2f} x | {kept} | "
        f"{triangles[0] / triangles[1]:.2f} x | {size[0] / size[1]:.2f} x | "
        f"{packed[0] / packed[1]:.2f} x | {errors[:, 0].max():.3f} | {errors[:, 1].max():.3f} | "
        f"{peak:.2f} GB |",
        flush=True,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--ground", nargs="+", default=["fractal", "ridge", "jacksboro"])
    parser.add_argument("--samples", type=int, default=1024)
    parser.add_argument("--metres", nargs="+", type=float, default=[1.0, 5.0, 30.0])
    options = parser.parse_args()
    print("| ground | asked | tiles | s a megapixel of lattice | the loop's | as fast | as fast at "
          "the same error | tiles that have it | triangles "
          "| bytes | packed | our worst error, m | the loop's | peak memory |")  # fmt: skip
    print("|" + 14 * "---|")
    for name in options.ground:
        for metres in options.metres:
            compare(name, options.samples, metres)


if __name__ == "__main__":
    main()
