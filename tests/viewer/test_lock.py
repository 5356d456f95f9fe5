"""Who gets into the page: foreign pages, rebound names and garbage against the real server."""

from __future__ import annotations

import asyncio
import contextlib
import random
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from support.viewer_page import served

pytest.importorskip("trame_pyvista", reason="no lock tested: trame-pyvista is missing")

import aiohttp
import msgpack

from terrain_lod.viewer.lock import Lock, is_loopback

FOREIGN = ("http://evil.example", "https://evil.example:8080", "null", "http://127.0.0.1:1")
HELLO = "wslink.hello"


@pytest.fixture(scope="module")
def page():
    with served("volcano") as page:
        yield page


def packed(message, claim=None, start=0):
    """Return a message in wslink's frame: a number, where it begins, its size, itself."""
    body = msgpack.packb(message)
    size = len(body) if claim is None else claim
    return random.randbytes(4) + start.to_bytes(4, "little") + size.to_bytes(4, "little") + body


async def call(ws, method, *arguments):
    """Return what the server answers to a call: its result, or (code, message) of an error."""
    name = "system:c0:0" if method == HELLO else f"rpc:c0:{random.randrange(10**9)}"
    await ws.send_bytes(packed({"id": name, "method": method, "args": [*arguments]}))
    while True:
        got = await ws.receive(timeout=20)
        if got.type is not aiohttp.WSMsgType.BINARY:
            raise ConnectionError(got)
        answer = msgpack.unpackb(got.data[12:], strict_map_key=False)
        if answer["id"] == name:
            error = answer.get("error")
            return answer.get("result") if error is None else (error["code"], error["message"])


@asynccontextmanager
async def own_page(page):
    """Open what our own page does: the printed address, then the socket with its cookie."""
    jar = aiohttp.CookieJar(unsafe=True)  # of an address in numbers
    async with aiohttp.ClientSession(f"http://127.0.0.1:{page.port}", cookie_jar=jar) as session:
        async with session.get(page.address) as answer:
            assert answer.status == 200
        origin = {"Origin": f"http://127.0.0.1:{page.port}"}
        async with session.ws_connect("/ws", headers=origin) as ws:
            assert "clientID" in await call(ws, HELLO, {"secret": page.token})
            yield ws


async def status(page, path, **headers):
    """Return the status that a request gets, as a handshake of a WebSocket where that is meant."""
    async with aiohttp.ClientSession(f"http://127.0.0.1:{page.port}") as session:
        if path.startswith("/ws"):
            try:
                async with session.ws_connect(path, headers=headers):
                    return 101
            except aiohttp.WSServerHandshakeError as error:
                return error.status
        async with session.get(path, headers=headers, allow_redirects=False) as answer:
            return answer.status


PATHS = ("/", "/index.html", "/vue.global.js", "/none", "/ws")


@pytest.mark.slow
@pytest.mark.parametrize("path", PATHS)
def test_nobody_gets_in_without_the_token_or_from_elsewhere(page, path):
    with_token = f"{path}?token={page.token}"
    name = f"terrain-lod-{page.port}"

    async def attempts():
        assert await status(page, path) == 403
        for wrong in ("x", "", page.token[:-1], "%FF%00", "ä"):
            assert await status(page, f"{path}?token={wrong}") == 403
        assert await status(page, path, Cookie=f"{name}=wslink-secret") == 403
        assert await status(page, path, Cookie=f"other={page.token}") == 403
        # the token does not help a page of elsewhere, nor a name that was made to point here
        for origin in FOREIGN:
            assert await status(page, with_token, Origin=origin) == 403
        for host in (
            "evil.example",
            f"evil.example:{page.port}",
            "127.0.0.1.evil.example",
            "::",
            "",
        ):
            own = {"Host": host, "Origin": f"http://{host}"}
            assert await status(page, with_token, **own) in (400, 403)
            cookie = f"terrain-lod-{page.port}={page.token}; terrain-lod-80={page.token}"
            assert await status(page, path, Cookie=cookie, **own) in (400, 403)
        # nobody was turned away for nothing
        got = await status(page, with_token, Origin=f"http://127.0.0.1:{page.port}")
        assert got == {"/ws": 101, "/none": 404, "/vue.global.js": 200}.get(path, 302)
        tunnel = {"Host": "localhost:9999", "Origin": "http://localhost:9999"}
        assert await status(page, with_token, **tunnel) == got

    asyncio.run(attempts())


