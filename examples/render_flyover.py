"""Flyover
=======

Fly over bundled ground: coplanarity LOD beside an error of one pixel, a picture a frame. ::

    python examples/render_flyover.py flight --ground canyon --frames 120

A flight that was stopped goes on where it was when it is started again.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import terrain_lod as tl
from terrain_lod.camera.path import flyover
from terrain_lod.drawing.flyover import Look, render_path


def main() -> None:
    """Write the pictures."""
    parser = argparse.ArgumentParser(description="Fly over bundled ground.")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--ground", default="canyon", choices=tl.sample_names())
    parser.add_argument("--frames", type=int, default=120)
    parser.add_argument("--size", type=int, nargs=2, default=(1280, 640))
    parser.add_argument("--style", default="shaded", choices=("shaded", "wireframe", "lod"))
    options = parser.parse_args()

    ground = tl.sample(options.ground)
    cameras = flyover(ground, options.frames, size=tuple(options.size))
    render_path(
        tl.Terrain(ground),
        cameras,
        options.folder,
        lods=(tl.CoplanarityLod(), tl.ScreenErrorLod(1.0)),
        look=Look(style=options.style, sun=(300.0, 35.0)),
        progress=lambda done, total: print(f"\r{done} of {total}", end="", flush=True),
    )
    print(f" pictures in {options.folder}")


if __name__ == "__main__":
    main()
