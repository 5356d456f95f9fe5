"""Terrain drawn taller than it is: meshes for such pictures, in true metres all the same."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ..arguments import positive
from ..camera.camera import Camera
from ..ground.exaggeration import exaggerated
from ..mesh.mesh import Mesh
from ..mesh.stretched import stretched
from ..terrain.lod import AnyLod, PromiseLod, Weighted
from ..terrain.terrain import Terrain
from .sky_light import SkyLight


class ExaggeratedTerrain:
    """Makes the meshes that pictures of exaggerated ground deserve.

    Pixels are those of the picture, in which relief and errors are larger. Metres are true ones,
    of what is asked for, of what is achieved and of the mesh.

    Parameters
    ----------
    terrain : Terrain
    exaggeration : float
        How many times as high the picture shows heights, above 0.

    Raises
    ------
    InputError
        If that is not above 0.
    """

    def __init__(self, terrain: Terrain, exaggeration: float) -> None:
        self._factor = positive("exaggeration", exaggeration)
        self._seen = terrain
        if self._factor != 1:
            detail = terrain.detail
            self._seen = Terrain(
                exaggerated(terrain.ground, self._factor),
                detail=None if detail is None else exaggerated(detail, self._factor),
                tile=terrain.grid.tile,
                levels=terrain.levels,
                plane=terrain.plane,
                device=terrain.device,
            )

    def sky_light(self) -> SkyLight:
        """Return the light of the sky on the ground as it is drawn."""
        return SkyLight(self._seen.ground, self._seen.sky)

    def mesh(self, camera: Camera, *, lod: AnyLod | None = None, **meshing: Any) -> Mesh:
        """Return the true mesh for the picture of a camera that stands in the true world.

        What else it takes and raises is as for :meth:`terrain_lod.Terrain.mesh`.
        """
        seen = camera.lifted(self._factor)
        wanted = None if lod is None else _in_seen_metres(lod, self._factor)
        return stretched(self._seen.mesh(seen, lod=wanted, **meshing), 1 / self._factor)


def _in_seen_metres(lod: AnyLod, factor: float) -> AnyLod:
    """Return a level of detail whose metres are those of exaggerated ground."""
    if isinstance(lod, Weighted):
        inner = _in_seen_metres(lod.lod, factor)
        assert not isinstance(inner, Weighted)
        return replace(lod, lod=inner)
    if isinstance(lod, PromiseLod) and "metres" in lod.numbers():
        return type(lod)(**(lod.numbers() | {"metres": lod.metres * factor}))
    return lod
