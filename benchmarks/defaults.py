"""What defaults are chosen by: triangles, time and pops of promises, by partitioning and tile.

    python benchmarks/defaults.py tiles [--ground ridge canyon jacksboro fractal]
    python benchmarks/defaults.py pops [--ground ridge canyon]

`tiles`: a line for each partitioning and tile size. Triangles of static meshes as multiples of
pydelatin's; then of one pixel over a low flight, with the patches that are drawn, the first view
from a raster in host memory, one more view, and the pops from a view to the next of 240 pictures.
`pops`: what patches that change late come to, over neighbouring pictures of that flight and under
a camera that trembles by as much as from one to the next; beside smaller errors, and beside
distance LOD with as many triangles, which moves smoothly but keeps no error.

Times are medians of works that are run in turn.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from functools import partial
from statistics import median
from typing import Any

import numpy as np
from promise import DELATIN, ground_of, seconds_of

import terrain_lod as tl
from terrain_lod.camera.path import flyover
from terrain_lod.reports.matching import tuned

ODD: dict[str, Any] = {"partitioning": "fractional_odd"}
TRIED = [*((ODD, tile) for tile in (7, 15)), *(({}, tile) for tile in (3, 4, 5, 6, 7, 8, 15))]
METRES = (5.0, 30.0)
PICTURES = 240
PIXEL = tl.ScreenErrorLod(1.0)


def tiles(name: str, samples: int) -> None:
    """Print a line for each partitioning and tile size."""
    ground = ground_of(name, samples)
    way = flyover(ground, PICTURES)
    pairs = [(way[start], way[start + 1]) for start in range(0, PICTURES - 1, 20)]
    best = {metres: len(DELATIN.mesh(ground, metres).triangles) for metres in METRES}

    def first(how: dict[str, Any], tile: int) -> tl.Mesh:
        return tl.Terrain(ground, tile=tile).mesh(way[0], lod=PIXEL, **how)

    terrains, times = {}, {}
    for index, (how, tile) in enumerate(TRIED):
        first(how, tile)  # builds kernels
        terrains[index], times[index] = tl.Terrain(ground, tile=tile), ([], [])
        terrains[index].mesh(way[0], lod=PIXEL, **how)
    for camera, _ in pairs:
        for index, (how, tile) in enumerate(TRIED):
            view = partial(terrains[index].mesh, camera, lod=PIXEL, **how)
            view()
            for spent, work in zip(times[index], (partial(first, how, tile), view), strict=True):
                spent.append(seconds_of(work)[0])
    print(f"{name}, {samples} x {samples}")
    print("| partitioning | tile | 5 m | 30 m | a view | patches | first | more | pop | RMS |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for index, (how, tile) in enumerate(TRIED):
        terrain = terrains[index]
        static = (
            len(terrain.mesh(lod=tl.MaxErrorLod(metres), **how).triangles) / best[metres]
            for metres in METRES
        )
        seen = [[terrain.mesh(camera, lod=PIXEL, **how) for camera in pair] for pair in pairs]
        pops = [
            tl.pop_metric(meshes, ground, pair) for meshes, pair in zip(seen, pairs, strict=True)
        ]
        counts = median(len(one.triangles) for one, _ in seen)
        drawn = median(int(one.patches.drawn.sum()) for one, _ in seen)
        spent = " | ".join(f"{1e3 * median(found):.0f} ms" for found in times[index])
        print(
            f"| {how.get('partitioning', 'integer')} | {tile} | "
            f"{' | '.join(f'{share:.2f}' for share in static)} | {counts:,.0f} | {drawn:,.0f} | "
            f"{spent} | {max(pop.maximum for pop in pops):.2f} | "
            f"{np.sqrt(np.mean([pop.rms**2 for pop in pops])):.4f} |",
            flush=True,
        )


def pops(name: str, samples: int, pictures: int) -> None:
    """Print triangles, and pops over neighbouring pictures and under a trembling camera."""
    ground = ground_of(name, samples)
    way = flyover(ground, PICTURES)[PICTURES // 4 :][:pictures]
    trembling = [way[index % 2] for index in range(pictures)]
    tree = tl.Terrain(ground)
    print(f"{name}, {samples} x {samples}, {pictures} pictures")
    print("| | triangles | pop | RMS | trembling: pop | RMS |")
    print("|---|---|---|---|---|---|")

    def line(label: str, terrain: tl.Terrain, lod: Any, band: float = 0.0, **how: Any) -> None:
        found, counts = [], 0.0
        for cameras in (way, trembling):
            steady = {"steady": tl.Steady(band)} if band else {}
            meshes = [terrain.mesh(camera, lod=lod, **steady, **how) for camera in cameras]
            counts = counts or median(len(mesh.triangles) for mesh in meshes)
            # the first two may be finer than the rest has to be
            found.append(tl.pop_metric(meshes[2:], ground, cameras[2:]))
        each = " | ".join(f"{pop.maximum:.2f} | {pop.rms:.4f}" for pop in found)
        print(f"| {label} | {counts:,.0f} | {each} |", flush=True)

    for tile in (7, 15):
        flat = tl.Terrain(ground, tile=tile, levels=1)
        line(f"1 pixel, odd factors, tiles of {tile}", flat, PIXEL, **ODD)
    for pixels in (1.0, 0.7):
        for band in (0.0, 0.1, 0.25, 0.5):
            label = f"{pixels:g} pixels" + (f", Steady({band:g})" if band else "")
            line(label, tree, tl.ScreenErrorLod(pixels), band)
    flat = tl.Terrain(ground, levels=1)
    wanted = len(tree.mesh(way[0], lod=PIXEL).triangles)
    smooth = tuned(
        tl.DistanceLod(),
        wanted,
        lambda lod: len(flat.mesh(way[0], lod=lod).triangles),
        share=0.001,
        rises=True,
    )
    line("distance LOD, fractional_odd", flat, smooth)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the chosen part."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=("tiles", "pops"))
    parser.add_argument("--ground", nargs="+", default=["ridge", "canyon", "jacksboro", "fractal"])
    parser.add_argument("--samples", type=int, default=512)
    parser.add_argument("--pictures", type=int, default=24)
    options = parser.parse_args(arguments)
    for name in options.ground:
        if options.part == "tiles":
            tiles(name, options.samples)
        else:
            pops(name, options.samples, options.pictures)


if __name__ == "__main__":
    main()
