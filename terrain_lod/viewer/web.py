"""The viewer as a page: the same scene and settings, drawn here, shown in a browser.

Uses pyvista's own web backend, trame. The page's controls are built from the tables of
``settings``; mouse events reach the window's own controls. Who may use it: ``lock``.
"""

from __future__ import annotations

import asyncio
import math
import socket
import sys
import webbrowser
from typing import Any, Final

from ..camera.camera import Camera
from ..errors import InputError, MissingExtraError, TerrainError
from .actions import ACTIONS, choice_help
from .controls import Controls
from .model import Model
from .settings import Slider
from .window import Window

_PERIOD: Final = 0.03  # seconds between two looks for something new
_SEEN_FROM_OUTSIDE: Final = (
    "Other machines reach this page. Whoever has its address, token included, can use the viewer "
    "and see what it shows; nothing is encrypted, so those on the way can read the token."
)


def serve(
    model: Model,
    camera: Camera,
    *,
    host: str = "127.0.0.1",
    port: int = 8080,
    open_browser: bool = False,
) -> None:
    """Serve the viewer as a page until interrupted; its address is said on stderr.

    Parameters
    ----------
    model : Model
    camera : Camera
        Where to begin; the page sets the size.
    host : str, optional
        Address to listen on. Whoever reaches it and has the page's address, with its token, can use
        the viewer.
    port : int, optional
        0 takes any that is free.
    open_browser : bool, optional

    Raises
    ------
    InputError, MissingExtraError
        As :func:`require_page`.
    GraphicsError
        If this machine cannot draw.
    """
    require_page(host, port)
    window = Window(model, camera, off_screen=True)
    try:
        window.texts_shown = False
        page = Page(window)
        page.open(host, port, open_browser)
    finally:
        window.close()


