"""Every contender measured in the same way, from its triangles, over the same cameras."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from statistics import median
from typing import Final

import numpy as np
import numpy.typing as npt

from ...camera.camera import Camera
from ...camera.path import flyover
from ...device.device import Device
from ...ground.heightmap import Heightmap
from ...measure.error import vertical_error
from ...measure.screen_error import jumps, seen_error
from ...mesh.mesh import Mesh
from ...terrain.terrain import Terrain
from ..comparison import device_bytes
from .sweep import Contender

# a view's neighbour on the way, for how far the surface pops between two pictures
_PICTURES: Final = 240
_REPEATS: Final = 3
_LONG: Final = 1.5  # seconds, from which on once is enough
_CLEAR_PEAK: Final = "5"
# share of an asked error by which a peer may exceed it
_FORGIVEN: Final = 1e-3

Field = npt.NDArray[np.float32]


@dataclass(frozen=True)
class Times:
    """What differs from run to run.

    Attributes
    ----------
    first : float
        Seconds of the first call, raster in host memory to mesh in host memory.
    whole, whole_low, whole_high : float
        The same warm: median, least and most.
    view, view_low, view_high : float or None
        Seconds of one more camera, the terrain being there; None for a peer.
    peak_bytes : int or None
        Host memory taken at most, above what was held before; None where the system does not tell.
    """

    first: float
    whole: float
    whole_low: float
    whole_high: float
    view: float | None
    view_low: float | None
    view_high: float | None
    peak_bytes: int | None


@dataclass(frozen=True)
class Result:
    """What came of one contender. Of several views: the worst, or of all samples together.

    Attributes
    ----------
    contender : Contender
    triangles : int
        Median over the views.
    metres, metres_rms, pixels, pixels_rms : float
        Largest and RMS error, vertical and in the picture; NaN where nothing was in view.
    pop, pop_rms : float
        Pixels that the surface jumps from a view to the next picture.
    uncovered : int
        Samples with data under no triangle, of a static mesh.
    mesh_bytes : int
        Positions, normals and corners, the largest mesh.
    device_bytes : int
        Held on the device for terrain, ladder and mesh; 0 for a peer.
    times : Times
    """

    contender: Contender
    triangles: int
    metres: float
    metres_rms: float
    pixels: float
    pixels_rms: float
    pop: float
    pop_rms: float
    uncovered: int
    mesh_bytes: int
    device_bytes: int
    times: Times

    @property
    def broken(self) -> float | None:
        """Measured over asked error where more than was asked for; None where kept or not asked."""
        asked = self.contender.asked_metres or self.contender.asked_pixels
        measured = self.metres if self.contender.asked_metres else self.pixels
        # what rounding its heights to float32 adds is not a peer's fault; ours promise it all
        slack = _FORGIVEN if self.contender.peer is not None else 0.0
        return measured / asked if asked and measured > asked * (1 + slack) else None


class Course:
    """The ground and the cameras that every contender is measured over."""

    def __init__(self, ground: Heightmap, views: int, device: Device) -> None:
        self.ground = ground
        self.device = device
        way = flyover(ground, _PICTURES)
        starts = np.linspace(0, _PICTURES - 2, views).astype(int)
        self.pairs = [(way[start], way[start + 1]) for start in starts]
        self._terrains: dict[tuple[int | None, bool], Terrain] = {}

    @property
    def cameras(self) -> list[Camera]:
        return [camera for camera, _ in self.pairs]

    def terrain(self, tile: int | None, *, flat: bool) -> Terrain:
        """Return the terrain in tiles of `tile`, or as many as is usual; kept."""
        key = tile, flat
        if key not in self._terrains:
            self._terrains[key] = self._made(tile, flat=flat)
        return self._terrains[key]

    def _made(self, tile: int | None, *, flat: bool) -> Terrain:
        return Terrain(self.ground, tile=tile, levels=1 if flat else None, device=self.device)

    def mesh(self, contender: Contender, camera: Camera, terrain: Terrain | None = None) -> Mesh:
        """Return a contender's mesh for a camera."""
        if contender.peer is not None:
            return contender.peer.mesh(self.ground, contender.parameter)
        terrain = terrain or self.terrain(contender.tile, flat=contender.is_flat)
        return terrain.mesh(
            None if contender.is_static else camera,
            lod=contender.lod,
            edge_rule=contender.edge_rule or None,
            partitioning=contender.partitioning or None,
        )

    def measure(self, contender: Contender) -> Result:
        """Time and measure one contender."""
        times, mesh = self._timed(contender)
        if contender.is_static:
            field, uncovered = self._field(mesh)
            frames = [(mesh, field, field)] * len(self.pairs)
        else:
            uncovered, frames = 0, []
            for pair in self.pairs:
                first, second = (self.mesh(contender, camera) for camera in pair)
                frames.append((first, self._field(first)[0], self._field(second)[0]))
        meshes = [mesh for mesh, _, _ in frames]
        largest = max(meshes, key=lambda mesh: len(mesh.triangles))
        held = 0
        if contender.peer is None:
            terrain = self.terrain(contender.tile, flat=contender.is_flat)
            held = sum(device_bytes(terrain, largest).values())
        return Result(
            contender,
            int(median(len(mesh.triangles) for mesh in meshes)),
            *self._errors([before for _, before, _ in frames]),
            *self._pops([(before, after) for _, before, after in frames]),
            uncovered,
            largest.vertices.nbytes + largest.normals.nbytes + largest.triangles.nbytes,
            held,
            times,
        )

    def _field(self, mesh: Mesh) -> tuple[Field, int]:
        found = vertical_error(mesh, self.ground, field=True, device=self.device)
        assert found.field is not None  # asked for
        return found.field, found.uncovered

    def _errors(self, fields: Sequence[Field]) -> tuple[float, float, float, float]:
        """Return largest and RMS error in metres and pixels, over all views."""
        seen = [
            seen_error(field, self.ground, camera)
            for field, camera in zip(fields, self.cameras, strict=True)
        ]
        known = [field[~np.isnan(field)].astype(np.float64) for field in fields]
        metres = np.abs(np.concatenate(known))
        samples = np.array([view.samples for view in seen])
        squares = [view.samples * view.rms**2 for view in seen if view.samples]
        largest = [view.maximum for view in seen if view.samples]
        return (
            float(metres.max(initial=0.0)) if len(metres) else np.nan,
            float(np.sqrt(np.mean(np.square(metres)))) if len(metres) else np.nan,
            max(largest, default=np.nan),
            float(np.sqrt(sum(squares) / samples.sum())) if squares else np.nan,
        )

    def _pops(self, fields: Sequence[tuple[Field, Field]]) -> tuple[float, float]:
        moved = [
            jumps(self.ground, camera, before, after) if before is not after else np.zeros(1)
            for (before, after), (_, camera) in zip(fields, self.pairs, strict=True)
        ]
        every = np.concatenate(moved)
        return float(every.max(initial=0.0)), float(np.sqrt(np.mean(np.square(every))))

    def _timed(self, contender: Contender) -> tuple[Times, Mesh]:
        """Return times from raster to mesh, from nothing and with the terrain there; and a mesh."""
        camera = self.pairs[0][0]

        def whole() -> Mesh:
            terrain = None
            if contender.peer is None:
                terrain = self._made(contender.tile, flat=contender.is_flat)
            return self.mesh(contender, camera, terrain)

        held, _ = _held_and_peak(clear=True)
        first, mesh = _seconds(whole)
        _, peak = _held_and_peak()
        # the first of ours may have built kernels; a peer that takes long is called once
        seconds = [first]
        if contender.peer is None or first <= _LONG:
            seconds = [_seconds(whole)[0]]
            while len(seconds) < _REPEATS and sum(seconds) <= _LONG:
                seconds.append(_seconds(whole)[0])
        view = [] if contender.peer is not None else self._views(contender)
        return Times(
            first=first,
            whole=median(seconds),
            whole_low=min(seconds),
            whole_high=max(seconds),
            view=median(view) if view else None,
            view_low=min(view, default=None),
            view_high=max(view, default=None),
            peak_bytes=None if held is None or peak is None else max(peak - held, 0),
        ), mesh

    def _views(self, contender: Contender) -> list[float]:
        """Return the seconds of a mesh for each camera, the terrain and its ladder being there."""
        self.mesh(contender, self.cameras[0])
        return [_seconds(partial(self.mesh, contender, camera))[0] for camera in self.cameras]


def run(
    course: Course, contenders: Sequence[Contender], step: Callable[[], None] = lambda: None
) -> list[Result]:
    """Measure `contenders` in turn; `step` is called after each."""
    results = []
    for contender in contenders:
        results.append(course.measure(contender))
        step()
    return results


def _seconds(work: Callable[[], Mesh]) -> tuple[float, Mesh]:
    start = time.perf_counter()
    mesh = work()
    return time.perf_counter() - start, mesh


def _held_and_peak(*, clear: bool = False) -> tuple[int | None, int | None]:
    """Return bytes that the process holds, and the most it held since last cleared; on Linux."""
    try:
        if clear:
            Path("/proc/self/clear_refs").write_text(_CLEAR_PEAK)
        lines = Path("/proc/self/status").read_text().splitlines()
    except OSError:
        return None, None
    found = dict(line.split(":", 1) for line in lines if line.startswith(("VmRSS", "VmHWM")))
    held, peak = (int(found[key].split()[0]) * 1024 for key in ("VmRSS", "VmHWM"))
    return held, peak
