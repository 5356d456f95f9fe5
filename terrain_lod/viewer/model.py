"""What a viewer shows: a mesh in its colours, and what is known about it. Draws nothing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter

import numpy as np
import numpy.typing as npt

from ..camera import Camera
from ..device import Device
from ..errors import InputError
from ..heightmap import Heightmap
from ..measure.error import vertical_error
from ..measure.screen_error import screen_error
from ..mesh import Mesh
from ..terrain import Terrain
from . import viewer_colours as paint
from .settings import Settings
from .viewer_camera import height_at


@dataclass(frozen=True)
class Request:
    """A picture that is wanted: of the LOD for this camera, with these settings."""

    camera: Camera
    settings: Settings
    number: int = 0


@dataclass(frozen=True)
class Measured:
    """The largest error of a mesh, measured at every sample it covers.

    Attributes
    ----------
    metres : float
        Vertical, in the raster's unit.
    pixels : float or None
        In the picture; None if it was not measured.
    """

    metres: float
    pixels: float | None


@dataclass(frozen=True)
class Pick:
    """What is known of a place on the ground.

    Attributes
    ----------
    point : (float, float, float)
        In world units, on the ground.
    tile : (int, int)
        Row and column.
    edge_factors : tuple of float
        West, north, east, south; 0 where the patch was culled.
    inside_factors : tuple of float
        Along east and south.
    normal : (float, float, float)
        Of the tile's plane.
    deviation : float
        From that plane.
    """

    point: tuple[float, float, float]
    tile: tuple[int, int]
    edge_factors: tuple[float, ...]
    inside_factors: tuple[float, ...]
    normal: tuple[float, float, float]
    deviation: float

    def lines(self) -> tuple[str, ...]:
        """Return what is known, a line each."""
        x, y, z = self.point
        return (
            f"tile {self.tile[0]}, {self.tile[1]}  height {z:,.2f} m at {x:,.1f}, {y:,.1f}",
            f"factors {_row(self.edge_factors)}  inside {_row(self.inside_factors)}",
            f"plane {_row(self.normal, 3)}  deviation {self.deviation:.3g} m",
        )


@dataclass(frozen=True, eq=False)
class Frame:
    """What is to be drawn.

    Attributes
    ----------
    request : Request
        What it answers.
    terrain : Terrain
        What the mesh was made of.
    mesh : Mesh
    paint : Paint
    engine_seconds, paint_seconds : float
        Wall time of the mesh and of its colours.
    error : Measured or None
        None until it is measured.
    """

    request: Request
    terrain: Terrain
    mesh: Mesh
    paint: paint.Paint
    engine_seconds: float
    paint_seconds: float
    error: Measured | None

    def lines(self) -> tuple[str, ...]:
        """Return the read-out, a line each."""
        patches, settings = self.mesh.patches, self.request.settings
        assert patches is not None
        stages = ", ".join(f"{name} {1e3 * s:.1f}" for name, s in self.mesh.timings.items())
        frozen = "  FROZEN" if settings.frozen else ""
        detail = settings.lod if settings.tessellated else "not tessellated"
        return (
            f"{detail}, {settings.partitioning}, edges {settings.edge_rule}, "
            f"tiles of {settings.tile}{frozen}",
            f"{len(self.mesh.triangles):,} triangles",
            f"{patches.count - patches.culled_count:,} patches drawn, "
            f"{patches.culled_count:,} culled",
            f"largest error {self._error()}",
            f"mesh {1e3 * self.engine_seconds:.0f} ms, colours {1e3 * self.paint_seconds:.0f} ms",
            f"device ms: {stages}",
            f"{settings.mode}: {self.paint.legend}",
        )

    def _error(self) -> str:
        if self.error is None:
            return "being measured"
        pixels = "" if self.error.pixels is None else f", {self.error.pixels:.3g} pixels"
        return f"{self.error.metres:.3g} m{pixels}"

    def pick(self, x: float, y: float) -> Pick:
        """Return what is known of the ground at a world point.

        Raises
        ------
        InputError
            If the point is outside the ground.
        """
        ground, grid, patches = self.terrain.ground, self.terrain.grid, self.mesh.patches
        assert patches is not None
        column = (x - ground.origin[0]) / ground.spacing[0]
        row = (ground.origin[1] - y) / ground.spacing[1]
        rows, columns = ground.shape
        slack = 1e-6  # cells
        if not (-slack <= row <= rows - 1 + slack and -slack <= column <= columns - 1 + slack):
            raise InputError(f"expected a point on the ground, got {x:g}, {y:g}")
        tile = _tile(grid.corner_rows, row), _tile(grid.corner_columns, column)
        index = tile[0] * patches.shape[1] + tile[1]
        normal = self.terrain.analysis.normal[tile]
        return Pick(
            point=(x, y, height_at(ground, x, y)),
            tile=tile,
            edge_factors=tuple(float(factor) for factor in patches.edge_factors[index]),
            inside_factors=tuple(float(factor) for factor in patches.inside_factors[index]),
            normal=(float(normal[0]), float(normal[1]), float(normal[2])),
            deviation=float(self.terrain.analysis.deviation[tile]),
        )


def _row(values: tuple[float, ...], digits: int = 1) -> str:
    return " ".join(f"{value:.{digits}f}" for value in values)


class Model:
    """The ground that is looked at, and its terrain on the device.

    Parameters
    ----------
    load : callable
        Returns the ground; called again by :meth:`reload`.
    path : Path, optional
        The file that it is read from.
    device : Device, optional

    Raises
    ------
    TerrainError
        Whatever `load` raises.
    """

    def __init__(
        self,
        load: Callable[[], Heightmap],
        *,
        path: Path | None = None,
        device: Device | None = None,
    ) -> None:
        self._load, self._path = load, path
        self.device = device or Device.open()
        self._read_at = self._modified()
        self.ground = load()
        self._terrain: Terrain | None = None

    def settings(self) -> Settings:
        """Return settings to begin with."""
        return Settings(diagonal=float(np.hypot(*self.ground.extent)))

    def reload(self) -> None:
        """Read the ground again; what was read before stays if that fails."""
        self._read_at = self._modified()
        self.ground = self._load()

    def news(self) -> str | None:
        """Return a line if the ground's file is not what was read, once for each change."""
        modified = self._modified()
        if modified == self._read_at:
            return None
        self._read_at = modified
        if modified is None:
            return f"{self._path} is gone: what was read from it stays"
        return f"{self._path} has changed: u reads it again"

    def _modified(self) -> int | None:
        if self._path is None:
            return None
        try:
            return self._path.stat().st_mtime_ns
        except OSError:
            return None

    def terrain(self, tile: int) -> Terrain:
        """Return the present ground's terrain with tiles of `tile` cells, made when it changes."""
        known = self._terrain
        if known is None or known.ground is not self.ground or known.grid.tile != tile:
            known = self._terrain = Terrain(self.ground, tile=tile, device=self.device)
        return known

    def frame(self, request: Request) -> Frame:
        """Return what answers a request.

        Raises
        ------
        TerrainError
            If the level of detail cannot be made; see :meth:`Terrain.mesh`.
        """
        settings = request.settings
        begun = perf_counter()
        terrain = self.terrain(settings.tile)
        mesh = terrain.mesh(
            request.camera,
            lod=settings.detail(),
            edges=settings.edge_rule,
            partitioning=settings.partitioning,
        )
        meshed = perf_counter()
        colours = self._paint(mesh, settings, terrain)
        error = None
        if mesh.achieved is not None:
            error = Measured(mesh.achieved.metres, mesh.achieved.pixels)
        painted = perf_counter()
        return Frame(request, terrain, mesh, colours, meshed - begun, painted - meshed, error)

    def measured(self, frame: Frame) -> Frame:
        """Return the frame with its error, measured where the mesh did not bring it."""
        if frame.error is not None and frame.error.pixels is not None:
            return frame
        ground = frame.terrain.ground
        metres = vertical_error(frame.mesh, ground, device=self.device).maximum
        camera = frame.request.camera
        pixels = screen_error(frame.mesh, ground, camera, device=self.device).maximum
        return replace(frame, error=Measured(metres, pixels))

    def _paint(self, mesh: Mesh, settings: Settings, terrain: Terrain) -> paint.Paint:
        sun = settings.azimuth, settings.elevation
        match settings.mode:
            case "wireframe":
                return paint.paper(mesh)
            case "lod":
                return paint.by_detail(mesh, sun)
            case "deviation":
                return paint.by_deviation(mesh, sun, terrain.scene.rough_deviation)
            case "error":
                field = vertical_error(mesh, terrain.ground, field=True, device=self.device).field
                assert field is not None
                return paint.by_error(mesh, sun, field)
            case "normals":
                return paint.by_normal(mesh)
        return paint.shaded(mesh, sun, terrain.ground.height_range)


def frustum(camera: Camera, reach: float) -> npt.NDArray[np.float64]:
    """Return the eye and the corners of the picture at depth `reach`; (5, 3), world units.

    The corners go round: lower left, lower right, upper right, upper left.
    """
    right, upward, forward = camera.axes
    width, height = camera.half_extents
    eye = np.array(camera.eye)
    corners = [
        eye + reach * (forward + across * width * right + up * height * upward)
        for across, up in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]
    return np.stack([eye, *corners])


def _tile(corners: npt.NDArray[np.int64], position: float) -> int:
    return int(np.clip(np.searchsorted(corners, position, "right") - 1, 0, len(corners) - 2))
