"""A mesh drawn off screen: shaded, plain, as wireframe, or its patches coloured by a number.

Colours are worked out here, one a vertex or one a triangle, and drawn without lights: VTK only
projects and hides. So a picture is the same on every driver.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt
from PIL import Image

from ..arguments import file_path, flag, numbers, one_of, positive
from ..camera.camera import Camera
from ..errors import InputError
from ..mesh.mesh import Mesh
from ..mesh.stretched import stretched
from ..paths import replacing, require_folder
from . import scales
from .colours import Colours, facing, hypsometric, lit, mixed, sun_direction, to_bytes
from .drape import Drape
from .graphics import require_graphics
from .outlines import patch_outlines
from .scales import Scale
from .sky_light import SkyLight

if TYPE_CHECKING:
    import pyvista

Picture = npt.NDArray[np.uint8]
"""(H, W, 3) red, green, blue; row 0 at the top."""

SUN: Final = (315.0, 40.0)
"""Where light comes from: degrees clockwise from north, degrees above the horizon."""
SUN_ON_MESHES: Final = (200.0, 40.0)
"""The same for what is no ground, which is looked at from the south: over the shoulder."""

OF_PATCHES: Final = ("lod", "size", "factor")
STYLES: Final = ("shaded", "plain", "wireframe", *OF_PATCHES)

# drawn this many times larger along both axes, then averaged: smooth edges and lines
_OVERSAMPLING: Final = 2
_LARGEST_WINDOW: Final = 8192  # pixels along one axis, in reach of every driver

HORIZON: Final = (0.82, 0.87, 0.91)
ZENITH: Final = (0.42, 0.60, 0.80)
_PAPER: Final = (0.97, 0.97, 0.95)
_CLAY: Final = (0.86, 0.80, 0.72)
INK: Final = (0.10, 0.14, 0.20)
_LINE_WIDTH: Final = 1.0  # of the enlarged picture's pixels
_OUTLINE: Final = (0.98, 0.98, 0.96)  # between patches
_OUTLINE_OPACITY: Final = 0.45
_AIR: Final = 0.3  # of haze, over the ground's own length
SHADE: Final = 0.62  # light of a slope that faces away, where colours stand for numbers


def draw(
    mesh: Mesh,
    camera: Camera,
    *,
    style: str = "shaded",
    sun: tuple[float, float] = SUN,
    height_range: tuple[float, float] | None = None,
    metres: float | None = None,
    colour_range: tuple[float, float] | None = None,
    drape: Drape | None = None,
    wireframe: bool = False,
    exaggeration: float = 1.0,
    sky_light: SkyLight | None = None,
) -> Picture:
    """Draw `mesh` as `camera` sees it, perhaps with a picture in place of the tints.

    Mesh and camera are in the true world; both are drawn with their heights exaggerated. `metres`
    is the unit of heights above the sea, None where nobody knows where that is; `sky_light` is of
    the ground as it is drawn. All else is as for :func:`render`, what it raises as well.
    """
    if max(camera.size) > _LARGEST_WINDOW:
        raise InputError(f"expected a size of at most {_LARGEST_WINDOW} pixels, got {camera.size}")
    direction = sun_direction(*numbers("sun", sun, "azimuth", "elevation"))
    factor = positive("exaggeration", exaggeration)
    mesh, camera = stretched(mesh, factor), camera.lifted(factor)
    if one_of("style", style, STYLES) != "shaded" and drape is not None:
        raise InputError(f"expected style 'shaded' with a texture, got {style!r}")
    sky = None if sky_light is None else sky_light.on(mesh)
    if drape is not None:
        colours = lit(np.ones_like(mesh.vertices), mesh.normals, direction, sky)
    elif style == "shaded":
        colours = _shaded(mesh, camera, direction, height_range, metres, factor, sky)
    elif style == "plain":
        clay = np.broadcast_to(np.asarray(_CLAY, np.float32), mesh.vertices.shape)
        colours = lit(clay, mesh.normals, direction)
    elif style in OF_PATCHES:
        colours = _of_patches(mesh, direction, style, colour_range)
    else:
        colours = np.broadcast_to(np.asarray(_PAPER, np.float32), mesh.vertices.shape)
    require_graphics()
    lines = flag("wireframe", wireframe) or style == "wireframe"
    return _draw(mesh, camera, to_bytes(colours), style, drape, lines)


def save_png(picture: Picture, path: str | Path) -> Path:
    """Write `picture` as PNG, under a temporary name first; return its path.

    Raises
    ------
    InputError
        If the name does not end in .png.
    FileError
        If the file cannot be written.
    """
    require_png(path)
    with replacing(path) as temporary:
        Image.fromarray(picture).save(temporary, format="png")
    return Path(path)


def require_png(path: str | Path) -> None:
    """Say so before the work begins if `path` is no file that a picture can be written to.

    Raises
    ------
    InputError
        If the name does not end in .png.
    FileError
        If its folder does not exist or cannot be written.
    """
    path = file_path("path", path)
    if path.suffix.lower() != ".png":
        raise InputError(f"expected a name that ends in .png for a picture, got {path.name}")
    require_folder(path)


# colours


def _shaded(
    mesh: Mesh,
    camera: Camera,
    sun: npt.NDArray[np.float32],
    height_range: tuple[float, float] | None,
    metres: float | None,
    exaggeration: float,
    sky: npt.NDArray[np.float32] | None,
) -> Colours:
    """Return the colour of each vertex: tinted by height, lit, and fading into the distance."""
    heights = (mesh.vertices[:, 2] + np.float32(mesh.origin[2])) / np.float32(exaggeration)
    if height_range is None:
        height_range = (float(heights.min()), float(heights.max())) if len(heights) else (0.0, 1.0)
    low, high = numbers("height_range", height_range, "low", "high")
    if low > high:
        raise InputError(f"expected a height_range that rises, got {(low, high)}")
    tinted = hypsometric(heights, mesh.normals, (low, high), metres)
    colours = lit(tinted, mesh.normals, sun, sky)
    # at the mesh's own length away, a quarter of what is seen is air; from farther off no more
    away = np.linalg.norm(mesh.vertices - np.subtract(camera.eye, mesh.origin), axis=1)
    length = float(np.linalg.norm(np.ptp(mesh.vertices[:, :2], axis=0))) if len(heights) else 1.0
    length = max(length, float(np.median(away)) if len(away) else 0.0)
    return mixed(colours, (1 - np.exp(-_AIR * away / length)).astype(np.float32), HORIZON)


def scale_of(
    mesh: Mesh, style: str, colour_range: tuple[float, float] | None = None
) -> tuple[Scale, npt.NDArray[np.floating[Any]]]:
    """Return what the colours of a style of patches stand for, and each patch's number; (P,).

    Raises
    ------
    InputError
        If the mesh has no patches, or the range falls.
    """
    patches = mesh.patches
    if patches is None:
        raise InputError(f"expected a mesh with patches for style {style!r}, got one without")
    if style == "lod":
        scale, values = scales.segments(patches), patches.segment_cells
    elif style == "size":
        scale, values = scales.sizes(patches), scales.patch_sizes(patches)
    else:
        values = patches.inside_factors.mean(axis=1)
        scale = scales.factors(values[patches.drawn])
    if colour_range is not None:
        least, most = numbers("colour_range", colour_range, "least", "most")
        if not 0 < least < most:
            raise InputError(f"expected a colour_range above 0 that rises, got {(least, most)}")
        scale = replace(scale, low=least, high=most)
    return scale, values


def _of_patches(
    mesh: Mesh,
    sun: npt.NDArray[np.float32],
    style: str,
    colour_range: tuple[float, float] | None,
) -> Colours:
    """Return the colour of each triangle: its patch's, with enough light to see relief."""
    scale, values = scale_of(mesh, style, colour_range)
    colours = scale.colours(values)
    a, b, c = (mesh.vertices[mesh.triangles[:, corner]] for corner in range(3))
    across = np.cross(b - a, c - a)
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-30)
    light = SHADE + (1 - SHADE) * facing(across, sun)
    return (colours[mesh.triangle_patches] * light[:, None]).astype(np.float32)


