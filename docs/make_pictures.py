"""Draw the pictures of docs/tessellation.md.

python docs/make_pictures.py docs/pictures
"""

import argparse
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from terrain_lod.drawing.pattern_pictures import save_animation, save_pattern
from terrain_lod.drawing.scales import segments
from terrain_lod.files.rasters.samples import sample
from terrain_lod.terrain.lod_promises import MaxErrorLod
from terrain_lod.terrain.terrain import Terrain
from terrain_lod.tessellation.semi_uniform import semi_uniform
from terrain_lod.tessellation.tessellator import tessellate

PARTITIONINGS = ("integer", "pow2", "fractional_odd", "fractional_even")
_STYLE = {"svg.hashsalt": "terrain_lod", "svg.fonttype": "none", "font.size": 9}
# column, row and size of what is shown, in cells
_PLACES = ((256, 256, 160), (288, 352, 48))


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
    with mpl.rc_context(_STYLE):
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


def draw_patches(path: Path) -> None:
    """Draw patches of every size from above, and enlarged where two sizes meet."""
    ground = sample("ridge")
    mesh = Terrain(ground).mesh(lod=MaxErrorLod(30.0))
    x, y = (mesh.vertices[:, axis] / ground.spacing[axis] for axis in (0, 1))
    patches = mesh.patches
    assert patches is not None
    colours = segments(patches).colours(patches.segment_cells)
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(9, 4.6), layout="constrained")
        for axes, (left, top, size) in zip(figure.subplots(1, 2), _PLACES, strict=True):
            for area, colour in zip(patches.areas, colours, strict=True):
                row, column, down, across = area
                place = (column, -row - down), across, down
                axes.add_patch(Rectangle(*place, facecolor=0.5 + 0.5 * colour, linewidth=0))
                axes.add_patch(Rectangle(*place, fill=False, edgecolor="#1d3446", linewidth=1.4))
            axes.triplot(x, y, mesh.triangles, color="#1d3446", linewidth=0.4)
            axes.set(xlim=(left, left + size), ylim=(-top - size, -top), aspect="equal")
            axes.set_xticks([]), axes.set_yticks([])
        figure.savefig(path, dpi=130)


def draw_drift(path: Path) -> None:
    """Draw a cut through ground, its lattice, and two segments that are measured at it."""
    samples = np.arange(33)
    heights = 9 * np.sin(samples / 9.0) + 2.2 * np.sin(samples * 1.31) + 1.2 * np.cos(samples * 2.3)
    lattice, ends = samples[::4], samples[[0, 16, 32]]
    between = np.interp(samples, lattice, heights[lattice])
    drawn = np.interp(samples, ends, heights[ends])
    with mpl.rc_context(_STYLE):
        figure = Figure(figsize=(9, 3.2), layout="constrained")
        axes = figure.subplots()
        axes.plot(samples, heights, "-o", ms=3, color="#8a6f4d", label="ground, every sample")
        axes.plot(samples, between, "--s", ms=4, markevery=4, color="#2b6ca3", label="lattice")
        axes.plot(samples, drawn, "-", lw=2, color="#c0392b", label="two segments of a patch")
        off = int(np.abs(heights - between).argmax())
        far = int(lattice[np.abs(drawn - between)[lattice].argmax()])
        for place, low, high, word in (
            (off, heights[off], between[off], "drift"),
            (far, drawn[far], between[far], "distance from the lattice"),
        ):
            axes.plot([place, place], [low, high], color="black", lw=2)
            axes.annotate(word, (place, (low + high) / 2), (6, 0), textcoords="offset points")
        axes.legend(frameon=False, loc="upper right")
        axes.set_axis_off()
        figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--frames", type=int, default=31, help="of an animation, one way")
    chosen = parser.parse_args()
    chosen.folder.mkdir(parents=True, exist_ok=True)
    draw_patterns(chosen.folder)
    draw_sweeps(chosen.folder, chosen.frames)
    draw_divisions(chosen.folder / "divisions.svg")
    draw_patches(chosen.folder / "hierarchy.png")
    draw_drift(chosen.folder / "drift.svg")
