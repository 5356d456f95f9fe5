"""A folder of tiles, served to this machine's browsers with the headers that clients want."""

from __future__ import annotations

import urllib.parse
from dataclasses import dataclass
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Final

from ..arguments import whole
from ..errors import FileError, InputError

HOST: Final = "127.0.0.1"
TILES: Final = "/tiles/"
# what stands in a folder of tiles, and the page that shows it
_PAGES: Final = {
    "layer.json": "cesium.html",
    "tileset.json": "cesium.html",
    "tiles.json": "maplibre.html",
}
_TYPES: Final = {
    ".terrain": "application/vnd.quantized-mesh",
    ".glb": "model/gltf-binary",
    ".subtree": "application/octet-stream",
    ".json": "application/json",
    ".png": "image/png",
    ".html": "text/html; charset=utf-8",
    ".css": "text/css",
    ".js": "text/javascript",
    ".mjs": "text/javascript",
    ".wasm": "application/wasm",
    ".svg": "image/svg+xml",
}
_GZIP: Final = b"\x1f\x8b"


@dataclass(frozen=True)
class Site:
    """What is served.

    Attributes
    ----------
    tiles : Path
        Under /tiles/.
    page : Path
        As /.
    libraries : dict of str to Path
        Folders under other names.
    """

    tiles: Path
    page: Path
    libraries: dict[str, Path]

    @classmethod
    def of(cls, folder: str | Path, library: str | Path | None = None) -> Site:
        """Return a folder of tiles with a page that shows it.

        Parameters
        ----------
        folder : str or Path
            As written by :func:`terrain_lod.write_tiles`.
        library : str or Path, optional
            npm's copy of what draws: ``node_modules/cesium``, or ``node_modules/maplibre-gl``.
            Without it there is no page, and the tiles are there for other clients.

        Raises
        ------
        FileError
            If there is no such folder.
        InputError
            If it holds no tiles, or `library` is not the one that draws them.
        """
        folder = Path(folder)
        if not folder.is_dir():
            raise FileError(f"expected a folder of tiles, got none at {folder}")
        found = [name for name in _PAGES if (folder / name).is_file()]
        if not found:
            names = ", ".join(_PAGES)
            raise InputError(f"expected a folder of tiles with one of {names}, got {folder}")
        page = Path(__file__).with_name(_PAGES[found[0]])
        if library is None:
            return cls(folder, Path(__file__).with_name("bare.html"), {})
        wanted = {"cesium.html": "Build/Cesium", "maplibre.html": "dist"}[page.name]
        if not (Path(library) / wanted).is_dir():
            name = {"cesium.html": "cesium", "maplibre.html": "maplibre-gl"}[page.name]
            raise FileError(
                f"expected npm's copy of {name} with {wanted} in it, got {library}: "
                f"npm install {name}, and give node_modules/{name}"
            )
        return cls(folder, page, {"/library/": Path(library) / wanted})

    def file(self, address: str) -> Path | None:
        """Return the file at an address, None where there is none."""
        path = urllib.parse.unquote(urllib.parse.urlsplit(address).path)
        if path == "/":
            return self.page
        for prefix, folder in {TILES: self.tiles, **self.libraries}.items():
            if path.startswith(prefix):
                file = (folder / path.removeprefix(prefix)).resolve()
                inside = file.is_relative_to(folder.resolve())
                return file if inside and file.is_file() else None
        return None


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: _Server

    def do_GET(self) -> None:
        file = self.server.site.file(self.path)
        try:
            content = None if file is None else file.read_bytes()
        except OSError:
            content = None
        if file is None or content is None:
            self.send_response(HTTPStatus.NOT_FOUND)
            self._end(b"")
            return
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", _TYPES.get(file.suffix, "application/octet-stream"))
        if content.startswith(_GZIP):
            self.send_header("Content-Encoding", "gzip")
        self._end(content)

    do_HEAD = do_GET

    def _end(self, content: bytes) -> None:
        # pages of other programs on this machine may use the tiles as well
        self.send_header("Access-Control-Allow-Origin", "*")
        self.send_header("Cache-Control", "no-cache")
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)

    def log_message(self, format: str, *arguments: object) -> None:
        pass


class _Server(ThreadingHTTPServer):
    daemon_threads = True
    site: Site


def server_of(site: Site, port: int = 0) -> ThreadingHTTPServer:
    """Return a server of a site on the loopback, not yet serving; port 0 takes one that is free.

    Raises
    ------
    InputError
        If the port is none, or taken.
    """
    try:
        server = _Server((HOST, whole("port", port, 0, 65535)), _Handler)
    except OSError as error:
        raise InputError(
            f"expected a port that is free, got {port} ({error.strerror}): --port 0 takes any"
        ) from None
    server.site = site
    return server
