"""Formulas at equal triangles: error of each, on every bundled ground.

    python benchmarks/coplanarity.py [--grounds ridge canyon] [--tile 15]

Each formula draws as many triangles as distance LOD does at its defaults, from the ground's default
camera. Prints RMS and largest error of each, in pixels and in the ground's unit.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Final

import terrain_lod as tl
from terrain_lod.device.layout import MAX_TILE

_STEPS: Final = 40
_EQUAL: Final = 0.002  # triangle counts that differ by no more are equal


@dataclass(frozen=True)
class PowerLod(tl.Lod):
    """A tile's deviation in the picture to any power."""

    pixels: float = tl.number(16.0)
    power: float = tl.number(0.5)
    maximum: float = tl.number(15.0)
    header: ClassVar[str | Path] = Path(__file__).parent / "power.h"


# by one number each, which is between these; more of it is less detail
FORMULAS: Final[dict[str, tuple[Callable[[float], tl.Lod], float, float]]] = {
    "book": (lambda x: tl.BookCoplanarityLod(maximum=1 / x), 1 / MAX_TILE, 1.0),
    "1/4": (lambda x: PowerLod(x, 1 / 4), 1e-4, 1e8),
    "1/3": (tl.CoplanarityLod, 1e-4, 1e8),
    "1/2": (lambda x: PowerLod(x, 1 / 2), 1e-4, 1e8),
    "area": (tl.ScreenAreaLod, 1e-3, 1e3),
    "promise": (tl.ScreenErrorLod, 1e-2, 1e3),
}


def equal(
    terrain: tl.Terrain, camera: tl.Camera, triangles: int, make: Callable, low: float, high: float
) -> tl.Mesh:
    """Return the mesh of a formula at `triangles`, by bisection of its number."""
    for _ in range(_STEPS):
        middle = (low * high) ** 0.5
        mesh = terrain.mesh(camera, lod=make(middle))
        if abs(len(mesh.triangles) - triangles) <= _EQUAL * triangles:
            break
        low, high = (middle, high) if len(mesh.triangles) > triangles else (low, middle)
    return mesh


def line(name: str, ground: tl.Heightmap, camera: tl.Camera, mesh: tl.Mesh) -> None:
    """Print what one mesh is wrong by."""
    seen, metres = tl.screen_error(mesh, ground, camera), tl.vertical_error(mesh, ground)
    print(
        f"  {name:9} {len(mesh.triangles):9,} triangles   {seen.rms:7.4f} px RMS, "
        f"{seen.maximum:6.2f} at most   {metres.rms:8.3f} m RMS, {metres.maximum:8.2f} at most"
    )


def main() -> None:
    """Run all."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--grounds", nargs="+", default=tl.sample_names(), metavar="NAME")
    parser.add_argument("--tile", type=int, default=15)
    options = parser.parse_args()
    for name in options.grounds:
        ground = tl.sample(name)
        terrain, camera = tl.Terrain(ground, tile=options.tile), tl.default_camera(ground)
        naive = terrain.mesh(camera, lod=tl.DistanceLod())
        print(name, flush=True)
        line("distance", ground, camera, naive)
        for formula, how in FORMULAS.items():
            line(formula, ground, camera, equal(terrain, camera, len(naive.triangles), *how))


if __name__ == "__main__":
    main()
