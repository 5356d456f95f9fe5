"""Who may use the viewer's page: whoever was given its address, and no other page of a browser.

A browser lets every page that it shows send requests to this machine, and a foreign page may have
its own name point here (DNS rebinding). So each request must name this machine, must come from this
page if it comes from a page at all, and must bring the token of the printed address: in its query,
or in the cookie that the first visit sets. A page that is let in may then only do what ours does:
change settings, press its buttons, move the camera.
"""

from __future__ import annotations

import logging
import re
import secrets
import socket
from collections.abc import Awaitable, Callable
from contextlib import suppress
from ipaddress import ip_address
from typing import Any, Final

from aiohttp import web

_log = logging.getLogger(__name__)

# what the page calls as it is; trame and VTK offer more, such as an end of the server
_CALLS: Final = (
    "trame.state.get",
    "viewport.image.push",
    "viewport.image.push.invalidate.cache",
    "viewport.image.push.observer.add",
    "viewport.image.push.observer.remove",
    "viewport.image.push.original.size",
    "viewport.image.push.quality",
    "viewport.mouse.interaction",
    "viewport.mouse.zoom.wheel",
)
_LOOPBACK: Final = ("localhost", "127.0.0.1", "[::1]")
_HOST: Final = re.compile(r"(\[[0-9a-f:.]+\]|[\w.-]+)(?::\d{1,5})?", re.IGNORECASE)
_PAGE: Final = ("/", "/index.html")
_FRAME: Final = 12  # bytes before a message of wslink: its number, where it begins, its size
_HEADERS: Final = {
    # no script of elsewhere, no other server, no frame around the page; Vue compiles templates
    "Content-Security-Policy": "default-src 'self' 'unsafe-inline' 'unsafe-eval' data: blob:; "
    "frame-ancestors 'none'",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-cache",
}
_Handler = Callable[[web.Request], Awaitable[web.StreamResponse]]


class Lock:
    """Keeps foreign pages from a trame server.

    Parameters
    ----------
    host : str
        Address that the server listens on.

    Attributes
    ----------
    token : str
        What the address of the page must bring; new with every lock.
    """

    def __init__(self, host: str) -> None:
        self.token = secrets.token_urlsafe(24)
        self._anywhere = not is_loopback(host)
        own = (socket.gethostname(), socket.getfqdn()) if self._anywhere else ()
        anyone = _is_number(host) and ip_address(host).is_unspecified
        self._shown = socket.gethostname() if anyone else _bracketed(host)
        self._names = {name.lower() for name in (*_LOOPBACK, _bracketed(host), *own)}

    def address(self, port: int) -> str:
        """Return where the page is, token included."""
        return f"http://{self._shown}:{port}/?token={self.token}"

    def put_on(self, server: Any, web_app: Any, settable: Callable[[Any], bool]) -> None:
        """Lock a trame server before it listens.

        Parameters
        ----------
        server : trame server
        web_app : wslink server
        settable : callable
            Whether a change of the page's state is one that the page may make.
        """
        server.protocol.updateSecret(self.token)  # of the WebSocket; trame's own is public
        web_app.app.middlewares.append(self._guard)
        # a call that fails is told to its page; wslink would print where
        logging.getLogger("wslink").addHandler(logging.NullHandler())

        def update(protocol: Any, changes: list[Any]) -> None:
            protocol.update_state([change for change in changes if settable(change)])

        async def press(protocol: Any, button: str, *_: Any) -> None:
            await protocol.trigger(button, [], {})

        own = {
            "trame.state.update": update,
            "trame.trigger": press,
            # told by every page as it comes and goes; nothing here waits for that
            "trame.lifecycle.update": lambda *_: None,
        }
        for handler in web_app._ws_handlers:
            handler.functionMap = {
                **{name: handler.functionMap[name] for name in _CALLS},
                **{name: (server.protocol, call) for name, call in own.items()},
            }
            _send_to_those_there(handler)
            _take_whole_messages(handler)

    @web.middleware
    async def _guard(self, request: web.Request, handler: _Handler) -> web.StreamResponse:
        host = request.headers.get("Host", "")
        if not self._is_own(host):
            raise web.HTTPForbidden(text="expected the name of the machine that the viewer runs on")
        if request.headers.get("Origin") not in (None, f"http://{host}", f"https://{host}"):
            raise web.HTTPForbidden(text="expected the viewer's own page, got a foreign one")
        # browsers share the cookies of a machine's ports
        cookie = f"terrain-lod-{request.url.port}"
        given = (request.query.get("token", ""), request.cookies.get(cookie, ""))
        if not any(map(self._is_token, given)):
            raise web.HTTPForbidden(text="expected the address that the viewer printed, with token")
        # trame's page takes the secret from its address, and nothing else may stand there
        if request.path in _PAGE and request.query_string != f"secret={self.token}":
            found = web.HTTPFound(f"index.html?secret={self.token}")
            found.set_cookie(cookie, self.token, httponly=True, samesite="Strict")
            raise found
        response = await handler(request)
        response.headers.update(_HEADERS)
        return response

    def _is_own(self, host: str) -> bool:
        """Return whether a Host header names this machine; no foreign name is a number."""
        match = _HOST.fullmatch(host)
        if match is None:
            return False
        name = match[1].lower()
        return name in self._names or (self._anywhere and _is_number(name))

    def _is_token(self, given: str) -> bool:
        return secrets.compare_digest(given.encode(errors="replace"), self.token.encode())


def is_loopback(host: str) -> bool:
    """Return whether only this machine itself reaches an address."""
    return host == "localhost" or (_is_number(host) and ip_address(host.strip("[]")).is_loopback)


def _is_number(host: str) -> bool:
    try:
        ip_address(host.strip("[]"))
    except ValueError:
        return False
    return True


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host else host


def _send_to_those_there(handler: Any) -> None:
    """Have messages to a client that is gone be lost, and not those to the others as well."""
    greet = handler.onConnect

    async def greet_and_mark(request: web.Request, client: str) -> None:
        connection = handler.connections[client]
        send = connection.send_bytes

        async def send_if_there(message: bytes) -> None:
            with suppress(ConnectionError):
                await send(message)

        connection.send_bytes = send_if_there
        await greet(request, client)

    handler.onConnect = greet_and_mark


def _take_whole_messages(handler: Any) -> None:
    """Take messages that come in one frame, as the page's do, and hang up on anything else.

    wslink makes room for whatever size a frame claims, and prints where it fails.
    """
    take = handler.onMessage

    async def take_whole(is_binary: bool, message: Any, client: str) -> None:
        try:
            if not is_binary:
                raise ValueError("expected a binary message, got text")
            start, size = message.data[4:8], int.from_bytes(message.data[8:_FRAME], "little")
            if start != bytes(4) or size != len(message.data) - _FRAME:
                raise ValueError("expected a whole message, got part of one")
            await take(is_binary, message, client)
        except Exception:
            _log.debug("a client of the page was sent away", exc_info=True)
            await handler.connections[client].close()

    handler.onMessage = take_whole
