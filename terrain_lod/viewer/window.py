"""A window on a model: the newest mesh, the camera that is driven, the read-out.

Input only changes what is wanted; :meth:`Window.pump`, called some sixty times a second, shows the
newest frame and draws. Meshes are made on the engine's thread, so neither input nor drawing waits
for one.

While any window is open, Python's collector of cycles runs here alone: on the engine's thread it
would end objects of VTK's, and VTK would wait for itself.
"""

from __future__ import annotations

import gc
import math
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter
from typing import Any, Final

from ..camera.camera import Camera
from ..drawing.picture import Picture, save_png
from ..errors import InputError, TerrainError
from .engine import Engine
from .memory import COLLECTOR
from .model import Model
from .rig import Rig
from .scene import Frame, Request
from .settings import Settings
from .stage import Stage

# a new mesh that comes this soon is worth waiting for: drawing the old one would hold it up
_PATIENCE: Final = 0.1  # seconds
_LOOK_AFTER: Final = 1.0  # seconds between looks at the model's file
_LONG: Final = 0.5  # seconds after which a mesh that is not there is worth a word
_UNNOTED: Final = 1e-3  # how far the camera is moved without a word, in diagonals
_FRUSTUM: Final = 0.35  # how deep it is drawn, in diagonals


@dataclass(frozen=True)
class _Picked:
    """A pixel that was clicked, the camera it was seen with, and what was noted of it."""

    camera: Camera
    x: int
    y: int
    note: str


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
    stage : Stage
        What is drawn.
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
        self.stage = Stage(camera.size, off_screen)
        self.plotter = self.stage.plotter
        self.model = model
        self.settings: Settings = model.scene.settings
        self.frame: Frame | None = None
        self.note = ""
        self.home = self.rig = self._held(Rig.of(camera))
        self.draw_seconds = 0.0
        self.texts_shown = True
        self._scene = model.scene
        self._frozen: Camera | None = None
        self._picked: _Picked | None = None
        self._dirty = True
        self._size: tuple[int, int] | None = None
        self._asked, self._asked_at = 0, perf_counter()
        self._late = False  # whether the mesh that was asked for takes long
        self._problem: str | None = None
        self._looked = perf_counter()
        self._waiting: float | None = None  # since when there is something to draw
        COLLECTOR.hold(self)
        self.engine = Engine(model)

    # what is wanted

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels; 0 where the window is folded away."""
        return self.stage.size

    @property
    def camera(self) -> Camera:
        """Where the window looks from."""
        return self.rig.camera(self.size)

    def drive(self, rig: Rig) -> None:
        """Move the camera, as far as the ground lets it, and want the mesh for it."""
        self.rig = self._held(rig)
        self._dirty = True
        if self._frozen is None:
            self.ask()

    def _held(self, rig: Rig) -> Rig:
        """Return the rig kept where there is something to see; note it if that is elsewhere."""
        scene = self.model.scene
        held = rig.within(scene)
        moved = math.dist(replace(rig, pitch=held.pitch).eye, held.eye)
        if not moved < _UNNOTED * scene.diagonal:
            self.note = "the camera stays above the ground and near it"
        return held

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
        self._asked, self._asked_at = self._asked + 1, perf_counter()
        camera = self._frozen or self.camera
        self.engine.ask(Request(camera, self.settings, self._asked), reload=reload)

    def reload(self) -> None:
        """Want the scene read again; what was read before stays if it cannot be."""
        if not self.model.scene.read_by_vtk:
            self.ask(reload=True)
            return
        try:
            self.model.reload()
        except TerrainError as error:
            self.note, self._dirty = str(error), True
        else:
            self.ask()

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
        """Note what goes wrong or takes long; once a second tidy up, and look at the file."""
        problem, before = self.engine.problem, self._problem
        news, self._problem = problem if problem != before else None, problem
        if problem is None and before is not None and self.note == before:
            self.note, self._dirty = "", True  # the picture that is shown has no problem
        late = self.engine.working and perf_counter() - self._asked_at > _LONG
        self._dirty, self._late = self._dirty or late != self._late, late
        if perf_counter() - self._looked > _LOOK_AFTER:
            self._looked = perf_counter()
            gc.collect(1)
            news = news or self.model.news()
        if news is not None:
            self.note, self._dirty = news, True

    def draw(self) -> None:
        """Draw what is there."""
        self._dirty, self._waiting = False, None
        begun = perf_counter()
        self.stage.write("\n".join(self.lines()) if self.texts_shown else "", self.note)
        scene = self.model.scene if self.frame is None else self.frame.scene
        fronts_alone = self._frozen is None and scene.shows_fronts_alone(self.rig.eye)
        self.stage.draw(self.camera, fronts_alone=fronts_alone)
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
            frame = self.frame
            newest = frame is not None and frame.request.number == self._asked and frame.is_complete
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
        shown = self.stage.pixels()
        if path is not None:
            save_png(shown, path)
        return shown

    def pick(self, x: int, y: int) -> None:
        """Note what is known of what a pixel shows, counted from the lower left.

        The place is looked up again in every mesh that is shown, until there is another note.
        """
        if self.frame is not None:
            self._note_pick(self.frame, self.camera, x, y)

    def _note_pick(self, frame: Frame, camera: Camera, x: int, y: int) -> None:
        pick = frame.pick(camera, x, y)
        self.note = "nothing there" if pick is None else "\n".join(pick.lines())
        self.stage.show_mark(None if pick is None else pick.point)
        self._picked, self._dirty = _Picked(camera, x, y, self.note), True

    def lines(self) -> tuple[str, ...]:
        """Return the read-out."""
        if self.frame is None:
            return ("making the first mesh",)
        late = "  making the next mesh" if self._late else ""
        return (*self.frame.lines(), f"drawn in {1e3 * self.draw_seconds:.0f} ms{late}")

    def close(self) -> None:
        """End the engine and the window."""
        self.engine.close()
        self.plotter.close()
        COLLECTOR.release(self)
        gc.collect()

    def _show(self, frame: Frame) -> None:
        self.frame, self._dirty = frame, True
        self.stage.show(frame)
        picked = self._picked
        if picked is not None and self.note == picked.note:
            self._note_pick(frame, picked.camera, picked.x, picked.y)
        self.stage.show_frustum(self._frozen, _FRUSTUM * frame.scene.diagonal)
        if self._scene is not frame.scene:
            self._scene = frame.scene
            self.settings = replace(self.settings, diagonal=frame.scene.diagonal)
            self.home = self.home.within(frame.scene)
            self.rig = self.rig.within(frame.scene)
