"""The numbers of a report, each with its unit: rows that CSV, JSON and HTML are made from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import Final

import numpy as np

from ..device.layout import CONTROL_POINTS
from .comparison import Comparison, Trial, device_bytes

Value = int | float | None

# of a vertex of listing 9.1: position and texture coordinate; of an index, of a height, of a tile
# of the coplanarity table
_VERTEX_BYTES: Final = 20
_SHORT_INDEX_BYTES: Final = 2
_INDEX_BYTES: Final = 4
_HEIGHT_BYTES: Final = 4
_LOOKUP_BYTES: Final = 16


@dataclass(frozen=True)
class Row:
    """One quantity of every trial.

    Attributes
    ----------
    table : str
        ``"result"``, ``"stages"``, ``"storage"`` or ``"time"``.
    key : str
        In JSON and CSV.
    label : str
        For people.
    unit : str
    values : tuple of int, float or None
        A trial each; None where there is none.
    """

    table: str
    key: str
    label: str
    unit: str
    values: tuple[Value, ...]


def rows_of(comparison: Comparison) -> list[Row]:
    """Return every quantity of a comparison, in the order of the report."""
    return [
        *_result(comparison),
        *_stages(comparison),
        *_storage(comparison),
        *_times(comparison),
    ]


def _row(
    comparison: Comparison,
    table: str,
    key: str,
    label: str,
    unit: str,
    value: Callable[[Trial], Value],
) -> Row:
    return Row(table, key, label, unit, tuple(value(trial) for trial in comparison.trials))


def _result(comparison: Comparison) -> list[Row]:
    def row(key: str, label: str, unit: str, value: Callable[[Trial], Value]) -> Row:
        return _row(comparison, "result", key, label, unit, value)

    up = comparison.terrain.ground.unit_symbols[1]
    return [
        row("triangles", "Triangles drawn", "", lambda t: t.triangles),
        row(
            "rasterised_share",
            "… of them facing the camera and in view",
            "%",
            lambda t: 100 * rasterised_share(comparison, t),
        ),
        row("error_max", "Vertical error, largest", up, lambda t: _known(t.error.maximum)),
        row("error_rms", "Vertical error, RMS", up, lambda t: _known(t.error.rms)),
        row(
            "error_mean",
            "Vertical error, mean (above the ground: +)",
            up,
            lambda t: _known(t.error.mean),
        ),
        row("samples", "Samples measured", "", lambda t: t.error.samples),
        row("pixels_max", "Error in the picture, largest", "px", lambda t: _known(t.seen.maximum)),
        row("pixels_rms", "Error in the picture, RMS", "px", lambda t: _known(t.seen.rms)),
        row("factor_mean", "Inside factor, mean of drawn patches", "", _mean_factor),
    ]


def _stages(comparison: Comparison) -> list[Row]:
    """Return what each stage of section 9.1.1 is called for."""

    def row(key: str, label: str, value: Callable[[Trial], Value]) -> Row:
        return _row(comparison, "stages", key, label, "", value)

    return [
        row("draw_calls", "Draw calls", lambda t: 1),
        row("patches", "Patches", _patches),
        row("patches_culled", "… of them not drawn: out of view, or no data", _culled),
        row(
            "vertex_invocations",
            "Vertex shader invocations",
            lambda t: CONTROL_POINTS * _patches(t),
        ),
        row("hull_constant_invocations", "Hull constant function invocations", _patches),
        row("hull_point_invocations", "Hull control point invocations", lambda t: 4 * _patches(t)),
        row("domain_invocations", "Domain stage invocations", lambda t: len(t.mesh.vertices)),
        row("triangles_generated", "Triangles generated", lambda t: t.triangles),
    ]


def _storage(comparison: Comparison) -> list[Row]:
    """Return bytes: as Direct3D 11 in the book's formats, as a plain mesh, and as held here."""
    grid, (rows, columns) = comparison.terrain.grid, comparison.terrain.ground.shape
    corners = (grid.shape[0] + 1) * (grid.shape[1] + 1)
    index_bytes = _SHORT_INDEX_BYTES if corners <= 2**16 else _INDEX_BYTES
    vertex_buffer = corners * _VERTEX_BYTES
    index_buffer = grid.count * CONTROL_POINTS * index_bytes
    texture = rows * columns * _HEIGHT_BYTES

    def lookup(trial: Trial) -> int:
        return grid.count * _LOOKUP_BYTES if "coplanarity" in trial.name else 0

    def row(key: str, label: str, value: Callable[[Trial], Value]) -> Row:
        return _row(comparison, "storage", key, label, "bytes", value)

    held = {trial.name: device_bytes(trial.terrain, trial.mesh) for trial in comparison.trials}
    return [
        row("vertex_buffer", f"Vertex buffer: {corners:,} corners", lambda t: vertex_buffer),
        row("index_buffer", f"Index buffer: {CONTROL_POINTS} a patch", lambda t: index_buffer),
        row("height_texture", f"Height texture: {rows:,} × {columns:,}", lambda t: texture),
        row("lookup_texture", "Coplanarity texture: one texel a tile", lookup),
        row(
            "tessellated_total",
            "In all, whatever is drawn",
            lambda t: vertex_buffer + index_buffer + texture + lookup(t),
        ),
        row("mesh_buffers", "The same triangles as vertex and index buffer", _mesh_bytes),
        row(
            "device_terrain",
            "Held on the device here: ground, tiles, patches",
            lambda t: held[t.name]["terrain"],
        ),
        row(
            "device_mesh",
            "Held on the device here: factors, points, triangles",
            lambda t: held[t.name]["mesh"],
        ),
    ]