class Page:
    """A trame page around a window.

    Parameters
    ----------
    window : Window
        Off screen.

    Attributes
    ----------
    server : trame server
    """

    def __init__(self, window: Window) -> None:
        from trame.app import get_server

        self.window = window
        self.controls = Controls(window, panel=False)
        self.server: Any = get_server(name="terrain-lod", client_type="vue3")
        self._state = self.server.state
        self._state.trame__title = "terrain-lod"
        self._known: dict[str, Any] = {}  # settings as the page has them
        self._view: Any = None
        self._share_settings()
        self._share_readout()
        self._build()
        for choice in window.settings.choices:
            self._state.change(choice.name)(self._taker(choice.name))
        for slider in window.settings.numbers:
            self._state.change(slider.name)(self._taker(slider.name, slider))
        self.server.controller.on_server_ready.add(lambda **_: asyncio.ensure_future(self._run()))

    def open(self, host: str, port: int, open_browser: bool) -> None:
        """Serve the page until interrupted, locked; see :func:`serve`."""
        from .lock import Lock, is_loopback

        lock, server = Lock(host), self.server

        def bound(web_app: Any) -> None:
            # trame reads a command line that may be of another program
            web_app.config.update(host=host, port=port)
            lock.put_on(server, web_app, self._may_change)

        def ready(**_: Any) -> None:
            address = lock.address(server.port)
            print(f"{address}  (Ctrl-C ends it)", file=sys.stderr)
            if not is_loopback(host):
                print(_SEEN_FROM_OUTSIDE, file=sys.stderr)
            if open_browser:
                asyncio.get_running_loop().run_in_executor(None, webbrowser.open, address)

        server.controller.on_server_bind.add(bound)
        server.controller.on_server_ready.add(ready)
        server.start(open_browser=False, show_connection_info=False, timeout=0)

    async def _run(self) -> None:
        while True:
            try:
                self.pump()
            except TerrainError as error:
                self.window.note = str(error)
            await asyncio.sleep(_PERIOD)

    def pump(self) -> None:
        """Show what is new, and send it to the page."""
        if self.window.pump():
            self._view.update()
            with self._state:
                self._share_settings()
                self._share_readout()

    # settings and read-out, as the page's state

    def _share_settings(self) -> None:
        """Send the settings that the page did not set itself: those would fight with its hand."""
        settings = self.window.settings
        for choice in settings.choices:
            self._share(choice.name, settings.value(choice.name))
        shown = {slider.name for slider in settings.sliders}
        for slider in settings.numbers:
            value = settings.value(slider.name)
            self._share(slider.name, slider.on_scale(value))
            self._state[f"{slider.name}_said"] = slider.said(value)
            self._state[f"{slider.name}_low"] = slider.on_scale(slider.low)
            self._state[f"{slider.name}_high"] = slider.on_scale(slider.high)
            self._state[f"{slider.name}_shown"] = slider.name in shown

    def _share(self, name: str, value: Any) -> None:
        if self._known.get(name) != value:
            self._known[name] = self._state[name] = value

    def _share_readout(self) -> None:
        frame = self.window.frame
        self._state.readout = list(self.window.readout())
        self._state.note = self.window.note.split("\n") if self.window.note else []
        self._state.triangle_count = 0 if frame is None else len(frame.mesh.triangles)

    def _may_change(self, change: Any) -> bool:
        """Return whether a change of the page's state is of a setting, to what that can be."""
        name, value = change["key"], change["value"]
        for choice in self.window.settings.choices:
            if choice.name == name:
                return value in choice.values
        is_slider = any(slider.name == name for slider in self.window.settings.numbers)
        return is_slider and isinstance(value, int | float) and math.isfinite(value)

    def _taker(self, name: str, slider: Slider | None = None) -> Any:
        """Return what takes a value from the page."""

        def take(**state: Any) -> None:
            value = state[name]
            if value == self._known[name]:
                return
            if slider is not None:
                value = slider.of_scale(min(float(value), slider.on_scale(slider.high)))
            try:
                self.window.change(name, value)
                held = self.window.settings.value(name)
                self._known[name] = held if slider is None else slider.on_scale(held)
            except TerrainError as error:
                self.window.note = str(error)
                self.window.redraw()

        return take

    # the page

    def _build(self) -> None:
        from trame.ui.vuetify3 import SinglePageWithDrawerLayout
        from trame.widgets import client, html, vuetify3
        from trame_pyvista import PyVistaRemoteView

        with SinglePageWithDrawerLayout(self.server) as layout:
            client.Style("html { overflow-y: hidden !important }")
            layout.title.set_text("terrain-lod")
            layout.footer.hide()
            with layout.toolbar:
                vuetify3.VSpacer()
                html.Span(
                    "{{ triangle_count.toLocaleString('en') }} triangles", id="triangle-count"
                )
                for action in ACTIONS:
                    if action.on_page:
                        vuetify3.VBtn(
                            action.label,
                            id=action.label,
                            title=f"{action.help} ({action.keys[0]})",
                            click=lambda key=action.keys[0]: self.controls.press(key),
                        )
            with layout.drawer as drawer:
                drawer.width = 330
                self._build_controls()
            with (
                layout.content,
                vuetify3.VContainer(
                    fluid=True, classes="pa-0 fill-height", style="position: relative"
                ),
            ):
                self._view = PyVistaRemoteView(self.window.plotter, interactive_ratio=1)
                html.Pre("{{ readout.join('\\n') }}", id="readout", style=f"{_GLASS}; top: 0")
                html.Pre(
                    "{{ note.join('\\n') }}",
                    v_show="note.length",
                    id="note",
                    style=f"{_GLASS}; bottom: 0",
                )

    def _build_controls(self) -> None:
        from trame.widgets import html, vuetify3

        for choice in self.window.settings.choices:
            label = choice.label or choice.name
            told = f"{choice_help(choice)} ({choice.key})"
            if isinstance(choice.values[0], bool):
                vuetify3.VSwitch(
                    v_model=(choice.name,),
                    label=label,
                    id=choice.name,
                    title=told,
                    color="primary",
                    **_DENSE,
                )
            else:
                vuetify3.VSelect(
                    v_model=(choice.name,),
                    items=(f"{choice.name}_values", list(choice.values)),
                    label=label,
                    id=choice.name,
                    title=told,
                    **_DENSE,
                )
        for slider in self.window.settings.numbers:
            low, high = slider.on_scale(slider.low), slider.on_scale(slider.high)
            with html.Div(v_show=(f"{slider.name}_shown",), classes="px-4"):
                html.Small(f"{slider.label}: {{{{ {slider.name}_said }}}}")
                vuetify3.VSlider(
                    v_model=(slider.name,),
                    min=(f"{slider.name}_low",),
                    max=(f"{slider.name}_high",),
                    step=1 if slider.whole and not slider.logarithmic else (high - low) / 500,
                    id=slider.name,
                    **_DENSE,
                )


_DENSE: Final = {"density": "compact", "hide_details": True, "classes": "mx-3 my-1"}
_GLASS: Final = (
    "position: absolute; left: 0; margin: 8px; padding: 4px 8px; font-size: 12px; "
    "background: rgba(255, 255, 255, 0.65); pointer-events: none; z-index: 1"
)


def require_page(host: str, port: int) -> None:
    """Return where a page can be served.

    Raises
    ------
    InputError
        If the port is taken, or the address is not of this machine.
    MissingExtraError
        Without the extra ``[web]``.
    """
    try:
        import trame.widgets.vuetify3  # noqa: F401
        import trame_pyvista  # noqa: F401
    except ImportError as error:
        raise MissingExtraError(
            f"expected trame for --web, got no {error.name}: install 'terrain_lod[web]'"
        ) from None
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except (OSError, OverflowError) as error:
            reason = getattr(error, "strerror", None) or error
            raise InputError(
                f"cannot listen on {host}, port {port} ({reason}): choose another with --port or "
                "--host"
            ) from None
