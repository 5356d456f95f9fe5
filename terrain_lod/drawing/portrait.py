"""A picture of ground with what it says of itself: colours, place, mesh, and its error."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..camera.camera import Camera
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh
from .drape import Drape
from .notes import noted, said_of, said_of_ground
from .picture import OF_PATCHES, SUN, Picture, draw, scale_of
from .scales import Scale, metres_above_sea, tints
from .sky_light import SkyLight


@dataclass(frozen=True, eq=False)
class Portrait:
    """How a ground is shown; see :func:`terrain_lod.render`."""

    ground: Heightmap
    style: str = "shaded"
    sun: tuple[float, float] = SUN
    exaggeration: float = 1.0
    height_range: tuple[float, float] | None = None
    colour_range: tuple[float, float] | None = None
    drape: Drape | None = None
    wireframe: bool = False
    sky_light: SkyLight | None = None

    def of(self, mesh: Mesh, camera: Camera, *, notes: bool) -> Picture:
        """Return the picture of a mesh of the ground, both in the true world as the camera is."""
        picture = draw(
            mesh,
            camera,
            style=self.style,
            sun=self.sun,
            height_range=self._tinted,
            metres=metres_above_sea(self.ground),
            colour_range=self.colour_range,
            drape=self.drape,
            wireframe=self.wireframe,
            exaggeration=self.exaggeration,
            sky_light=self.sky_light,
        )
        if not notes:
            return picture
        seen = camera.lifted(self.exaggeration)
        light = None if self.style == "wireframe" else self.sun
        lines = (
            said_of_ground(self.ground),
            said_of(seen, light, self.exaggeration),
            said_of_mesh(mesh, self.ground),
        )
        across, _ = self.ground.unit_symbols
        return noted(picture, seen, lines, scale=self._scale(mesh), unit=across)

    @property
    def _tinted(self) -> tuple[float, float]:
        return self.ground.height_range if self.height_range is None else self.height_range

    def _scale(self, mesh: Mesh) -> Scale | None:
        """Return what the colours stand for, if for numbers."""
        if self.style in OF_PATCHES:
            return scale_of(mesh, self.style, self.colour_range)[0]
        if self.style != "shaded" or self.drape is not None:
            return None
        return tints(self._tinted, self.ground.unit_symbols[1], metres_above_sea(self.ground))


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
