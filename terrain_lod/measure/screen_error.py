"""What the eye sees of an error: in pixels, at the skyline, in the shading, from frame to frame.

All of it comes from projected geometry, not from pictures: the height of a mesh above every sample,
as :func:`terrain_lod.vertical_error` measures it, seen through a camera in float64.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..arguments import instance, list_of
from ..camera.camera import Camera
from ..device.device import Device
from ..errors import InputError
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh
from .error import vertical_error

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class ScreenError:
    """How far samples of the ground are moved in a camera's picture.

    Attributes
    ----------
    maximum, rms : float
        In pixels, over the samples measured; NaN where there is none.
    where : (int, int) or None
        Row and column of the sample that is moved farthest.
    pixel : (float, float) or None
        Where in the picture it belongs, y down.
    samples : int
        Samples in view that a triangle covers.
    """

    maximum: float
    rms: float
    where: tuple[int, int] | None
    pixel: tuple[float, float] | None
    samples: int

    def __str__(self) -> str:
        if self.where is None or self.pixel is None:
            return "no sample in view"
        return (
            f"largest error {self.maximum:.4g} pixels at [{self.where[0]}, {self.where[1]}], "
            f"pixel ({self.pixel[0]:.0f}, {self.pixel[1]:.0f}), RMS {self.rms:.4g} "
            f"over {self.samples} samples in view"
        )


def screen_error(
    mesh: Mesh, ground: Heightmap, camera: Camera, *, device: Device | None = None
) -> ScreenError:
    """Measure how far the mesh moves every sample in view, in pixels.

    A sample is in view where it lies in the camera's frustum; hills that hide it are not asked.
    Its place in the picture is compared with that of the mesh above or below it.

    Parameters
    ----------
    mesh : Mesh
    ground : Heightmap
    camera : Camera
    device : Device, optional

    Returns
    -------
    ScreenError
    """
    instance("a Camera for camera", camera, Camera)
    return seen_error(_error_field(mesh, ground, device), ground, camera)


def seen_error(errors: npt.NDArray[np.float32], ground: Heightmap, camera: Camera) -> ScreenError:
    """Return what :func:`screen_error` does, from a field of vertical errors (R, C)."""
    rows, columns = np.nonzero(~np.isnan(errors))
    points = _samples(ground, rows, columns)
    pixels, in_view = _in_view(camera, points)
    rows, columns, points, pixels = (
        rows[in_view],
        columns[in_view],
        points[in_view],
        pixels[in_view],
    )
    if not len(rows):
        return ScreenError(np.nan, np.nan, None, None, 0)
    points[:, 2] += errors[rows, columns]
    moved = _distance(camera, points, pixels)
    worst = int(np.argmax(moved))
    return ScreenError(
        maximum=float(moved[worst]),
        rms=float(np.sqrt(np.mean(np.square(moved)))),
        where=(int(rows[worst]), int(columns[worst])),
        pixel=(float(pixels[worst, 0]), float(pixels[worst, 1])),
        samples=len(rows),
    )


@dataclass(frozen=True)
class Pop:
    """How far the surface jumps between the pictures of a camera path.

    Attributes
    ----------
    maximum, rms : float
        In pixels, over all samples that both meshes of a step cover and its camera sees.
    steps : tuple of float
        The largest jump of each step.
    """

    maximum: float
    rms: float
    steps: tuple[float, ...]


def pop_metric(
    meshes: Sequence[Mesh],
    ground: Heightmap,
    cameras: Sequence[Camera],
    *,
    device: Device | None = None,
) -> Pop:
    """Measure the jumps of the surface along a camera path.

    Between two pictures the camera moves and the mesh changes. What the change alone does is how
    far the surface above a sample moves, from the one mesh to the next, in the next picture.

    Parameters
    ----------
    meshes : sequence of Mesh
        One a camera.
    ground : Heightmap
    cameras : sequence of Camera
        At least two.
    device : Device, optional

    Returns
    -------
    Pop

    Raises
    ------
    InputError
        If there are fewer than two cameras, or not as many meshes.
    """
    meshes, cameras = list_of("meshes", meshes, Mesh), list_of("cameras", cameras, Camera)
    if len(cameras) < 2 or len(meshes) != len(cameras):
        raise InputError(
            f"expected a mesh for each of two cameras or more, got {len(meshes)} and {len(cameras)}"
        )
    steps, squares, count = [], 0.0, 0
    before = _error_field(meshes[0], ground, device)
    for mesh, camera in zip(meshes[1:], cameras[1:], strict=True):
        after = _error_field(mesh, ground, device)
        moved = jumps(ground, camera, before, after)
        steps.append(float(moved.max(initial=0.0)))
        squares += float(np.square(moved).sum())
        count += len(moved)
        before = after
    return Pop(max(steps), float(np.sqrt(squares / max(count, 1))), tuple(steps))


def jumps(
    ground: Heightmap,
    camera: Camera,
    before: npt.NDArray[np.float32],
    after: npt.NDArray[np.float32],
) -> Array:
    """Return the pixels that each sample which both fields cover moves by."""
    rows, columns = np.nonzero(~(np.isnan(before) | np.isnan(after)))
    points = _samples(ground, rows, columns)
    heights = points[:, 2].copy()
    points[:, 2] = heights + before[rows, columns]
    pixels, in_view = _in_view(camera, points)
    points[:, 2] = heights + after[rows, columns]
    return _distance(camera, points[in_view], pixels[in_view])


def normal_error(
    mesh: Mesh, ground: Heightmap, *, device: Device | None = None
) -> tuple[float, float]:
    """Measure the angle between the mesh's surface and the ground's, in degrees.

    Both are taken at every sample, by the same differences of neighbouring heights: those of the
    mesh above the samples, and those of the samples.

    Returns
    -------
    maximum, rms : float
    """
    errors = _error_field(mesh, ground, device)
    truth = np.where(ground.valid, ground.heights, np.nan).astype(np.float64)
    ours, theirs = (_normals(heights, ground.spacing) for heights in (truth + errors, truth))
    # the angle from the chord: the cosine of a small one is 1 to all digits
    chord = np.linalg.norm(ours - theirs, axis=-1)
    angle = np.degrees(2 * np.arcsin(np.clip(chord / 2, 0, 1)))
    angle = angle[~np.isnan(angle)]
    return float(angle.max(initial=0.0)), float(np.sqrt(np.mean(np.square(angle))))


def silhouette_error(
    mesh: Mesh, ground: Heightmap, camera: Camera, *, device: Device | None = None
) -> tuple[float, float]:
    """Measure how far the skyline of the mesh is from that of the ground, in pixels.

    The skyline is the topmost sample in each column of the picture, taken once from the ground's
    heights and once from the mesh's above the same samples.

    Returns
    -------
    maximum, rms : float
        Over the columns that have a skyline.
    """
    instance("a Camera for camera", camera, Camera)
    errors = _error_field(mesh, ground, device)
    rows, columns = np.nonzero(~np.isnan(errors))
    points = _samples(ground, rows, columns)
    truth = _skyline(camera, points)
    points[:, 2] += errors[rows, columns]
    with np.errstate(invalid="ignore"):  # columns without a skyline
        difference = np.abs(_skyline(camera, points) - truth)
    difference = difference[np.isfinite(difference)]
    if not len(difference):
        return np.nan, np.nan
    return float(difference.max()), float(np.sqrt(np.mean(np.square(difference))))


def _error_field(mesh: Mesh, ground: Heightmap, device: Device | None) -> npt.NDArray[np.float32]:
    field = vertical_error(mesh, ground, field=True, device=device).field
    assert field is not None
    return field


def _samples(ground: Heightmap, rows: npt.NDArray[np.intp], columns: npt.NDArray[np.intp]) -> Array:
    """Return world points of samples; (N, 3)."""
    return np.column_stack(
        [
            ground.origin[0] + columns * ground.spacing[0],
            ground.origin[1] - rows * ground.spacing[1],
            ground.base + ground.heights[rows, columns].astype(np.float64),
        ]
    )


def _in_view(camera: Camera, points: Array) -> tuple[Array, npt.NDArray[np.bool_]]:
    pixels, depth = camera.project(points)
    inside = (depth >= camera.near) & (depth <= camera.far)
    inside &= (pixels >= 0).all(axis=1) & (pixels <= camera.size).all(axis=1)
    return pixels, inside


def _distance(camera: Camera, points: Array, pixels: Array) -> Array:
    """Return how far `points` are from `pixels`; infinitely far where they are behind the eye."""
    moved, depth = camera.project(points)
    distance = np.linalg.norm(moved - pixels, axis=1)
    return distance if camera.height else np.where(depth > 0, distance, np.inf)


def _skyline(camera: Camera, points: Array) -> Array:
    """Return the topmost pixel row in each column of the picture; infinite where none."""
    pixels, depth = camera.project(points)
    inside = (depth >= camera.near) & (depth <= camera.far)
    inside &= (pixels[:, 0] >= 0) & (pixels[:, 0] < camera.size[0])
    top = np.full(camera.size[0], np.inf)
    np.minimum.at(top, pixels[inside, 0].astype(int), pixels[inside, 1])
    return top


def _normals(heights: Array, spacing: tuple[float, float]) -> Array:
    south, east = np.gradient(heights)
    normals = np.stack([-east / spacing[0], south / spacing[1], np.ones_like(east)], axis=-1)
    unit: Array = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    return unit
