"""Maps from above for a report: ground, deviation, detail and error. Needs no OpenGL."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from ..camera.camera import Camera
from ..device.layout import MAX_TILE
from ..drawing.colours import LOD_STOPS, hypsometric, lit, sun_direction
from ..ground.grid import TileGrid
from ..ground.heightmap import Heightmap
from ..paths import replacing
from ..terrain.lod import unweighted
from .comparison import Comparison, Trial

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Values = npt.NDArray[Any]

_LARGEST: Final = 800  # pixels along a side of a map; larger rasters are thinned
_NOTHING: Final = "0.87"  # grey where no patch is drawn

STYLE: Final = {
    "svg.hashsalt": "terrain_lod",  # the same names in the file every time
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.titlelocation": "left",
    "axes.linewidth": 0.6,
    "axes.facecolor": _NOTHING,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "image.cmap": "cividis",
    "image.interpolation": "none",
}


def save_maps(comparison: Comparison, path: Path) -> Path:
    """Write six maps of the compared ground as SVG: the same bytes for the same numbers."""
    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        sheet = _Sheet.over(comparison.terrain.ground)
        figure = Figure(figsize=sheet.figure_size, layout="constrained")
        FigureCanvasSVG(figure)
        _draw_maps(figure, sheet, comparison)
        with replacing(path) as temporary:
            figure.savefig(temporary, format="svg", metadata={"Date": None, "Creator": None})
    return path


def factor_range(comparison: Comparison) -> tuple[float, float]:
    """Return the factors that the ramp runs between: what both levels of detail may give."""
    lods = (comparison.distance.lod, comparison.other.lod)
    low = min(float(getattr(unweighted(lod), "minimum", 1.0)) for lod in lods)
    high = max(float(getattr(unweighted(lod), "maximum", None) or MAX_TILE) for lod in lods)
    tile = max(trial.terrain.grid.tile for trial in comparison.trials)
    return low, max(min(high, tile), low + 1)


@dataclass(frozen=True)
class _Sheet:
    """Which samples a map shows, and where."""

    ground: Heightmap
    rows: npt.NDArray[np.int64]
    columns: npt.NDArray[np.int64]
    unit: str
    scale: float  # of that unit to world units

    @classmethod
    def over(cls, ground: Heightmap) -> _Sheet:
        rows, columns = (np.arange(0, count, -(-count // _LARGEST)) for count in ground.shape)
        unit = ground.unit_symbols[0]
        kilometres = unit == "m" and max(ground.extent) >= 5000
        return cls(ground, rows, columns, *(("km", 1e3) if kilometres else (unit, 1.0)))

    @property
    def figure_size(self) -> tuple[float, float]:
        """Inches: two maps wide, three high, each as high as the ground asks."""
        width, depth = self.ground.extent
        return 11.0, 3 * (0.45 + min(max(4.3 * depth / width, 1.0), 8.0)) + 0.3

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Left, right, bottom, top of the map, from the north-western sample."""
        width, depth = (extent / self.scale for extent in self.ground.extent)
        return 0.0, width, -depth, 0.0

    def of_samples(self, values: Values) -> Values:
        """Thin (R, C, ...) values."""
        return values[np.ix_(self.rows, self.columns)]

    def of_tiles(self, values: Values, grid: TileGrid) -> Values:
        """Spread (TR, TC) values over the samples of each tile."""
        rows = np.searchsorted(grid.corner_rows[1:-1], self.rows, side="right")
        columns = np.searchsorted(grid.corner_columns[1:-1], self.columns, side="right")
        return values[np.ix_(rows, columns)]


def _draw_maps(figure: Figure, sheet: _Sheet, comparison: Comparison) -> None:
    grid, analysis = comparison.terrain.grid, comparison.terrain.analysis
    axes = figure.subplots(3, 2, sharex=True, sharey=True)
    _draw_ground(axes[0, 0], sheet, comparison.camera)

    deviation = sheet.of_tiles(analysis.deviation, grid)
    title = f"Deviation from its plane, tiles of {grid.tile} cells"
    _draw(axes[0, 1], sheet, deviation, title, sheet.ground.unit_symbols[1], vmin=0)

    low, high = factor_range(comparison)
    look = {"cmap": lod_colour_map(), "vmin": low, "vmax": high}
    for ax, trial in zip(axes[1], (comparison.distance, comparison.other), strict=True):
        factors = sheet.of_tiles(_inside_factors(trial), trial.terrain.grid)
        _draw(ax, sheet, factors, _title(trial, "inside factor"), "segments", **look)

    # one scale for both; the worst percent is beyond it
    pair = (comparison.equal_triangles or comparison.asked)[:2]
    errors = [np.abs(sheet.of_samples(_error_field(trial))) for trial in pair]
    known = np.concatenate([error[~np.isnan(error)] for error in errors])
    worst = float(np.percentile(known, 99)) if len(known) else 0.0
    look = {"cmap": "magma_r", "vmin": 0, "vmax": worst or 1.0}
    for ax, trial, error in zip(axes[2], pair, errors, strict=True):
        unit = sheet.ground.unit_symbols[1]
        _draw(ax, sheet, error, _title(trial, "vertical error"), unit, extend="max", **look)
    figure.supxlabel(f"{sheet.unit} east of the north-western corner", fontsize=9)
    figure.supylabel(f"{sheet.unit} north of it", fontsize=9)


