"""A pyramid on disk to look at: what is held shows at once, the rest as it is read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from ..camera.camera import Camera, Point
from ..camera.viewpoint import default_camera
from ..numbered import begin
from ..pyramid.division import NODE
from ..streaming.terrain import StreamingTerrain
from ..terrain.lod import PromiseLod
from ..terrain.lod_promises import MaxErrorLod, ScreenErrorLod
from .colours import Paint, by_height, by_normal, by_segments, paper
from .rig import height_at, triangle_seen
from .scene import Frame, Pick, Request, Scene, numbered
from .settings import SUN, Choice, Settings, Slider

_LODS: Final = {"screen-error": ScreenErrorLod, "max-error": MaxErrorLod}


@dataclass(frozen=True, kw_only=True)
class StreamingSettings(Settings):
    """What a viewer of a pyramid is set to: errors alone, which patches of every size keep."""

    lod: str = "screen-error"
    partitioning: str = "integer"

    def __post_init__(self) -> None:
        if not self.formulas:
            begun = {name: begin(kind, self.diagonal, NODE) for name, kind in _LODS.items()}
            object.__setattr__(self, "formulas", begun)

    @property
    def choices(self) -> tuple[Choice, ...]:
        return (
            Choice("mode", "m", ("shaded", "wireframe", "lod", "normals")),
            Choice("lod", "l", tuple(self.formulas), "level of detail"),
            Choice("frozen", "f", (False, True)),
        )

    @property
    def numbers(self) -> tuple[Slider, ...]:
        return (*self.formula_sliders(), *SUN)

    def detail(self) -> PromiseLod:
        """Return the level of detail."""
        chosen: PromiseLod = self.formulas[self.lod]
        return chosen


@dataclass(frozen=True)
class PatchOnGround(Pick):
    """What is known of a place on the ground.

    Attributes
    ----------
    cells : (int, int)
        Rows and columns of samples that its patch spans.
    edge_factors, inside_factors : tuple of float
    unit : str
    """

    cells: tuple[int, int]
    edge_factors: tuple[float, ...]
    inside_factors: tuple[float, ...]
    unit: str

    def lines(self) -> tuple[str, ...]:
        x, y, z = self.point
        return (
            f"height {z:,.2f} {self.unit} of the mesh at {x:,.1f}, {y:,.1f}",
            f"patch of {self.cells[0]:,} x {self.cells[1]:,} cells",
            f"factors {numbered(self.edge_factors)}  inside {numbered(self.inside_factors)}",
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class StreamingFrame(Frame):
    """Ground of a pyramid to be drawn.

    Attributes
    ----------
    terrain : StreamingTerrain
    missing : int
        How many chunks that it would be better with were not there.
    """

    terrain: StreamingTerrain
    missing: int

    @property
    def is_complete(self) -> bool:
        return not self.missing

    def facts(self) -> tuple[str, ...]:
        terrain, achieved = self.terrain, self.mesh.achieved
        assert achieved is not None
        pixels = "" if achieved.pixels is None else f", {achieved.pixels:.3g} pixels"
        kept = "" if achieved.kept else ", more than asked"
        waits = f", {self.missing} chunks missing" if self.missing else ""
        return (
            f"largest error {achieved.metres:.3g} {terrain.overview.unit_symbols[1]}{pixels}{kept}",
            f"{terrain.held / 1e6:,.0f} of {terrain.memory / 1e6:,.0f} MB held, "
            f"{terrain.in_flight} pages in flight{waits}",
            *terrain.damage[:1],
        )

    def painted(self) -> Paint:
        mesh, sun, terrain = self.mesh, self.sun, self.terrain
        match self.request.settings.mode:
            case "wireframe":
                return paper(mesh)
            case "lod":
                assert mesh.patches is not None
                return by_segments(mesh, sun, mesh.patches)
            case "normals":
                return by_normal(mesh)
        return by_height(mesh, sun, terrain.height_range, terrain.overview.unit_symbols[1])

    def pick(self, camera: Camera, x: float, y: float) -> PatchOnGround | None:
        seen, patches = triangle_seen(self.mesh, camera, x, y), self.mesh.patches
        if seen is None:
            return None
        assert patches is not None
        patch = int(np.searchsorted(self.triangle_offsets, seen[0], "right")) - 1
        _, _, down, across = patches.areas[patch].tolist()
        return PatchOnGround(
            point=seen[1],
            cells=(down, across),
            edge_factors=tuple(self.edge_factors[patch].tolist()),
            inside_factors=tuple(self.inside_factors[patch].tolist()),
            unit=self.terrain.overview.unit_symbols[1],
        )


class StreamingScene(Scene):
    """A pyramid to look at.

    Parameters
    ----------
    terrain : StreamingTerrain
    """

    settings: StreamingSettings

    def __init__(self, terrain: StreamingTerrain) -> None:
        self.terrain = terrain
        self.centre = terrain.overview.centre
        self.diagonal = float(np.hypot(*terrain.overview.extent))
        self.settings = StreamingSettings(diagonal=self.diagonal)

    def camera(self) -> Camera:
        return default_camera(self.terrain.overview)

    def floor(self, x: float, y: float) -> float:
        return height_at(self.terrain.ground_near(x, y), x, y)

    def shows_fronts_alone(self, eye: Point) -> bool:
        """Return whether an eye is above all ground."""
        return eye[2] > self.terrain.height_range[1]

    def tessellated(self, request: Request) -> StreamingFrame:
        settings = request.settings
        assert isinstance(settings, StreamingSettings)
        mesh = self.terrain.mesh(request.camera, lod=settings.detail(), wait=False)
        assert mesh.patches is not None
        return StreamingFrame(
            request=request,
            scene=self,
            mesh=mesh,
            edge_factors=mesh.patches.edge_factors,
            inside_factors=mesh.patches.inside_factors,
            triangle_offsets=mesh.patches.triangle_offsets,
            terrain=self.terrain,
            missing=len(self.terrain.missing),
        )
