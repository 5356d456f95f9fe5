"""What a viewer draws with VTK: a mesh before the sky, a frustum, a mark, texts and a colour bar.

Everything is lit and coloured before it comes here. VTK projects and hides, most often on a CPU:
so no lights, no smoothing of edges, no back faces where none are seen, and no sky behind ground.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
import numpy.typing as npt

from ..camera.camera import Camera
from ..drawing.colours import to_bytes
from ..drawing.graphics import require_graphics
from ..drawing.notes import bar, compass, letter_size
from ..drawing.picture import HORIZON, INK, ZENITH, Picture, stand
from ..drawing.scales import Scale
from .plate import Plate

if TYPE_CHECKING:
    import pyvista

    from .scene import Frame

_FRUSTUM: Final = (0.95, 0.80, 0.10)
_MARK: Final = (0.95, 0.10, 0.60)
_GLASS: Final = 0.65  # opacity of what texts and controls stand on
# a quad over the whole picture, behind everything: only pixels that nothing covers are shaded
_SKY_VERTICES: Final = """//VTK::System::Dec
in vec4 vertexMC;
in vec4 scalarColor;
out vec4 colour;
void main() {
  colour = scalarColor;
  gl_Position = vec4(vertexMC.xy, 0.9999999, 1.0);
}
"""
_SKY_FRAGMENTS: Final = """//VTK::System::Dec
//VTK::Output::Dec
in vec4 colour;
void main() { gl_FragData[0] = colour; }
"""
# sides of a frustum, between the points of frustum()
_SIDES: Final = ((0, 1), (0, 2), (0, 3), (0, 4), (1, 2), (2, 3), (3, 4), (4, 1))


class Stage:
    """The drawn part of a window.

    Parameters
    ----------
    size : (int, int)
        Of the picture, pixels.
    off_screen : bool

    Attributes
    ----------
    plotter : pyvista.Plotter
    origin : (3,) float64
        World point that everything is drawn relative to.

    Raises
    ------
    GraphicsError
        If this machine cannot draw.
    """

    def __init__(self, size: tuple[int, int], off_screen: bool) -> None:
        require_graphics()
        import pyvista

        self.plotter = pyvista.Plotter(
            off_screen=off_screen, window_size=list(size), lighting=None, title="terrain-lod"
        )
        self.plotter.disable_anti_aliasing()
        self.plotter.set_background(HORIZON)
        # nothing is left out for being out of view: patches are, and the sky is never
        self.plotter.renderer.GetCullers().RemoveAllItems()
        self.origin = np.zeros(3)
        nothing = np.zeros((1, 3), np.float32)
        self.surface = self._add(pyvista.PolyData(nothing), color="white")
        self.surface.mapper.scalar_visibility = True
        self.surface.prop.interpolation = "Flat"  # colours are lit already: no normals
        self.surface.prop.edge_color = INK
        self.frustum = self._add(pyvista.PolyData(nothing), color=_FRUSTUM, line_width=2)
        self.mark = self._add(
            pyvista.PolyData(nothing), color=_MARK, point_size=14, render_points_as_spheres=True
        )
        for actor in (self.surface, self.frustum, self.mark):
            actor.visibility = False
        self._add_sky()
        self._panel = self._add_panel()
        self._readout, self._footer = self._text("Top"), self._text("Bottom")
        self._help = self._text("Centered")
        self._bar, self._compass = Plate(self.plotter.renderer), Plate(self.plotter.renderer)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels; 0 where the window is folded away."""
        width, height = self.plotter.render_window.GetSize()
        return int(width), int(height)

    def show(self, frame: Frame) -> None:
        """Draw this mesh from now on."""
        import pyvista

        mesh, paint = frame.mesh, frame.paint
        self.origin = mesh.origin
        self.surface.visibility = len(mesh.triangles) > 0
        if not len(mesh.triangles):
            return
        corners = mesh.triangles.ravel()
        # drivers get cells with explicit offsets in two thirds of the time of regular ones
        offsets = np.arange(0, corners.size + 1, 3, dtype=corners.dtype)
        faces = pyvista.CellArray.from_arrays(offsets, corners)
        surface = pyvista.PolyData(mesh.vertices, faces=faces)
        data = surface.point_data if len(paint.colours) == surface.n_points else surface.cell_data
        data["colour"] = paint.colours
        data.active_scalars_name = "colour"
        if paint.drape is None:
            self.surface.SetTexture(None)
        else:
            paint.drape.lay(mesh, surface, self.surface)
        self.surface.mapper.SetInputData(surface)
        self.surface.prop.show_edges = frame.request.settings.mode == "wireframe"

    def show_frustum(self, camera: Camera | None, reach: float) -> None:
        """Draw what a camera sees as lines `reach` deep; nothing for None."""
        self.frustum.visibility = camera is not None
        if camera is not None:
            self._place(self.frustum, frustum(camera, reach), _SIDES)

    def show_mark(self, point: tuple[float, float, float] | None) -> None:
        """Draw a dot at a world point; nothing for None."""
        self.mark.visibility = point is not None
        if point is not None:
            self._place(self.mark, np.array([point]))

    def write(self, readout: str, footer: str, instructions: str = "") -> None:
        """Set the texts above and below, and the one in the middle."""
        width, height = self.size
        size, left = letter_size(min(width, height)), self._bar.width
        places = ((self._readout, readout, 0, height - 1), (self._footer, footer, left, 0),
                  (self._help, instructions, 2 * size, height // 2))  # fmt: skip
        for actor, text, x, y in places:
            actor.SetInput(text)
            actor.SetPosition(x + size // 2, y + (size // 2 if y == 0 else -(size // 2)))
            actor.GetTextProperty().SetFontSize(size)

    def explain(self, camera: Camera, scale: Scale | None, unit: str | None) -> None:
        """Show a colour bar at the lower left, a scale bar and north at the lower right."""
        width, height = self.size
        size = letter_size(min(width, height))
        room = width > 30 * size
        self._bar.show(bar(scale, size, max(width // 4, 8 * size)) if scale and room else None)
        wide = max(width // 6, 6 * size)
        self._compass.show(compass(camera, unit, size, wide) if unit and room else None)
        self._compass.move(width - self._compass.width)

    def show_panel(self, height: float) -> None:
        """Lay a light ground under controls at the upper right, a share of the window high."""
        left, low = 0.785, 1 - height
        corners = [[left, low, 0], [0.995, low, 0], [0.995, 0.99, 0], [left, 0.99, 0]]
        self._panel.GetMapper().GetInput().points = np.array(corners, np.float32)
        self._panel.SetVisibility(height > 0)

    def draw(self, camera: Camera, *, fronts_alone: bool) -> None:
        """Draw everything as `camera` sees it; with `fronts_alone` no triangle from behind."""
        self.surface.prop.culling = "back" if fronts_alone else "none"
        stand(self.plotter.camera, camera, self.origin)
        self.plotter.renderer.ResetCameraClippingRange()
        self.plotter.render_window.Render()

    def pixels(self) -> Picture:
        """Return (H, W, 3) uint8 of what is drawn."""
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

        width, height = self.size
        pixels = vtkUnsignedCharArray()
        self.plotter.render_window.GetPixelData(0, 0, width - 1, height - 1, 0, pixels, 0)
        # VTK counts rows from below
        return np.asarray(vtk_to_numpy(pixels)).reshape(height, width, 3)[::-1].copy()

    def _place(
        self, actor: Any, points: npt.NDArray[np.float64], lines: tuple[tuple[int, int], ...] = ()
    ) -> None:
        import pyvista

        shape = pyvista.PolyData((points - self.origin).astype(np.float32))
        if lines:
            shape.lines = np.insert(np.array(lines), 0, 2, axis=1).ravel()
            shape.verts = np.empty(0, int)
        actor.mapper.SetInputData(shape)

    def _add(self, surface: pyvista.PolyData, **look: Any) -> Any:
        return self.plotter.add_mesh(
            surface, lighting=False, copy_mesh=False, reset_camera=False, render=False, **look
        )

    def _add_sky(self) -> None:
        import pyvista

        corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
        quad = pyvista.PolyData.from_regular_faces(corners, np.array([[0, 1, 2], [0, 2, 3]]))
        quad["colour"] = to_bytes(np.array([HORIZON, HORIZON, ZENITH, ZENITH], np.float32))
        sky = self._add(quad, scalars="colour", rgb=True)
        sky.UseBoundsOff()
        shader = sky.GetShaderProperty()
        shader.SetVertexShaderCode(_SKY_VERTICES)
        shader.SetFragmentShaderCode(_SKY_FRAGMENTS)

    def _add_panel(self) -> Any:
        import pyvista
        from vtkmodules.vtkRenderingCore import vtkActor2D, vtkCoordinate, vtkPolyDataMapper2D

        quad = pyvista.PolyData.from_regular_faces(
            np.zeros((4, 3), np.float32), np.array([[0, 1, 2], [0, 2, 3]])
        )
        place, mapper, panel = vtkCoordinate(), vtkPolyDataMapper2D(), vtkActor2D()
        place.SetCoordinateSystemToNormalizedViewport()
        mapper.SetTransformCoordinate(place)
        mapper.SetInputData(quad)
        panel.SetMapper(mapper)
        panel.GetProperty().SetColor(1.0, 1.0, 1.0)
        panel.GetProperty().SetOpacity(_GLASS)
        panel.SetVisibility(False)
        self.plotter.renderer.AddViewProp(panel)
        return panel

    def _text(self, side: str) -> Any:
        from vtkmodules.vtkRenderingCore import vtkTextActor

        text = vtkTextActor()
        look = text.GetTextProperty()
        look.SetFontFamilyToCourier()
        look.SetColor(0.08, 0.10, 0.14)
        look.SetBackgroundColor(1.0, 1.0, 1.0)
        look.SetBackgroundOpacity(_GLASS)
        getattr(look, f"SetVerticalJustificationTo{side}")()
        self.plotter.renderer.AddViewProp(text)
        return text


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