def _draw(
    ax: Axes,
    sheet: _Sheet,
    values: Values,
    title: str,
    unit: str,
    *,
    extend: str = "neither",
    **look: Any,
) -> None:
    """Show one value a pixel, with its scale beside it; no value is grey."""
    image = ax.imshow(np.ma.masked_invalid(values), extent=sheet.box, **look)
    ax.set_title(title)
    ax.figure.colorbar(image, ax=ax, label=unit, extend=extend, shrink=0.92, pad=0.015)


def _draw_ground(ax: Axes, sheet: _Sheet, camera: Camera) -> None:
    """Show the ground as a shaded relief, and what the camera covers of it."""
    ground = sheet.ground
    (dx, dy), heights = ground.spacing, sheet.of_samples(ground.heights)
    # steps between the samples shown
    steps = (sheet.rows[1] - sheet.rows[0]) * dy, (sheet.columns[1] - sheet.columns[0]) * dx
    south, east = np.gradient(heights.astype(np.float64), *steps)
    normals = np.stack([-east, south, np.ones_like(east)], axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    flat = normals.reshape(-1, 3).astype(np.float32)
    elevations = heights.ravel() + np.float32(ground.base)
    relief = lit(hypsometric(elevations, flat, ground.height_range), flat, sun_direction(315, 45))
    holes = ~sheet.of_samples(ground.valid)[..., None]
    ax.imshow(np.where(holes, 0.87, relief.reshape(*heights.shape, 3)), extent=sheet.box)
    ax.set_title("Ground, and what the camera looks at")

    for colour, width in (("white", 2.6), ("black", 1.2)):
        ax.plot(*_footprint(sheet, camera), color=colour, linewidth=width)
    eye = np.subtract(camera.eye[:2], ground.origin) / sheet.scale
    left, right, bottom, top = sheet.box
    inside = left <= eye[0] <= right and bottom <= eye[1] <= top
    ax.plot(*eye, "o", color="black", markeredgecolor="white", markersize=6, clip_on=not inside)
    ax.set(xlim=sheet.box[:2], ylim=sheet.box[2:])


def _footprint(sheet: _Sheet, camera: Camera) -> Values:
    """Return the picture's outline on the level of the lowest ground; (2, 5) in map units.

    A corner that looks above the horizon stands for ground three times as far as there is any.
    """
    ground, (right, upward, forward) = sheet.ground, camera.axes
    across, up = camera.half_extents
    x, y = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]).T[..., None]
    corners = x * across * right + y * up * upward  # from the middle of the picture
    parallel = camera.height is not None
    starts = camera.eye + corners * parallel
    rays = forward + corners * (not parallel)
    with np.errstate(divide="ignore", invalid="ignore"):
        reach = 3 * np.hypot(*ground.extent) / np.linalg.norm(rays[:, :2], axis=1)
        depth = (ground.height_range[0] - starts[:, 2]) / rays[:, 2]
    depth = np.where(depth > 0, np.minimum(depth, reach), reach)
    points = starts[:, :2] + depth[:, None] * rays[:, :2]
    outline: Values = ((points - ground.origin) / sheet.scale).T
    return outline


def lod_colour_map() -> Any:
    """Return the ramp of the LOD pictures for matplotlib."""
    from matplotlib.colors import LinearSegmentedColormap

    stops = [(position, colour) for position, *colour in LOD_STOPS]
    return LinearSegmentedColormap.from_list("lod", stops)


def _title(trial: Trial, what: str) -> str:
    return f"{trial.title}, {trial.triangles:,} triangles: {what}"


def _inside_factors(trial: Trial) -> Values:
    """Return a factor a tile, (TR, TC); NaN where no triangle is drawn."""
    patches = trial.mesh.patches
    assert patches is not None  # meshes of a terrain have them
    factors = np.where(patches.drawn, patches.inside_factors.mean(axis=1), np.nan)
    return patches.on_tiles(factors)


def _error_field(trial: Trial) -> Values:
    assert trial.error.field is not None  # asked for in every trial
    return trial.error.field
