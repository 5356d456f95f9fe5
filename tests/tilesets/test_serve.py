"""A folder of tiles over HTTP: the right headers, nothing beside it, the loopback alone."""

from __future__ import annotations

import gzip
import socket
import threading
import urllib.error
import urllib.request
from contextlib import contextmanager

import pytest

import terrain_lod as tl
from support.tilesets import jacksboro
from terrain_lod.tilesets.serve import HOST, Site, server_of


@contextmanager
def served(site):
    server = server_of(site)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://{HOST}:{server.server_address[1]}"
    finally:
        server.shutdown()
        server.server_close()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("served") / "tiles"
    tl.write_tiles(jacksboro(), folder, format="3dtiles", error=40.0, zoom=0, gzip=True)
    (folder.parent / "secret.txt").write_text("secret")
    return folder


def test_headers_say_what_a_file_is_and_that_it_is_packed(folder):
    with served(Site.of(folder)) as address:
        with urllib.request.urlopen(f"{address}/tiles/0/0/0.glb?v=1") as answer:
            assert answer.headers["Content-Type"] == "model/gltf-binary"
            assert answer.headers["Content-Encoding"] == "gzip"
            assert answer.headers["Access-Control-Allow-Origin"] == "*"
            assert gzip.decompress(answer.read()).startswith(b"glTF")
        with urllib.request.urlopen(f"{address}/tiles/tiles.jsonl") as answer:
            assert answer.headers["Content-Encoding"] is None
        with urllib.request.urlopen(address) as answer:
            assert b"node_modules/cesium" in answer.read()


@pytest.mark.parametrize(
    "path", ["/tiles/../secret.txt", "/tiles/%2e%2e/secret.txt", "/tiles/", "/tiles/none", "/else"]
)
def test_nothing_else_is_served(folder, path):
    with served(Site.of(folder)) as address:
        request = urllib.request.Request(address)
        request.selector = path
        with pytest.raises(urllib.error.HTTPError, match="404"):
            urllib.request.urlopen(request)


def test_what_cannot_be_served_is_said(folder, tmp_path):
    with pytest.raises(tl.FileError, match="a folder of tiles, got none"):
        Site.of(tmp_path / "none")
    with pytest.raises(tl.InputError, match=r"with one of layer\.json, tileset\.json"):
        Site.of(tmp_path)
    with pytest.raises(tl.FileError, match="npm install cesium"):
        Site.of(folder, tmp_path)
    with socket.create_server((HOST, 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(tl.InputError, match="a port that is free"):
            server_of(Site.of(folder), port)