# drawing


def _draw(
    mesh: Mesh,
    camera: Camera,
    colours: npt.NDArray[np.uint8],
    style: str,
    drape: Drape | None,
    lines: bool,
) -> Picture:
    """Return the picture of `mesh` with a colour a vertex or a triangle."""
    import pyvista

    width, height = camera.size
    scale = _OVERSAMPLING if _OVERSAMPLING * max(width, height) <= _LARGEST_WINDOW else 1
    background = _background(camera, height * scale, style)
    depths = _depth_range(mesh, camera)
    if depths is None:
        picture = np.broadcast_to(background, (height * scale, width * scale, 3))
        return _averaged(picture, scale)
    plotter = pyvista.Plotter(
        off_screen=True, window_size=[width * scale, height * scale], lighting=None
    )
    try:
        plotter.disable_anti_aliasing()
        surface = pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.triangles)
        data = surface.cell_data if style in OF_PATCHES else surface.point_data
        data["colour"] = colours
        filled = _add(plotter, surface, scalars="colour", rgb=True)
        if drape is not None:
            drape.lay(mesh, surface, filled)
        covered = _point_camera(plotter, mesh, camera, depths)
        if lines:
            # lines lie in the faces they bound: the faces step back by one unit of depth
            filled.mapper.SetResolveCoincidentTopologyToPolygonOffset()
            filled.mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(1.0, 1.0)
            wires = surface.copy(deep=False)
            _add(plotter, wires, style="wireframe", color=INK, line_width=_LINE_WIDTH)
        elif style == "lod":
            filled.mapper.SetResolveCoincidentTopologyToPolygonOffset()
            filled.mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(1.0, 1.0)
            edges = pyvista.PolyData(mesh.vertices)
            edges.verts = np.empty(0, int)
            edges.lines = np.insert(patch_outlines(mesh), 0, 2, axis=1).ravel()
            look = {"color": _OUTLINE, "opacity": _OUTLINE_OPACITY, "line_width": _LINE_WIDTH}
            _add(plotter, edges, **look)
        if style == "wireframe":
            plotter.set_background(_PAPER)
            return _averaged(_screenshot(plotter), scale)
        return _averaged(np.where(covered[..., None], _screenshot(plotter), background), scale)
    finally:
        plotter.close()