def test_own_page_gets_in_and_reloads_by_its_cookie(page):
    async def visit():
        jar = aiohttp.CookieJar(unsafe=True)
        root = f"http://127.0.0.1:{page.port}/"
        async with aiohttp.ClientSession(root, cookie_jar=jar) as session:
            async with session.get(page.address) as answer:
                assert str(answer.url) == f"{root}index.html?secret={page.token}"
                assert "frame-ancestors 'none'" in answer.headers["Content-Security-Policy"]
            (cookie,) = jar
            assert cookie.value == page.token
            assert (cookie["httponly"], cookie["samesite"]) == (True, "Strict")
            # a link that tells trame's page of another server does not reach it
            for path in ("", "index.html", "index.html?sessionURL=ws://evil.example/"):
                async with session.get(path) as answer:
                    assert str(answer.url) == f"{root}index.html?secret={page.token}"
            async with session.ws_connect("ws") as ws:
                assert (await call(ws, "trame.state.get"))[0] == -32000
                assert (await call(ws, HELLO, {"secret": "wslink-secret"}))[0] == -32000
                assert "clientID" in await call(ws, HELLO, {"secret": page.token})

    asyncio.run(visit())


def test_a_page_that_is_in_sets_settings_and_nothing_else(page):
    async def state_of_the_next():
        async with own_page(page) as ws:
            return (await call(ws, "trame.state.get"))["state"]

    async def attempts():
        before = await state_of_the_next()
        evil = "http://evil.example/x.js"
        wrong = {
            **{f"trame__{key}": [evil] for key in ("scripts", "module_scripts", "styles")},
            "trame__vue_use": [evil],
            "trame__template_main": f"<script src='{evil}'></script>",
            "trame__title": evil,
            "readout": [evil],
            "pixels_said": evil,
            "mode": evil,
            "tessellated": [evil],
            "pixels": evil,
            "tile": float("nan"),
            "new": evil,
        }
        async with own_page(page) as ws:
            changes = [{"key": key, "value": value} for key, value in wrong.items()]
            await call(ws, "trame.state.update", changes)
            await call(ws, "trame.state.update", [{"key": "horizon", "value": 2.0}])
            await call(ws, "trame.state.update", [{"key": "metres", "value": 1e308}])
            await call(ws, "trame.lifecycle.update", "server_ready")
            for method in ("application.exit", "application.exit.later", "trame.force.push"):
                assert (await call(ws, method))[0] == -32601
            # the page's buttons press no keys but their own: c would write a file
            for arguments in (["c"], {}), ([], {"key": "c"}):
                await call(ws, "trame.trigger", "trigger__1", *arguments)
            assert await call(ws, "viewport.image.push", 7) == (-32001, "Exception raised")
        after = await state_of_the_next()
        assert "wrote" not in str(after["note"])
        assert after["horizon"] == 2.0
        assert evil not in str(after)
        for key in wrong:
            assert after.get(key) == before.get(key), key

    asyncio.run(attempts())
    assert page.process.poll() is None
    assert page.said.read_text().count("http://") == 1  # it began once


