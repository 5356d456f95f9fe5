"""Something to look at: what a viewer asks of it, and what it gets. Draws nothing.

A kind of scene is a :class:`Scene`, its :class:`Frame` and its settings: `terrain_scene.py`,
`mesh_scene.py`. Window, page, engine and controls know no more than is written here.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass, replace
from textwrap import wrap
from time import perf_counter
from typing import Final

import numpy as np
import numpy.typing as npt

from ..camera.camera import Camera, Point
from ..mesh.mesh import Mesh
from .colours import UNPAINTED, Paint, by_detail
from .settings import Settings

_LINE: Final = 60  # characters of the read-out


@dataclass(frozen=True)
class Request:
    """A picture that is wanted: of the LOD for this camera, with these settings."""

    camera: Camera
    settings: Settings
    number: int = 0


@dataclass(frozen=True)
class Pick(ABC):
    """What is known of a place.

    Attributes
    ----------
    point : (float, float, float)
        In world units.
    """

    point: Point

    @abstractmethod
    def lines(self) -> tuple[str, ...]:
        """Return what is known, a line each."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Frame(ABC):
    """What is to be drawn.

    Attributes
    ----------
    request : Request
        What it answers.
    scene : Scene
        What it shows.
    mesh : Mesh
    edge_factors : (P, E) float32
        Of every patch; not above 0 where it was culled.
    inside_factors : (P, I) float32
    triangle_offsets : (P + 1,) int64
        Where each patch begins among the triangles.
    paint : Paint
    engine_seconds, paint_seconds : float
        Wall time of the mesh and of its colours.
    """

    request: Request
    scene: Scene
    mesh: Mesh
    edge_factors: npt.NDArray[np.float32]
    inside_factors: npt.NDArray[np.float32]
    triangle_offsets: npt.NDArray[np.int64]
    paint: Paint = UNPAINTED
    engine_seconds: float = 0.0
    paint_seconds: float = 0.0

    def facts(self) -> tuple[str, ...]:
        """Return what else is known of the mesh, a line each."""
        return ()

    @abstractmethod
    def painted(self) -> Paint:
        """Return the mesh's colours."""

    @property
    def is_complete(self) -> bool:
        """Whether the same request would be answered alike a moment later."""
        return True

    def measured(self) -> Frame:
        """Return the frame with what takes longer to find out."""
        return self

    @abstractmethod
    def pick(self, camera: Camera, x: float, y: float) -> Pick | None:
        """Return what is known of what a pixel shows, counted from the lower left."""

    @property
    def drawn_count(self) -> int:
        """How many patches have triangles."""
        return int(np.count_nonzero(np.diff(self.triangle_offsets)))

    @property
    def sun(self) -> tuple[float, float]:
        """Where the light comes from, degrees."""
        return self.request.settings.azimuth, self.request.settings.elevation

    def by_detail(self, most: float) -> Paint:
        """Return colours by the patches' edge factors, up to `most`."""
        return by_detail(self.mesh, self.sun, self.edge_factors, self.triangle_offsets, most)

    def lines(self) -> tuple[str, ...]:
        """Return the read-out, a line each."""
        settings, count = self.request.settings, self.drawn_count
        stages = ", ".join(f"{name} {1e3 * s:.1f}" for name, s in self.mesh.timings.items())
        return (
            str(settings) + ("  FROZEN" if settings.frozen else ""),
            f"{len(self.mesh.triangles):,} triangles",
            f"{count:,} patches drawn, {len(self.edge_factors) - count:,} culled",
            *self.facts(),
            f"mesh {1e3 * self.engine_seconds:.0f} ms, colours {1e3 * self.paint_seconds:.0f} ms",
            *wrap(f"device ms: {stages}", _LINE),
            f"{settings.mode}: {self.paint.legend}",
        )


class Scene(ABC):
    """Something to look at.

    Attributes
    ----------
    settings : Settings
        To begin with.
    centre : (float, float, float)
        World point.
    diagonal : float
        Of its extent, in world units.
    read_by_vtk : bool
        Whether its file is: VTK waits for itself when it reads on one thread and draws on another.
    """

    settings: Settings
    centre: Point
    diagonal: float
    read_by_vtk: bool = False

    @abstractmethod
    def camera(self) -> Camera:
        """Return a camera to begin with."""

    def floor(self, x: float, y: float) -> float:
        """Return the height that an eye at a world point stays above."""
        return -np.inf

    def shows_fronts_alone(self, eye: Point) -> bool:
        """Return whether an eye at a world point can see no triangle from behind."""
        return False

    @abstractmethod
    def tessellated(self, request: Request) -> Frame:
        """Return what answers a request, not painted yet.

        Raises
        ------
        TerrainError
            If it cannot be made.
        """

    def frame(self, request: Request) -> Frame:
        """Return what answers a request.

        Raises
        ------
        TerrainError
            If it cannot be made.
        """
        begun = perf_counter()
        frame = self.tessellated(request)
        meshed = perf_counter()
        paint = frame.painted()
        return replace(
            frame,
            paint=paint,
            engine_seconds=meshed - begun,
            paint_seconds=perf_counter() - meshed,
        )


def numbered(values: Iterable[float], digits: int = 1) -> str:
    """Return numbers in a row."""
    return " ".join(f"{value:.{digits}f}" for value in values)
