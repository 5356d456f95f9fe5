"""Ground to look at, on the device."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import positive
from ..camera.camera import Camera, Point
from ..camera.viewpoint import default_camera
from ..device.device import Device
from ..drawing.exaggeration import ExaggeratedTerrain
from ..drawing.sky_light import SkyLight
from ..ground.exaggeration import exaggerated
from ..ground.heightmap import Heightmap
from ..ground.place import said_place
from ..measure.error import vertical_error
from ..measure.screen_error import screen_error
from ..mesh.mesh import Mesh
from ..mesh.stretched import stretched
from ..terrain.steady import Steady
from ..terrain.terrain import Terrain
from .colours import (
    Paint,
    by_deviation,
    by_error,
    by_height,
    by_normal,
    by_patches,
    paper,
)
from .rig import ground_seen, height_at
from .scene import Frame, Pick, Request, Scene, numbered
from .terrain_settings import TerrainSettings

# samples beyond which many small tiles cost more than they save, and the tiles of such ground
_LARGE: Final = 2**22
_LARGE_TILE: Final = 8


@dataclass(frozen=True)
class Measured:
    """The largest error of a mesh, measured at every sample it covers.

    Attributes
    ----------
    metres : float
        Vertical, in the raster's unit.
    pixels : float or None
        In the picture; None if it was not measured.
    unit : str
        The symbol of the raster's.
    """

    metres: float
    pixels: float | None
    unit: str = "m"

    def __str__(self) -> str:
        pixels = "" if self.pixels is None else f", {self.pixels:.3g} pixels"
        return f"{self.metres:.3g} {self.unit}{pixels}"


@dataclass(frozen=True)
class TilePick(Pick):
    """What is known of a place on the ground.

    Attributes
    ----------
    tile : (int, int)
        Row and column.
    place : tuple of str
        Where that is, in degrees where they are known, and in the raster's own coordinates.
    height : float
        In truth, however high it is drawn.
    edge_factors : tuple of float
        West, north, east, south; 0 where the patch was culled.
    inside_factors : tuple of float
        Along east and south.
    normal : (float, float, float)
        Of the tile's plane.
    deviation : float
        From that plane.
    """

    tile: tuple[int, int]
    place: tuple[str, ...]
    height: float
    edge_factors: tuple[float, ...]
    inside_factors: tuple[float, ...]
    normal: tuple[float, ...]
    deviation: float
    unit: str = "m"

    def lines(self) -> tuple[str, ...]:
        return (
            f"tile {self.tile[0]}, {self.tile[1]}  height {self.height:,.2f} {self.unit}",
            *self.place,
            f"factors {numbered(self.edge_factors)}  inside {numbered(self.inside_factors)}",
            f"plane {numbered(self.normal, 3)}  deviation {self.deviation:.3g} {self.unit}",
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class TerrainFrame(Frame):
    """Ground to be drawn.

    Attributes
    ----------
    settings : TerrainSettings
        Those of the request.
    scene : TerrainScene
    sky_light : SkyLight or None
        On the ground as it is drawn; None where it is off.
    true_mesh : Mesh
        With heights as they are, where `mesh` is drawn with exaggerated ones.
    terrain : Terrain
        Of the true ground.
    error : Measured or None
        None until it is measured.
    """

    settings: TerrainSettings
    scene: TerrainScene
    sky_light: SkyLight | None
    true_mesh: Mesh
    terrain: Terrain
    error: Measured | None = None

    def facts(self) -> tuple[str, ...]:
        tall = self.scene.exaggeration
        drawn = () if tall == 1 else (f"heights drawn {tall:g} times as high",)
        return (f"largest error {self.error or 'being measured'}", *drawn)

    def headline(self) -> str:
        asked = self.settings.asked()
        error = f"error {self.error}" if self.error else "error being measured"
        wanted = f" (asked: {asked})" if asked else ""
        tall = "" if self.scene.exaggeration == 1 else f"; heights × {self.scene.exaggeration:g}"
        return f"{super().headline()}, {error}{wanted}{tall}"

    def painted(self) -> Paint:
        mesh, sun, ground = self.mesh, self.sun, self.terrain.ground
        unit = ground.unit_symbols[1]
        match self.settings.mode:
            case "wireframe":
                return paper(mesh)
            case "lod" | "size" | "factor" as style:
                return by_patches(mesh, sun, style)
            case "deviation":
                assert mesh.patches is not None
                found = self.terrain.analysis.deviation
                deviations = mesh.patches.largest_on_tiles(found)
                rough = self.terrain.scene.rough_deviation
                return by_deviation(mesh, sun, deviations, self.triangle_offsets, rough, unit)
            case "error":
                device = self.terrain.device
                field = vertical_error(self.true_mesh, ground, field=True, device=device).field
                assert field is not None
                return by_error(mesh, sun, field, ground)
            case "normals":
                return by_normal(mesh)
        return by_height(
            mesh,
            sun,
            ground,
            ground.height_range,
            exaggeration=self.scene.exaggeration,
            sky_light=self.sky_light,
        )

    def measured(self) -> TerrainFrame:
        """Return the frame with its error, measured where the mesh did not bring it."""
        if self.error is not None and self.error.pixels is not None:
            return self
        ground, device = self.terrain.ground, self.terrain.device
        metres = vertical_error(self.true_mesh, ground, device=device).maximum
        shown = self.scene.shown
        pixels = screen_error(self.mesh, shown, self.request.camera, device=device).maximum
        return replace(self, error=Measured(metres, pixels, ground.unit_symbols[1]))

    def pick(self, camera: Camera, x: float, y: float) -> TilePick | None:
        place = ground_seen(self.scene.shown, camera, x, y)
        return None if place is None else self.at(place[0], place[1])

    def at(self, x: float, y: float) -> TilePick:
        """Return what is known of the ground at a world point, or at the nearest of its border."""
        terrain, ground, grid = self.terrain, self.terrain.ground, self.terrain.grid
        row = (ground.origin[1] - y) / ground.spacing[1]
        column = (x - ground.origin[0]) / ground.spacing[0]
        tile = _tile(grid.corner_rows, row), _tile(grid.corner_columns, column)
        patches = self.mesh.patches
        assert patches is not None  # meshes of a terrain have them
        index = patches.on_tiles(np.arange(patches.count))[tile]
        edges, insides = (
            (0.0,) * factors.shape[1] if np.isnan(index) else tuple(factors[int(index)].tolist())
            for factors in (self.edge_factors, self.inside_factors)
        )
        return TilePick(
            point=(x, y, height_at(self.scene.shown, x, y)),
            tile=tile,
            place=said_place(ground.crs, x, y, ground.unit_symbols[0]),
            height=height_at(ground, x, y),
            edge_factors=edges,
            inside_factors=insides,
            normal=tuple(terrain.analysis.normal[tile].tolist()),
            deviation=float(terrain.analysis.deviation[tile]),
            unit=ground.unit_symbols[1],
        )


class TerrainScene(Scene):
    """Ground to look at.

    Parameters
    ----------
    ground : Heightmap
    levels : int, optional
        As for :class:`terrain_lod.Terrain`.
    exaggeration : float, optional
        How many times as high heights are drawn. The viewer's world is what is drawn: its cameras
        stand there.
    device : Device, optional

    Attributes
    ----------
    ground, shown : Heightmap
        As it is, and as it is drawn.

    Raises
    ------
    InputError
        If the exaggeration is not above 0.
    """

    settings: TerrainSettings

    def __init__(
        self,
        ground: Heightmap,
        *,
        levels: int | None = None,
        exaggeration: float = 1.0,
        device: Device | None = None,
    ) -> None:
        self.ground, self.levels, self.device = ground, levels, Device.of(device)
        self.exaggeration = positive("exaggeration", exaggeration)
        self.shown = exaggerated(ground, self.exaggeration)
        self.centre, self.unit = self.shown.centre, ground.unit_symbols[0]
        self.diagonal = float(np.hypot(*ground.extent))
        self.settings = TerrainSettings(diagonal=self.diagonal)
        if ground.heights.size > _LARGE:
            self.settings = self.settings.with_tile(_LARGE_TILE)
        self._terrain: Terrain | None = None
        self._drawn: ExaggeratedTerrain | None = None
        self._steady = Steady()

    def camera(self) -> Camera:
        seen = default_camera(self.ground, exaggeration=self.exaggeration)
        return seen.lifted(self.exaggeration)

    def floor(self, x: float, y: float) -> float:
        return height_at(self.shown, x, y)

    def shows_fronts_alone(self, eye: Point) -> bool:
        """Return whether an eye above the ground looks over it, not through its border or holes."""
        (x, y), (width, depth) = self.ground.origin, self.ground.extent
        over = x <= eye[0] <= x + width and y - depth <= eye[1] <= y
        return self.ground.mask is None and (over or eye[2] > self.shown.height_range[1])

    def terrain(self, tile: int) -> Terrain:
        """Return the ground's terrain with tiles of `tile` cells, made when that changes."""
        if self._terrain is None or self._terrain.grid.tile != tile:
            self._terrain = Terrain(self.ground, tile=tile, levels=self.levels, device=self.device)
            self._drawn = ExaggeratedTerrain(self._terrain, self.exaggeration)
        return self._terrain

    def tessellated(self, request: Request) -> TerrainFrame:
        settings = request.settings
        assert isinstance(settings, TerrainSettings)
        terrain = self.terrain(settings.tile)
        assert self._drawn is not None  # made with the terrain
        true_mesh = self._drawn.mesh(
            request.camera.lifted(1 / self.exaggeration),
            lod=settings.detail(),
            edge_rule=settings.usable_edge_rule,
            partitioning=settings.partitioning,
            steady=self._steady if settings.can_be_steady else None,
        )
        mesh = stretched(true_mesh, self.exaggeration)
        patches, achieved = mesh.patches, true_mesh.achieved
        assert patches is not None
        return TerrainFrame(
            request=request,
            scene=self,
            mesh=mesh,
            sky_light=self._drawn.sky_light() if settings.sky_light else None,
            true_mesh=true_mesh,
            edge_factors=patches.edge_factors,
            inside_factors=patches.inside_factors,
            triangle_offsets=patches.triangle_offsets,
            settings=settings,
            terrain=terrain,
            error=None
            if achieved is None
            else Measured(achieved.metres, achieved.pixels, terrain.ground.unit_symbols[1]),
        )


def _tile(corners: npt.NDArray[np.int64], position: float) -> int:
    return int(np.clip(np.searchsorted(corners, position, "right") - 1, 0, len(corners) - 2))
