"""What is written on a picture of ground: its colours, its place, its mesh and how far that is off."""

from __future__ import annotations

import math

from ..camera.camera import Camera
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh
from .notes import noted, said_of, said_of_ground
from .picture import OF_PATCHES, Picture, scale_of
from .scales import Scale, heights, metres_above_sea, tints


def with_notes(
    picture: Picture,
    mesh: Mesh,
    camera: Camera,
    ground: Heightmap,
    *,
    style: str,
    sun: tuple[float, float],
    height_range: tuple[float, float] | None = None,
    factor_range: tuple[float, float] | None = None,
    draped: bool = False,
    exaggeration: float = 1.0,
) -> Picture:
    """Return a picture of a ground's mesh with notes along its foot; see :func:`render`."""
    scale: Scale | None = None
    if style in OF_PATCHES:
        scale, _ = scale_of(mesh, style, factor_range)
    elif style == "shaded" and not draped:
        scale = heights(ground)
        if height_range is not None:
            unit = ground.unit_symbols[1]
            scale = tints(height_range, unit, metres_above_sea(ground))
    light = None if style == "wireframe" else sun
    lines = (
        said_of_ground(ground),
        said_of(camera.lifted(exaggeration), light, exaggeration),
        said_of_mesh(mesh, ground),
    )
    across, _ = ground.unit_symbols
    return noted(picture, camera.lifted(exaggeration), lines, scale=scale, unit=across)


def said_of_mesh(mesh: Mesh, ground: Heightmap) -> str:
    """Return how many triangles a mesh has and what is known of its error, in true units."""
    counted = f"{len(mesh.triangles):,} triangles"
    if mesh.achieved is None:
        return counted
    _, unit = ground.unit_symbols
    error = f"{mesh.achieved.metres:.3g} {unit}"
    if mesh.achieved.pixels is not None and math.isfinite(mesh.achieved.pixels):
        pixels = f"{mesh.achieved.pixels:.2g}"
        error = f"{pixels} pixel{'' if pixels == '1' else 's'}, {error}"
    return f"{counted}, nowhere off by more than {error}"
