"""A window on a model: the newest mesh, the camera that is driven, the read-out.

Input only changes what is wanted; :meth:`Window.pump`, called some sixty times a second, shows the
newest frame and draws. Meshes are made on the engine's thread, so neither input nor drawing waits
for one.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from ..camera import Camera
from ..drawing.drape import Drape
from ..drawing.graphics import require_graphics
from ..drawing.render import HORIZON, INK, ZENITH, Picture, save_png, stand
from ..errors import InputError
from .engine import Engine
from .model import Frame, Model, Request, frustum
from .settings import Settings
from .viewer_camera import Rig, ground_seen

if TYPE_CHECKING:
    import pyvista

_FRUSTUM: Final = (0.95, 0.80, 0.10)
_MARK: Final = (0.95, 0.10, 0.60)
_TEXT_SIZE: Final = 14
# a new mesh that comes this soon is worth waiting for: drawing the old one would hold it up
_PATIENCE: Final = 0.1  # seconds
_LOOK_AFTER: Final = 1.0  # seconds between looks at the ground's file


class Window:
    """Shows a model; on a screen, or off it for tests, pages and recordings.

    Parameters
    ----------
    model : Model
    camera : Camera
        Where to begin; its size is the window's.
    off_screen : bool, optional

    Attributes
    ----------
    plotter : pyvista.Plotter
    engine : Engine
    settings : Settings
    rig : Rig
    frame : Frame or None
        What is shown; None until the first mesh is there.
    note : str
        The line at the bottom: a pick, a problem, an answer.
    draw_seconds : float
        Of the last drawing.

    Raises
    ------
    GraphicsError
        If this machine cannot draw.
    """

    def __init__(self, model: Model, camera: Camera, *, off_screen: bool = False) -> None:
        require_graphics()
        import pyvista

        self.model, self.engine = model, Engine(model)
        self.settings: Settings = model.settings()
        self.home = self.rig = Rig.of(camera).within(model.ground)
        self.frame: Frame | None = None
        self.note = ""
        self.draw_seconds = 0.0
        self.texts_shown = True
        self.plotter = pyvista.Plotter(
            off_screen=off_screen, window_size=list(camera.size), lighting=None, title="terrain-lod"
        )
        self.plotter.disable_anti_aliasing()
        self.plotter.set_background(HORIZON, top=ZENITH)
        self._frozen: Camera | None = None
        self._dirty = True
        self._size: tuple[int, int] | None = None
        self._asked = 0
        self._problem: str | None = None
        self._looked = perf_counter()
        self._waiting: float | None = None  # since when there is something to draw
        self._origin = np.zeros(3)
        self._ground = model.ground
        self._surface = self._add(pyvista.PolyData(np.zeros((1, 3), np.float32)), color="white")
        self._surface.mapper.scalar_visibility = True
        self._surface.prop.interpolation = "Flat"  # colours are lit already: no normals
        self._frustum = self._add(pyvista.PolyData(np.zeros((1, 3))), color=_FRUSTUM, line_width=2)
        self._mark = self._add(
            pyvista.PolyData(np.zeros((1, 3))),
            color=_MARK,
            point_size=14,
            render_points_as_spheres=True,
        )
        for actor in (self._surface, self._frustum, self._mark):
            actor.visibility = False
        self._readout, self._footer = self._text(0.99, "top"), self._text(0.01, "bottom")

    # what is wanted

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels; 0 where the window is folded away."""
        width, height = self.plotter.render_window.GetSize()
        return int(width), int(height)

    @property
    def camera(self) -> Camera:
        """Where the window looks from."""
        return self.rig.camera(self.size)

    def drive(self, rig: Rig) -> None:
        """Move the camera, as far as the ground lets it, and want the mesh for it."""
        self.rig = rig.within(self.model.ground)
        self._dirty = True
        if self._frozen is None:
            self.ask()

    def change(self, name: str, value: Any) -> None:
        """Change a setting; see :meth:`Settings.changed`."""
        self.apply(self.settings.changed(name, value))

    def apply(self, settings: Settings) -> None:
        """Take over settings, and want the mesh for them."""
        if settings == self.settings:
            return
        if settings.frozen != self.settings.frozen:
            self._frozen = self.camera if settings.frozen else None
        self.settings = settings
        self._dirty = True
        self.ask()

    def ask(self, *, reload: bool = False) -> None:
        """Want a mesh for the camera and the settings as they are."""
        self._asked += 1
        camera = self._frozen or self.camera
        self.engine.ask(Request(camera, self.settings, self._asked), reload=reload)

    def reload(self) -> None:
        """Want the ground read again."""
        self.ask(reload=True)

    def redraw(self) -> None:
        """Draw at the next :meth:`pump`."""
        self._dirty = True

    # what is shown

    def pump(self) -> bool:
        """Show the newest frame and draw, if there is anything new; return whether it was drawn."""
        if self.size != self._size and min(self.size) > 0:
            self._size = self.size
            self.drive(self.rig)
        frame = self.engine.take()
        if frame is not None:
            self._show(frame)
        self._listen()
        if not self._dirty or min(self.size) < 1:
            return False
        self._waiting = self._waiting or perf_counter()
        if frame is None and self.engine.working and perf_counter() - self._waiting < _PATIENCE:
            return False
        self.draw()
        return True

    def _listen(self) -> None:
        """Note what went wrong, and once a second what became of the ground's file."""
        news = self.engine.problem if self.engine.problem != self._problem else None
        self._problem = self.engine.problem
        if perf_counter() - self._looked > _LOOK_AFTER:
            self._looked = perf_counter()
            news = news or self.model.news()
        if news is not None:
            self.note, self._dirty = news, True

    def draw(self) -> None:
        """Draw what is there."""
        self._dirty, self._waiting = False, None
        begun = perf_counter()
        camera: Any = self.plotter.camera
        stand(camera, self.camera, self._origin)
        self._write()
        self.plotter.renderer.ResetCameraClippingRange()
        self.plotter.render_window.Render()
        self.draw_seconds = perf_counter() - begun

    def settle(self, seconds: float = 60.0, *, measured: bool = False) -> Frame:
        """Wait for the mesh that was asked for last, show it and return it. For scripts.

        Raises
        ------
        InputError
            If it cannot be made; the message says why.
        """
        self.pump()
        end = perf_counter() + seconds
        while perf_counter() < end:
            idle = self.engine.wait(max(0.0, end - perf_counter()), measured=measured)
            self.pump()
            newest = self.frame is not None and self.frame.request.number == self._asked
            if newest and (not measured or idle):
                break
            problem = self.engine.problem
            if problem is not None:
                self._listen()
                raise InputError(problem)
        if self.frame is None:
            raise InputError(f"expected a mesh within {seconds:g} s, got none")
        return self.frame

    def picture(self, path: str | Path | None = None) -> Picture:
        """Draw, and return (H, W, 3) uint8 of what the window shows; also as PNG to `path`.

        Raises
        ------
        InputError
            If the window has no pixels.
        FileError
            If the file cannot be written.
        """
        if min(self.size) < 1:
            raise InputError(f"expected a window with pixels for a picture, got {self.size}")
        self.draw()
        shown = self._pixels()
        if path is not None:
            save_png(shown, path)
        return shown

    def _pixels(self) -> Picture:
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

        width, height = self.size
        pixels = vtkUnsignedCharArray()
        self.plotter.render_window.GetPixelData(0, 0, width - 1, height - 1, 0, pixels, 0)
        # VTK counts rows from below
        return np.asarray(vtk_to_numpy(pixels)).reshape(height, width, 3)[::-1].copy()

    def pick(self, x: int, y: int) -> None:
        """Note what is known of the ground at a pixel, counted from the lower left."""
        frame, self._dirty = self.frame, True
        if frame is None:
            return
        place = ground_seen(frame.terrain.ground, self.camera, x, y)
        if place is None:
            self.note, self._mark.visibility = "nothing there", False
            return
        pick = frame.pick(place[0], place[1])
        self.note = "\n".join(pick.lines())
        self._place(self._mark, np.subtract(pick.point, self._origin)[None])

    def lines(self) -> tuple[str, ...]:
        """Return the read-out."""
        if self.frame is None:
            return ("making the first mesh",)
        return (*self.frame.lines(), f"drawn in {1e3 * self.draw_seconds:.0f} ms")

    def close(self) -> None:
        """End the engine and the window."""
        self.engine.close()
        self.plotter.close()

    # how it is shown

    def _show(self, frame: Frame) -> None:
        import pyvista

        self.frame, self._dirty = frame, True
        self._origin = frame.mesh.origin
        mesh, mode = frame.mesh, frame.request.settings.mode
        visible = len(mesh.triangles) > 0
        self._surface.visibility = visible
        if visible:
            surface = pyvista.PolyData.from_regular_faces(mesh.vertices, mesh.triangles)
            colours = frame.paint.colours
            data = surface.point_data if len(colours) == surface.n_points else surface.cell_data
            data["colour"] = colours
            data.active_scalars_name = "colour"
            self._drape(surface, frame)
            self._surface.mapper.SetInputData(surface)
        self._surface.prop.show_edges = mode == "wireframe"
        self._surface.prop.edge_color = INK
        self._show_frustum()
        if self._ground is not frame.terrain.ground:
            self._ground = frame.terrain.ground
            diagonal = self.model.settings().diagonal
            self.settings = replace(self.settings, diagonal=diagonal)
            self.home = self.home.within(self._ground)
            self.rig = self.rig.within(self._ground)

    def _drape(self, surface: pyvista.PolyData, frame: Frame) -> None:
        """Lay the texture over the surface, or take it off."""
        if frame.paint.texture is None:
            self._surface.SetTexture(None)
        else:
            drape = Drape(frame.paint.texture, frame.terrain.ground)
            drape.lay(frame.mesh, surface, self._surface)

    def _show_frustum(self) -> None:
        self._frustum.visibility = self._frozen is not None
        if self._frozen is None:
            return
        reach = 0.35 * self.settings.diagonal
        sides = [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1]]
        self._place(self._frustum, frustum(self._frozen, reach) - self._origin, sides)

    def _place(self, actor: Any, points: Any, lines: list[list[int]] | None = None) -> None:
        import pyvista

        shape = pyvista.PolyData(np.asarray(points, np.float32))
        if lines is not None:
            shape = pyvista.PolyData(
                shape.points, lines=np.insert(np.array(lines), 0, 2, axis=1).ravel()
            )
        actor.mapper.SetInputData(shape)
        actor.visibility = True

    def _add(self, surface: pyvista.PolyData, **look: Any) -> Any:
        return self.plotter.add_mesh(
            surface, lighting=False, copy_mesh=False, reset_camera=False, render=False, **look
        )

    def _text(self, y: float, side: str) -> Any:
        from vtkmodules.vtkRenderingCore import vtkTextActor

        text = vtkTextActor()
        text.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
        text.SetPosition(0.01, y)
        look = text.GetTextProperty()
        look.SetFontFamilyToCourier()
        look.SetFontSize(_TEXT_SIZE)
        look.SetColor(0.08, 0.10, 0.14)
        look.SetBackgroundColor(1.0, 1.0, 1.0)
        look.SetBackgroundOpacity(0.65)
        if side == "top":
            look.SetVerticalJustificationToTop()
        else:
            look.SetVerticalJustificationToBottom()
        self.plotter.renderer.AddViewProp(text)
        return text

    def _write(self) -> None:
        self._readout.SetInput("\n".join(self.lines()) if self.texts_shown else "")
        self._footer.SetInput(self.note)
