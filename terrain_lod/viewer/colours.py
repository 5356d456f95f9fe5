"""What each view mode paints: a colour a vertex, a triangle or a sample of the ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

from ..drawing.colours import (
    LONGEST,
    Colours,
    Stops,
    facing,
    hypsometric,
    lit,
    lod_colours,
    ramp,
    segment_colours,
    sun_direction,
    to_bytes,
)
from ..drawing.drape import Drape
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh, Patches

Bytes = npt.NDArray[np.uint8]
Sun = tuple[float, float]
"""Where the light comes from: degrees clockwise from north, degrees above the horizon."""

# nothing to much
HEAT_STOPS: Final[Stops] = (
    (0.00, 0.06, 0.07, 0.22),
    (0.35, 0.45, 0.12, 0.45),
    (0.65, 0.90, 0.35, 0.22),
    (0.85, 0.98, 0.70, 0.20),
    (1.00, 1.00, 0.98, 0.75),
)
# far below the ground, on it, far above it
ERROR_STOPS: Final[Stops] = (
    (-1.00, 0.10, 0.25, 0.70),
    (-0.35, 0.45, 0.65, 0.90),
    (0.00, 0.96, 0.96, 0.94),
    (0.35, 0.95, 0.60, 0.40),
    (1.00, 0.70, 0.08, 0.10),
)
PAPER: Final = (0.97, 0.97, 0.95)
CLAY: Final = (0.86, 0.80, 0.72)
_SHADE: Final = 0.55  # light of a slope that faces away, where colours stand for numbers
_STEPS: Final = 512  # of the error ramp


@dataclass(frozen=True, eq=False)
class Paint:
    """What a mesh is painted with.

    Attributes
    ----------
    colours : (V, 3) or (T, 3) uint8
        One a vertex or one a triangle.
    legend : str
        What the colours stand for.
    drape : Drape or None
        A picture of the ground, which `colours` then shade.
    """

    colours: Bytes
    legend: str
    drape: Drape | None = None


UNPAINTED: Final = Paint(np.empty((0, 3), np.uint8), "")


def by_height(mesh: Mesh, sun: Sun, height_range: tuple[float, float], unit: str) -> Paint:
    """Tint by height, under the sun."""
    heights = mesh.vertices[:, 2] + np.float32(mesh.origin[2])
    tints = hypsometric(heights, mesh.normals, height_range)
    low, high = height_range
    legend = f"tinted by height, {low:,.4g} to {high:,.4g} {unit}"
    return Paint(to_bytes(lit(tints, mesh.normals, sun_direction(*sun))), legend)


def of_clay(mesh: Mesh, sun: Sun) -> Paint:
    """Leave the mesh in one colour under the sun, with some light from all around."""
    facing_sun = facing(mesh.normals, sun_direction(*sun))
    light = np.minimum(0.32 + 0.15 * mesh.normals[:, 2] + 0.58 * facing_sun, 1.0)
    colours = light[:, None] * np.asarray(CLAY, np.float32)
    return Paint(to_bytes(colours.astype(np.float32)), "one colour, under the sun")


def paper(mesh: Mesh) -> Paint:
    """Leave the triangles white; their edges are drawn."""
    colour = to_bytes(np.asarray(PAPER, np.float32))
    return Paint(np.tile(colour, (len(mesh.vertices), 1)), "edges of the triangles")


def by_detail(
    mesh: Mesh,
    sun: Sun,
    edge_factors: npt.NDArray[np.float32],
    triangle_offsets: npt.NDArray[np.int64],
    most: float,
) -> Paint:
    """Colour the patches by their edges' factors, the book's code."""
    top = max(2.0, most)
    colours = lod_colours(edge_factors.mean(axis=1), (1.0, top))
    legend = f"factor of a patch: black 1, blue, green, yellow, red {top:.3g}"
    return Paint(_of_patches(colours, triangle_offsets, mesh, sun), legend)


def by_segments(mesh: Mesh, sun: Sun, patches: Patches) -> Paint:
    """Colour the patches by the cells that their segments span: their size and their factors."""
    colours = segment_colours(patches.segment_cells)
    legend = f"cells of a segment: red 1, yellow, green, blue, black {LONGEST:g}"
    return Paint(_of_patches(colours, patches.triangle_offsets, mesh, sun), legend)


def by_deviation(
    mesh: Mesh,
    sun: Sun,
    deviations: npt.NDArray[np.float32],
    triangle_offsets: npt.NDArray[np.int64],
    rough: float,
    unit: str,
) -> Paint:
    """Colour the patches by how far their ground leaves its plane; `rough` is the brightest."""
    shares = np.nan_to_num(deviations) / (rough or 1.0)
    colours = ramp(HEAT_STOPS, shares.astype(np.float32))
    legend = f"deviation from a tile's plane: dark 0, bright {rough:.3g} {unit} and more"
    return Paint(_of_patches(colours, triangle_offsets, mesh, sun), legend)


def by_error(mesh: Mesh, sun: Sun, field: npt.NDArray[np.float32], ground: Heightmap) -> Paint:
    """Colour every sample by its vertical error (R, C), NaN where it was not measured."""
    top = float(np.nanmax(np.abs(field), initial=0.0)) or 1.0
    table = to_bytes(ramp(ERROR_STOPS, np.linspace(-1, 1, _STEPS, dtype=np.float32)))
    steps = np.nan_to_num((field / top + 1) * (0.5 * (_STEPS - 1)), nan=0.5 * _STEPS)
    light = 255 * _light(mesh.normals, sun)
    unit = ground.unit_symbols[1]
    legend = f"vertical error: red {top:.3g} {unit} above the ground, white 0, blue below"
    colours = np.repeat(light.astype(np.uint8)[:, None], 3, axis=1)
    return Paint(colours, legend, Drape(table[steps.astype(np.intp)], ground))


def by_normal(mesh: Mesh) -> Paint:
    """Colour the vertices by their normals: red east, green north, blue up."""
    colours = to_bytes((0.5 + 0.5 * mesh.normals).astype(np.float32))
    return Paint(colours, "red east, green north, blue up")


def _light(normals: npt.NDArray[np.float32], sun: Sun) -> npt.NDArray[np.float32]:
    return _SHADE + (1 - _SHADE) * facing(normals, sun_direction(*sun))


def _of_patches(
    colours: Colours, triangle_offsets: npt.NDArray[np.int64], mesh: Mesh, sun: Sun
) -> Bytes:
    """Return the colour of each triangle: its patch's, with enough light to see relief."""
    light = _light(mesh.normals, sun)[mesh.triangles[:, 0]]
    return to_bytes(np.repeat(colours, np.diff(triangle_offsets), axis=0) * light[:, None])