def _add(plotter: pyvista.Plotter, surface: pyvista.PolyData, **look: Any) -> Any:
    """Add `surface` to the picture as it is: no lights, no copy, no camera of VTK's own."""
    return plotter.add_mesh(
        surface, lighting=False, copy_mesh=False, reset_camera=False, render=False, **look
    )


def _screenshot(plotter: pyvista.Plotter) -> Picture:
    return np.asarray(plotter.screenshot(return_img=True))[..., :3]


def _background(camera: Camera, rows: int, style: str) -> Picture:
    """Return what is behind the ground, a colour a row: (rows, 1, 3)."""
    if style != "shaded":
        plain = np.asarray(_PAPER, np.float32)
        return np.broadcast_to(to_bytes(plain), (rows, 1, 3))
    # how far up the middle of each row looks; the sky is palest at the horizon, or at the middle
    # of a picture that looks down
    _, upward, forward = camera.axes
    offsets = camera.half_extents[1] * (1 - (2 * np.arange(rows) + 1) / rows)
    rays = forward + offsets[:, None] * upward * (camera.height is None)
    rise = np.arcsin(rays[:, 2] / np.linalg.norm(rays, axis=1))
    above = rise - min(0.0, float(np.arcsin(forward[2])))
    blue = np.clip(above / np.radians(45), 0.0, 1.0).astype(np.float32)
    horizon = np.broadcast_to(np.asarray(HORIZON, np.float32), (rows, 3))
    return to_bytes(mixed(horizon, blue, ZENITH))[:, None]


def _depth_range(mesh: Mesh, camera: Camera) -> tuple[float, float] | None:
    """Return depths that hold what can be seen of `mesh`; None if all of it is behind the eye."""
    if not len(mesh.triangles):
        return None
    low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
    corners = np.stack(np.meshgrid(*zip(low, high, strict=True)), axis=-1).reshape(-1, 3)
    _, depth = camera.project(corners + mesh.origin)
    # twice as deep as need be, so that what is deepest differs from nothing in the depth buffer
    near, far = max(camera.near, 0.99 * float(depth.min())), min(camera.far, 2 * float(depth.max()))
    return (near, far) if near < far else None


def _point_camera(
    plotter: pyvista.Plotter, mesh: Mesh, camera: Camera, depths: tuple[float, float]
) -> npt.NDArray[np.bool_]:
    """Stand VTK's camera where ours is, relative to the mesh's origin; return what it covers."""
    target: Any = plotter.camera
    stand(target, camera, mesh.origin)
    target.parallel_projection = camera.height is not None
    target.parallel_scale = camera.half_extents[1]
    target.clipping_range = depths
    buffer = _depth_buffer(plotter)
    if camera.height is None:
        # In perspective a depth buffer has few steps far away when the near plane is close. So
        # look once, and move the near plane out to the nearest thing seen.
        near, far = depths
        nearest = near * far / (far - float(buffer.min()) * (far - near))
        target.clipping_range = (max(near, 0.95 * nearest), far)
    return buffer < 1.0


def stand(target: Any, camera: Camera, origin: npt.NDArray[np.float64]) -> None:
    """Stand VTK's camera `target` where `camera` is, relative to the world point `origin`."""
    target.position = np.subtract(camera.eye, origin)
    target.focal_point = np.subtract(camera.target, origin)
    target.up = camera.up
    target.view_angle = camera.fov  # vertical, as ours
    target.is_set = True


def _depth_buffer(plotter: pyvista.Plotter) -> npt.NDArray[np.float32]:
    """Return depths of the picture: 0 at the near plane, 1 at the far one and beyond; (H, W)."""
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkFloatArray

    window, depths = plotter.render_window, vtkFloatArray()
    window.Render()
    width, height = window.GetSize()
    window.GetZbufferData(0, 0, width - 1, height - 1, depths)
    return np.asarray(vtk_to_numpy(depths)).reshape(height, width)[::-1]


def _averaged(picture: Picture, scale: int) -> Picture:
    """Return `picture` at 1 / `scale` of its size, each pixel the mean of scale x scale."""
    rows, columns = picture.shape[0] // scale, picture.shape[1] // scale
    total = np.full((rows, columns, 3), scale**2 // 2, np.uint16)  # half a step: rounds to nearest
    for row in range(scale):
        for column in range(scale):
            total += picture[row::scale, column::scale]
    return (total // scale**2).astype(np.uint8)
