"""Mouse, keys and sliders of a window. What keys do stands in `actions.py`."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, Final

from ..errors import FileError, TerrainError
from .actions import ACTIONS
from .movie import Movie
from .rig import Rig
from .settings import Settings, Slider
from .window import Window

_WHEEL: Final = 1.15  # zoom a notch
_TURN: Final = 180.0  # degrees that a drag across the whole window turns
_LOOK: Final = 60.0
_ROW: Final = 0.08  # of the window's height, a slider
_STILL: Final = 3  # pixels within which a drag is a click
_FLIGHT: Final = {
    **dict.fromkeys(("w", "Up"), (1.0, 0.0)),
    **dict.fromkeys(("s", "Down"), (-1.0, 0.0)),
    **dict.fromkeys(("a", "Left"), (0.0, -1.0)),
    **dict.fromkeys(("d", "Right"), (0.0, 1.0)),
}


class Controls:
    """What a user does to a window.

    Parameters
    ----------
    window : Window
    pictures : Path, optional
        Folder that screenshots and recordings go to.
    panel : bool, optional
        Whether there are sliders in the picture.
    """

    def __init__(self, window: Window, *, pictures: Path = Path(), panel: bool = True) -> None:
        from vtkmodules.vtkInteractionStyle import vtkInteractorStyleUser

        self.window = window
        self.flying = False
        self.movie: Movie | None = None
        self._pictures = pictures
        self._drag: str | None = None
        self._from = self._last = (0, 0)
        interactor: Any = window.plotter.iren.interactor
        self._interactor = interactor
        self._style = vtkInteractorStyleUser()
        # VTK's own characters (3 is stereo, w is wireframe) are ours
        self._style.AddObserver("CharEvent", lambda *_: None)
        interactor.SetInteractorStyle(self._style)
        window.plotter.iren.clear_key_event_callbacks()  # pyvista's own
        for button, drag in (("Left", "turn"), ("Middle", "pan"), ("Right", "zoom")):
            self._on(f"{button}ButtonPress", partial(self._press, drag))
            self._on(f"{button}ButtonRelease", self._release)
        self._on("MouseMove", self._move)
        self._on("MouseWheelForward", lambda: self._zoom(_WHEEL))
        self._on("MouseWheelBackward", lambda: self._zoom(1 / _WHEEL))
        self._on("KeyPress", lambda: self.press(interactor.GetKeySym()))
        self.widgets: dict[str, Any] = {}
        self._synced: tuple[Settings, bool] | None = None
        if panel:
            self._add_sliders()

    def _on(self, event: str, action: Callable[[], None]) -> None:
        """Do `action` at an event; what goes wrong is noted in the window."""

        def act(*_: object) -> None:
            try:
                action()
            except TerrainError as error:
                self.window.note = str(error)
                self.window.redraw()

        self._interactor.AddObserver(f"{event}Event", act)

    def pump(self) -> None:
        """Show what is new; add it to the recording."""
        if self.widgets and self._synced != (self.window.settings, self.window.texts_shown):
            self._sync_sliders()
        drawn = self.window.pump()
        if drawn and self.movie is not None:
            try:
                self.movie.add(self.window.picture())
            except FileError as error:
                self.movie, self.window.note = None, f"the recording ends: {error}"
                self.window.redraw()

    # keys

    def press(self, key: str | None) -> None:
        """Do what a key is for.

        Raises
        ------
        TerrainError
            If it cannot be done.
        """
        window, key = self.window, key or ""
        window.redraw()
        for choice in window.settings.choices:
            if key == choice.key:
                window.apply(window.settings.next(choice.name))
        modes = window.settings.modes
        if key.isdigit() and 1 <= int(key) <= len(modes):
            window.change("mode", modes[int(key) - 1])
        if key in _FLIGHT:
            forward, right = _FLIGHT[key]
            window.drive(window.rig.fly(forward * self._step(), right * self._step()))
        for action in ACTIONS:
            if key in action.keys:
                getattr(self, action.method)()

    def show_help(self) -> None:
        self.window.help_shown = not self.window.help_shown

    def show_details(self) -> None:
        self.window.details_shown = not self.window.details_shown

    def switch_flight(self) -> None:
        self.flying = not self.flying
        self.window.note = "drag to look around" if self.flying else "drag to orbit"

    def reset(self) -> None:
        self.window.drive(self.window.home)

    def reload(self) -> None:
        self.window.note = "reading the file again"
        self.window.reload()

    def take_picture(self) -> None:
        path = self._free("terrain-lod", ".png")
        self.window.picture(path)
        self.window.note = f"wrote {path}"

    def switch_recording(self) -> None:
        self.record(None if self.movie else self._free("terrain-lod", ".gif"))

    def hide(self) -> None:
        self.window.texts_shown = not self.window.texts_shown

    def quit(self) -> None:
        self._interactor.TerminateApp()

    def record(self, path: Path | None) -> None:
        """Begin a recording to `path`; None ends the one that runs, written or not.

        Raises
        ------
        TerrainError
            If one of the two cannot be written.
        """
        ended, self.movie = self.movie, None
        if ended is not None:
            ended.close()
            self.window.note = f"wrote {ended.path}"
        self.movie = None if path is None else Movie(path)
        if path is not None:
            self.window.note = f"recording {path}"

    def _step(self) -> float:
        """Return how far a key flies: the higher, the farther; world units."""
        scene, (x, y, z) = self.window.model.scene, self.window.rig.eye
        above = min(z - scene.floor(x, y), 0.5 * scene.diagonal)
        return max(0.1 * above, 1e-3 * scene.diagonal)

    def _free(self, stem: str, ending: str) -> Path:
        """Return the first name that no file has."""
        number = 1
        while (path := self._pictures / f"{stem}-{number:03d}{ending}").exists():
            number += 1
        return path

    # mouse

    def _press(self, drag: str) -> None:
        self._from = self._last = self._interactor.GetEventPosition()
        self._drag = "pan" if drag == "turn" and self._interactor.GetShiftKey() else drag

    def _release(self) -> None:
        drag, self._drag = self._drag, None
        if drag == "turn" and math.dist(self._from, self._last) <= _STILL:
            self.window.pick(*self._from)

    def _move(self) -> None:
        here = self._interactor.GetEventPosition()
        width, height = self.window.size
        if self._drag is None or min(width, height) < 1:
            return
        across, up = (here[0] - self._last[0]) / width, (here[1] - self._last[1]) / height
        self._last = here
        if math.dist(self._from, here) > _STILL:
            self.window.drive(self._dragged(self.window.rig, across, up))

    def _dragged(self, rig: Rig, across: float, up: float) -> Rig:
        """Return the rig after a drag by shares of the window."""
        if self._drag == "pan":
            return rig.pan(-across, -up)
        if self._drag == "zoom":
            return rig.zoom(math.exp(2 * up))
        if self.flying:
            return rig.look(-_LOOK * across, -_LOOK * up)
        return rig.orbit(-_TURN * across, -_TURN * up)

    def _zoom(self, factor: float) -> None:
        self.window.drive(self.window.rig.zoom(factor))

    # sliders

    def _add_sliders(self) -> None:
        for slider in self.window.settings.numbers:
            low, high = slider.on_scale(slider.low), slider.on_scale(slider.high)
            widget = self.window.plotter.add_slider_widget(
                lambda value, slider=slider: self._slide(slider, value),
                (low, high),
                value=slider.on_scale(self.window.settings.value(slider.name)),
                title=slider.label,
                color=(0.10, 0.14, 0.20),
                interaction_event="always",
                title_height=0.018,
                slider_width=0.018,
                tube_width=0.004,
            )
            shape = widget.GetRepresentation()
            shape.ShowSliderLabelOff()
            shape.SetSliderLength(0.012)
            shape.SetEndCapLength(0.004)
            shape.GetTitleProperty().ShadowOff()
            self.widgets[slider.name] = widget
        self._sync_sliders()

    def _slide(self, slider: Slider, value: float) -> None:
        self.window.change(slider.name, slider.of_scale(value))

    def _sync_sliders(self) -> None:
        """Show the sliders of the LOD that is chosen, below each other, at the settings' values."""
        settings, row, fresh = self.window.settings, 0, False
        self._synced = settings, self.window.texts_shown
        shown = {slider.name for slider in settings.sliders} if self.window.texts_shown else set()
        for slider in settings.numbers:
            widget = self.widgets[slider.name]
            shape = widget.GetRepresentation()
            value = settings.value(slider.name)
            shape.SetMinimumValue(slider.on_scale(slider.low))
            shape.SetMaximumValue(slider.on_scale(slider.high))
            shape.SetValue(slider.on_scale(value))
            shape.SetTitleText(f"{slider.label}: {slider.said(value)}")
            if slider.name in shown:
                y = 0.96 - _ROW * row
                shape.GetPoint1Coordinate().SetValue(0.80, y)
                shape.GetPoint2Coordinate().SetValue(0.98, y)
                shape.Modified()
                row += 1
            if bool(widget.GetEnabled()) != (slider.name in shown):
                widget.SetEnabled(slider.name in shown)
                fresh = True
        self.window.stage.show_panel(_ROW * row + 0.03 if row else 0.0)
        # a click on a slider of VTK's that was never drawn ends the process
        if fresh and min(self.window.size) > 0:
            self.window.draw()
