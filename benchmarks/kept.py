"""Whether promises hold and nothing cracks: grounds x tolerances x cameras x tile sizes.

    python benchmarks/kept.py promises [--cameras 50] [--ground ridge ...] [--tiles 4 6 8 15]
    python benchmarks/kept.py cracks [--cameras 1000]

`promises`: how often one was broken, measured from outside by code that shares nothing with what
chose it. `cracks`: edges at which a mesh is open though it goes on, T-junctions, edges of three
triangles and triangles of no area, over random views. Both exit with 1 where there is one.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator

import numpy as np
from promise import ground_of

import terrain_lod as tl

GROUNDS = ("ridge", "canyon", "fractal", "holed", "detailed")
_DETAIL = 4  # steps of the detail in one of the ground's


def cameras_over(ground: tl.Heightmap, count: int) -> Iterator[tl.Camera]:
    """Yield cameras above, beside, behind and inside the ground's box, parallel ones too."""
    random = np.random.default_rng(11)
    width, depth = ground.extent
    low, high = ground.height_range
    for index in range(count):
        x, y = random.uniform(-0.3, 1.3, 2) * (width, -depth) + ground.origin
        eye = np.array([x, y, random.uniform(low, high + 0.2 * width)])
        heading, pitch = random.uniform(0, 2 * np.pi), random.uniform(-1.2, 0.3)
        ahead = np.array([np.cos(heading), np.sin(heading), np.tan(pitch)])
        yield tl.Camera(
            tuple(eye),
            tuple(eye + ahead),
            fov=random.uniform(5, 120),
            height=width / 3 if index % 5 == 4 else None,
        )


def holed(ground: tl.Heightmap) -> tl.Heightmap:
    """Return `ground` with single samples, a row and a square missing."""
    random = np.random.default_rng(2)
    heights = np.array(ground.heights)
    heights[random.random(heights.shape) < 0.002] = np.nan
    heights[len(heights) // 3] = np.nan
    heights[20:50, 30:70] = np.nan
    return tl.Heightmap(heights, spacing=ground.spacing, base=ground.base, name="holed")


def terrain_of(name: str, samples: int, tile: int) -> tuple[tl.Terrain, tl.Heightmap]:
    """Return a terrain, and all the samples that its promises are about."""
    if name == "holed":
        ground = holed(ground_of("ridge", samples))
    elif name == "detailed":
        ground = ground_of("ridge", samples // _DETAIL)
        bumps = np.random.default_rng(3).normal(scale=2.0, size=(37, 41))
        detail = tl.Heightmap(bumps, spacing=tuple(step / _DETAIL for step in ground.spacing))
        return tl.Terrain(ground, detail=detail, tile=tile), ground.with_detail(detail)
    else:
        ground = ground_of(name, samples)
    return tl.Terrain(ground, tile=tile), ground


def promises(names: list[str], samples: int, cameras: int, tiles: list[int]) -> int:
    """Count promises broken, in metres and over cameras."""
    tried = broken = 0
    worst = 0.0
    for name in names:
        for tile in tiles:
            terrain, ground = terrain_of(name, samples, tile)
            low, high = ground.height_range
            for step in range(8):
                metres = (high - low) * 3e-5 * 3.3**step
                mesh = terrain.mesh(lod=tl.MaxErrorLod(metres))
                shares = [tl.vertical_error(mesh, ground).maximum / metres]
                pixels = 0.1 * 2.0**step
                for camera in cameras_over(ground, cameras):
                    mesh = terrain.mesh(camera, lod=tl.ScreenErrorLod(pixels))
                    if len(mesh.triangles):
                        found = tl.screen_error(mesh, ground, camera)
                        shares.append(found.maximum / pixels if found.samples else 0.0)
                tried += len(shares)
                broken += sum(share > 1 for share in shares)
                worst = max(worst, *shares)
            print(
                f"{name}, tiles of {tile}: {broken} of {tried} broken, worst {worst:.6f}",
                flush=True,
            )
    return broken


def cracks(names: list[str], samples: int, views: int, tiles: list[int]) -> int:
    """Count what is not watertight, over views of all grounds and tile sizes in turn."""
    cracked = triangles = 0
    made = [terrain_of(name, samples, tile) for name in names for tile in tiles]
    for number, (terrain, ground) in enumerate(made):
        own = range(number, views, len(made))
        for index, camera in zip(own, cameras_over(ground, len(own)), strict=True):
            mesh = terrain.mesh(camera, lod=tl.ScreenErrorLod(0.3 * 2.0 ** (index % 6)))
            found = tl.crack_report(mesh)
            cracked += found.cracks + found.t_junctions + found.unbalanced + found.left_out
            triangles += len(mesh.triangles)
    print(f"{views} views, {triangles:,} triangles: {cracked} cracks")
    return cracked


def main() -> None:
    """Run the chosen part."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=("promises", "cracks"))
    parser.add_argument("--ground", nargs="+", default=list(GROUNDS))
    parser.add_argument("--samples", type=int, default=512)
    parser.add_argument("--tiles", type=int, nargs="+", default=[4, 6, 8, 15])
    parser.add_argument("--cameras", type=int)
    options = parser.parse_args()
    count = promises if options.part == "promises" else cracks
    views = options.cameras or (50 if options.part == "promises" else 1000)
    sys.exit(count(options.ground, options.samples, views, options.tiles) > 0)


if __name__ == "__main__":
    main()