def _times(comparison: Comparison) -> list[Row]:
    def row(key: str, label: str, value: Callable[[Trial], Value]) -> Row:
        return _row(comparison, "time", key, label, "s", value)

    stages = dict.fromkeys(stage for trial in comparison.trials for stage in trial.seconds)
    return [
        *(row(f"seconds_{stage}", stage.capitalize(), _seconds(stage)) for stage in stages),
        row("seconds_total", "All stages: median of the runs", lambda t: median(t.totals)),
        row("seconds_least", "… the fastest run", lambda t: t.totals[0]),
        row("seconds_most", "… the slowest run", lambda t: t.totals[-1]),
    ]


def _seconds(stage: str) -> Callable[[Trial], Value]:
    return lambda trial: trial.seconds.get(stage)


def rasterised_share(comparison: Comparison, trial: Trial) -> float:
    """Return the share of a trial's triangles that face the camera and touch the picture."""
    camera, mesh = comparison.camera, trial.mesh
    if not trial.triangles:
        return 0.0
    pixels, depth = camera.project(mesh.vertices + mesh.origin)
    a, b, c = (mesh.vertices[mesh.triangles[:, corner]] for corner in range(3))
    towards_eye = np.subtract(camera.eye, mesh.origin) - a
    if camera.height is not None:  # parallel
        towards_eye = -camera.axes[2]
    facing = (np.cross(b - a, c - a) * towards_eye).sum(axis=1) > 0
    # outside where all three corners are beyond the same side of the picture or behind the eye
    behind = depth <= camera.near
    sides = [
        pixels[:, 0] < 0,
        pixels[:, 0] > camera.size[0],
        pixels[:, 1] < 0,
        pixels[:, 1] > camera.size[1],
    ]
    outside = behind[mesh.triangles].all(axis=1)
    for side in sides:
        outside |= (side & ~behind)[mesh.triangles].all(axis=1)
    return float(np.mean(facing & ~outside))


def _known(value: float) -> float | None:
    return None if np.isnan(value) else value


def _patches(trial: Trial) -> int:
    assert trial.mesh.patches is not None  # meshes of a terrain have them
    return trial.mesh.patches.count


def _culled(trial: Trial) -> int:
    return 0 if trial.mesh.patches is None else trial.mesh.patches.culled_count


def _mean_factor(trial: Trial) -> float | None:
    patches = trial.mesh.patches
    if patches is None or not patches.drawn.any():
        return None
    return float(patches.inside_factors[patches.drawn].mean())


def _mesh_bytes(trial: Trial) -> int:
    return len(trial.mesh.vertices) * _VERTEX_BYTES + 3 * trial.triangles * _INDEX_BYTES