def garbage(seed):
    """Return frames that no page sends: bytes, claimed sizes, messages of other kinds."""
    rng = random.Random(seed)
    odd = (None, 7, [], "text", {}, {"id": 7}, {"id": "rpc", "method": []}, [[[]]])
    yield from (rng.randbytes(rng.randrange(64)) for _ in range(150))
    yield from (packed(rng.choice(odd)) for _ in range(50))
    yield from (packed({"id": "rpc:c0:1"}, claim=rng.randrange(2**32)) for _ in range(50))
    yield from (packed({"id": "rpc:c0:1"}, start=rng.randrange(1, 2**32)) for _ in range(25))
    for _ in range(25):
        method = rng.choice(("trame.state.update", "viewport.image.push", "trame.trigger", HELLO))
        yield packed({"id": "rpc:c0:1", "method": method, "args": [rng.choice(odd)]})


def memory(page):
    """Return the bytes that the server has had at most."""
    lines = Path(f"/proc/{page.process.pid}/status").read_text().splitlines()
    return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="no /proc: memory is not read")
def test_garbage_and_aborted_clients_leave_the_server_serving(page):
    before = memory(page)

    async def misbehave(frames):
        """Send garbage as a page that is in, again and again as it is sent away."""
        while frames:
            async with own_page(page) as ws:
                while frames and not ws.closed:
                    await ws.send_bytes(frames.pop())
                    with contextlib.suppress(asyncio.TimeoutError):
                        await ws.receive(timeout=0.02)
        return True

    async def abort():
        async with own_page(page) as ws:
            await call(ws, "viewport.image.push.observer.add", "1")
            ws._response.connection.transport.abort()

    async def noise(bytes_):
        """Send what is no HTTP."""
        reader, writer = await asyncio.open_connection("127.0.0.1", page.port)
        writer.write(bytes_)
        await asyncio.wait_for(reader.read(), 20)
        writer.close()

    async def storm():
        frames = [*garbage(1)]
        assert len(frames) == 300
        foreign = [status(page, f"/ws?token={page.token}", Origin=origin) for origin in FOREIGN]
        clients = [misbehave(frames[number::10]) for number in range(10)]
        aborted = [abort() for _ in range(5)]
        noises = [noise(bytes_) for bytes_ in (bytes(99), b"GET /\r\n\r\n", b"\x16\x03\x01\n\n")]
        refused, *_ = await asyncio.gather(
            *(asyncio.gather(*group) for group in (foreign, clients, aborted, noises))
        )
        assert refused == [403] * 4
        async with own_page(page) as ws:
            await ws.send_str("text")
            assert (await ws.receive(timeout=20)).type in (
                aiohttp.WSMsgType.CLOSE,
                aiohttp.WSMsgType.CLOSED,
            )
        async with own_page(page) as ws:
            assert (await call(ws, "trame.state.get"))["state"]["trame__title"] == "terrain-lod"

    asyncio.run(storm())
    assert page.process.poll() is None
    assert memory(page) < before + 2**28


@pytest.mark.slow
def test_other_machines_need_the_token_and_are_said_to_reach_the_page():
    with served("volcano", "--host", "0.0.0.0") as page:
        said = page.said.read_text()
        assert "Other machines reach this page" in said
        assert page.token
        port, query = page.port, f"token={page.token}"

        async def attempts():
            for host in (f"127.0.0.1:{port}", f"192.0.2.7:{port}", f"[2001:db8::1]:{port}"):
                assert await status(page, "/", Host=host) == 403
                assert await status(page, f"/?{query}", Host=host) == 302
                assert await status(page, f"/?{query}", Host=host, Origin=FOREIGN[0]) == 403
            assert await status(page, f"/?{query}", Host="evil.example") == 403

        asyncio.run(attempts())


@pytest.mark.slow
@pytest.mark.parametrize(
    ("host", "loopback"),
    [
        ("127.0.0.1", True),
        ("127.8.8.8", True),
        ("localhost", True),
        ("::1", True),
        ("0.0.0.0", False),
        ("::", False),
        ("192.0.2.7", False),
        ("host.example", False),
    ],
)
def test_which_addresses_are_of_this_machine_alone(host, loopback):
    assert is_loopback(host) == loopback
    one, other = Lock(host), Lock(host)
    assert one.token != other.token
    assert len(one.token) >= 32
    if loopback:
        assert "Other" not in one.address(8080)
