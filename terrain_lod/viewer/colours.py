"""What each view mode paints: a colour a vertex, a triangle or a sample of the ground."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..drawing import scales
from ..drawing.colours import facing, hypsometric, lit, ramp, sun_direction, to_bytes
from ..drawing.drape import Drape
from ..drawing.picture import SHADE, scale_of
from ..drawing.scales import Scale
from ..drawing.sky_light import SkyLight
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh

Bytes = npt.NDArray[np.uint8]
Sun = tuple[float, float]
"""Where the light comes from: degrees clockwise from north, degrees above the horizon."""

PAPER: Final = (0.97, 0.97, 0.95)
CLAY: Final = (0.86, 0.80, 0.72)
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
    scale : Scale or None
        The same as a colour bar, where colours stand for numbers.
    """

    colours: Bytes
    legend: str
    drape: Drape | None = None
    scale: Scale | None = None


UNPAINTED: Final = Paint(np.empty((0, 3), np.uint8), "")


def by_height(
    mesh: Mesh,
    sun: Sun,
    ground: Heightmap,
    height_range: tuple[float, float],
    *,
    exaggeration: float = 1.0,
    sky_light: SkyLight | None = None,
) -> Paint:
    """Tint a mesh of exaggerated ground by its true heights, under sun and sky."""
    heights = (mesh.vertices[:, 2] + np.float32(mesh.origin[2])) / np.float32(exaggeration)
    metres = scales.metres_above_sea(ground)
    scale = scales.tints(height_range, ground.unit_symbols[1], metres)
    tints = hypsometric(heights, mesh.normals, height_range, metres)
    sky = None if sky_light is None else sky_light.on(mesh)
    colours = to_bytes(lit(tints, mesh.normals, sun_direction(*sun), sky))
    return Paint(colours, scale.said(), scale=scale)


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
) -> Paint:
    """Colour the patches by their edges' factors, over those that are there."""
    values = edge_factors.mean(axis=1)
    return _by_patch(mesh, sun, scales.factors(values), values, triangle_offsets)


def by_patches(mesh: Mesh, sun: Sun, style: str) -> Paint:
    """Colour the patches of ground as a picture of that style does."""
    scale, values = scale_of(mesh, style)
    assert mesh.patches is not None
    return _by_patch(mesh, sun, scale, values, mesh.patches.triangle_offsets)


def by_deviation(
    mesh: Mesh,
    sun: Sun,
    deviations: npt.NDArray[np.float64],
    triangle_offsets: npt.NDArray[np.int64],
    rough: float,
    unit: str,
) -> Paint:
    """Colour the patches by how far their ground leaves its plane; `rough` is the brightest."""
    scale = scales.deviations(rough, unit)
    return _by_patch(mesh, sun, scale, np.nan_to_num(deviations), triangle_offsets)


def by_error(mesh: Mesh, sun: Sun, field: npt.NDArray[np.float32], ground: Heightmap) -> Paint:
    """Colour every sample by its vertical error (R, C), NaN where it was not measured."""
    scale = scales.errors(float(np.nanmax(np.abs(field), initial=0.0)), ground.unit_symbols[1])
    table = to_bytes(ramp(scale.stops, np.linspace(0, 1, _STEPS, dtype=np.float32)))
    steps = np.nan_to_num((field / scale.high + 1) * (0.5 * (_STEPS - 1)), nan=0.5 * _STEPS)
    light = 255 * _light(mesh.normals, sun)
    colours = np.repeat(light.astype(np.uint8)[:, None], 3, axis=1)
    return Paint(colours, scale.said(), Drape(table[steps.astype(np.intp)], ground), scale)


def by_normal(mesh: Mesh) -> Paint:
    """Colour the vertices by their normals: red east, green north, blue up."""
    colours = to_bytes((0.5 + 0.5 * mesh.normals).astype(np.float32))
    return Paint(colours, "red east, green north, blue up")


def _light(normals: npt.NDArray[np.float32], sun: Sun) -> npt.NDArray[np.float32]:
    return SHADE + (1 - SHADE) * facing(normals, sun_direction(*sun))


def _by_patch(
    mesh: Mesh,
    sun: Sun,
    scale: Scale,
    values: npt.NDArray[np.floating[Any]],
    triangle_offsets: npt.NDArray[np.int64],
) -> Paint:
    """Colour each triangle by its patch's number, with enough light to see relief."""
    light = _light(mesh.normals, sun)[mesh.triangles[:, 0]]
    colours = np.repeat(scale.colours(values), np.diff(triangle_offsets), axis=0)
    return Paint(to_bytes(colours * light[:, None]), scale.said(), scale=scale)
