"""Look at ground and meshes: in a window, off screen, or as a page in the browser."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from ctypes import CDLL, c_char_p, c_void_p
from pathlib import Path
from typing import Any, Final

import numpy.typing as npt

from ..arguments import file_path, instance
from ..camera.camera import Camera
from ..device.device import Device
from ..errors import GraphicsError
from ..ground.heightmap import Heightmap
from ..mesh.mesh import Mesh
from ..streaming.terrain import StreamingTerrain
from .controls import Controls
from .mesh_scene import BezierScene, CurvedScene
from .model import Model
from .movie import Movie
from .scene import Scene
from .streaming_scene import StreamingScene
from .terrain_scene import TerrainScene
from .window import Window

_PERIOD: Final = 15  # milliseconds between two looks for something new


def view(
    what: Model | Heightmap | StreamingTerrain | Mesh | npt.ArrayLike,
    camera: Camera | None = None,
    *,
    settings: Mapping[str, Any] | None = None,
    record: str | Path | None = None,
    device: Device | None = None,
) -> None:
    """Open a window to fly over ground or around a curved mesh; return when it is closed.

    Keys and mouse are those of ``terrain-lod view``, whose ``--help`` lists them.

    Parameters
    ----------
    what : Heightmap, StreamingTerrain, Mesh, (P, 4, 4, 3) array_like, or Model
        Ground, in memory or on disk; triangles, to be curved as PN-triangles; Bézier patches; or a
        scene that can be read again from its file.
    camera : Camera, optional
        Where to begin; its size is the window's.
    settings : mapping, optional
        What to begin with, such as ``{"mode": "lod", "pixels": 2.0}``: fields of
        ``TerrainSettings``, ``CurvedSettings`` or ``BezierSettings`` in ``terrain_lod/viewer/``.
    record : str or Path, optional
        GIF or MP4 of all that is shown.
    device : Device, optional

    Raises
    ------
    InputError
        If it cannot be looked at, or a setting is unknown.
    GraphicsError
        If there is no display, or nothing can be drawn.
    """
    model = _model(what, settings, device)
    path = None if record is None else file_path("record", record)
    eye = _eye(camera, model)
    require_display()
    window = Window(model, eye)
    try:
        controls = Controls(window)
        controls.record(path)
        interactor = window.plotter.iren.interactor
        interactor.Initialize()
        interactor.AddObserver("TimerEvent", lambda *_: controls.pump())
        interactor.CreateRepeatingTimer(_PERIOD)
        window.draw()
        with _ended_by_interrupt(interactor):
            interactor.Start()
        controls.record(None)
    finally:
        window.close()


def look(
    what: Model | Heightmap | StreamingTerrain | Mesh | npt.ArrayLike,
    camera: Camera | None = None,
    *,
    settings: Mapping[str, Any] | None = None,
    picture: str | Path | None = None,
    record: str | Path | None = None,
    frames: int = 60,
    device: Device | None = None,
) -> tuple[str, ...]:
    """Do without a display what the window would: a picture, and a flight around the target.

    Parameters
    ----------
    what, camera, settings, device
        As for :func:`view`.
    picture : str or Path, optional
        PNG of the first view.
    record : str or Path, optional
        GIF or MP4 of a flight once around the target.
    frames : int, optional
        Pictures of that flight.

    Returns
    -------
    tuple of str
        The read-out of the first view, and what there is to note.

    Raises
    ------
    InputError
        If it cannot be looked at, or a setting is unknown.
    GraphicsError
        If nothing can be drawn.
    """
    model = _model(what, settings, device)
    movie = None if record is None else Movie(file_path("record", record))
    window = Window(model, _eye(camera, model), off_screen=True)
    try:
        window.settle(measured=True)
        if picture is not None:
            window.picture(picture)
        lines = (*window.lines(), *window.note.splitlines())
        if movie is not None:
            for _ in range(frames):
                movie.add(window.picture())
                window.drive(window.rig.orbit(360 / frames, 0.0))
                window.settle()
            movie.close()
        return lines
    finally:
        window.close()


def scene_of(
    what: Heightmap | StreamingTerrain | Mesh | npt.ArrayLike, *, device: Device | None = None
) -> Scene:
    """Return what is looked at as the viewer's scene; see :func:`view`."""
    if isinstance(what, Heightmap):
        return TerrainScene(what, device=device)
    if isinstance(what, StreamingTerrain):
        return StreamingScene(what)
    if isinstance(what, Mesh):
        return CurvedScene(what, device=device)
    return BezierScene(what, device=device)


def require_display() -> None:
    """Return where a window can be opened.

    Raises
    ------
    GraphicsError
        Where it cannot; the message names the ways without one.
    """
    if sys.platform != "linux":
        return
    name = os.environ.get("DISPLAY")
    if not name or not _opens(name):
        got = f"DISPLAY {name}, which does not open" if name else "none"
        raise GraphicsError(
            f"expected a display for a window, got {got}: use --off-screen or --web"
        )


def _model(
    what: Model | Heightmap | StreamingTerrain | Mesh | npt.ArrayLike,
    settings: Mapping[str, Any] | None,
    device: Device | None,
) -> Model:
    if isinstance(what, Model):
        model = what
    else:
        scene = scene_of(what, device=device)
        model = Model(lambda: scene)
    given = instance("a dict for settings", {} if settings is None else settings, Mapping)
    for name, value in given.items():
        model.scene.settings = model.scene.settings.changed(name, value)
    return model


def _eye(camera: Camera | None, model: Model) -> Camera:
    return model.scene.camera() if camera is None else instance("a Camera", camera, Camera)


@contextmanager
def _ended_by_interrupt(interactor: Any) -> Iterator[None]:
    """End the window's loop at Ctrl-C: an exception would be lost in VTK's callbacks."""
    before = signal.signal(signal.SIGINT, lambda *_: interactor.TerminateApp())
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _opens(name: str) -> bool:
    """Ask X itself: VTK ends the process where it cannot open a display."""
    try:
        x11 = CDLL("libX11.so.6")
    except OSError:
        return False
    x11.XOpenDisplay.argtypes, x11.XOpenDisplay.restype = [c_char_p], c_void_p
    x11.XCloseDisplay.argtypes = [c_void_p]
    display = x11.XOpenDisplay(name.encode())
    if display:
        x11.XCloseDisplay(display)
    return bool(display)
