"""Draw the pictures of docs/tessellation.md.

python docs/make_pictures.py docs/pictures
"""

import argparse
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from terrain_lod.drawing.pattern_pictures import save_animation, save_pattern
from terrain_lod.tessellation.semi_uniform import semi_uniform
from terrain_lod.tessellation.tessellator import tessellate

PARTITIONINGS = ("integer", "pow2", "fractional_odd", "fractional_even")


def draw_patterns(folder: Path) -> None:
    """Draw one patch of each kind."""
    edges, inside = [[3, 5, 7.5, 9]], [[4.2, 6]]
    pattern = tessellate("quad", edges, inside)
    save_pattern(pattern, folder / "quad.svg", edge_factors=edges, inside_factors=inside)
    edges, inside = [[3, 5, 7.5]], [[6.3]]
    pattern = tessellate("triangle", edges, inside)
    save_pattern(pattern, folder / "triangle.svg", edge_factors=edges, inside_factors=inside)
    levels = [[3, 1, 2]]
    save_pattern(semi_uniform(levels), folder / "semi_uniform.svg", edge_factors=levels)
    levels = [[3, 1, 0, 2]]
    save_pattern(semi_uniform(levels), folder / "semi_uniform_quad.svg", edge_factors=levels)


def draw_sweeps(folder: Path, frames: int) -> None:
    """Animate the same factors with and without fractions."""
    factors = np.linspace(1, 7, frames)[:, None] * np.ones(4)
    for partitioning in ("integer", "fractional_odd"):
        pattern = tessellate("quad", factors, factors[:, :2], partitioning=partitioning)
        path = folder / f"{partitioning}.gif"
        save_animation(pattern, path, edge_factors=factors, inside_factors=factors[:, :2])


def draw_divisions(path: Path) -> None:
    """Plot where the points of an edge lie, for every factor from 1 to 9."""
    factors = np.linspace(1, 9, 801)
    style = {"svg.hashsalt": "terrain_lod", "svg.fonttype": "none", "font.size": 9}
    with mpl.rc_context(style):
        figure = Figure(figsize=(9, 5.2), layout="constrained")
        panels = figure.subplots(2, 2, sharex=True, sharey=True)
        for axes, partitioning in zip(panels.flat, PARTITIONINGS, strict=True):
            lines = np.stack([np.ones_like(factors), factors], axis=1)
            pattern = tessellate("isoline", lines, partitioning=partitioning)
            counts = np.diff(pattern.point_offsets)
            places = pattern.points[:, 0] / 65536
            axes.plot(
                np.repeat(factors, counts), places, ".", ms=2, color="#1d3446", rasterized=True
            )
            axes.set_title(partitioning, loc="left")
            axes.set_xticks(range(1, 10))
            axes.set_xlim(1, 9)
        figure.supxlabel("factor")
        figure.supylabel("place along the edge")
        figure.savefig(path, dpi=110, metadata={"Date": None})


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--frames", type=int, default=31, help="of an animation, one way")
    chosen = parser.parse_args()
    chosen.folder.mkdir(parents=True, exist_ok=True)
    draw_patterns(chosen.folder)
    draw_sweeps(chosen.folder, chosen.frames)
    draw_divisions(chosen.folder / "divisions.svg")
