"""The viewer as a page, in a real browser without a screen."""

from __future__ import annotations

import json
import shutil
import socket
import sys
import time
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from io import BytesIO
from pathlib import Path
from threading import Thread

import numpy as np
import pytest
from PIL import Image

from support.viewer_page import served, until
from terrain_lod.cli.app import REFUSED, run
from terrain_lod.drawing.graphics import graphics_problem

POT = Path(__file__).parents[2] / "examples" / "data" / "pot.bpt"
CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
DRIVER = shutil.which("chromedriver")
MISSING = graphics_problem() or (
    None
    if CHROMIUM and DRIVER
    else "no Chromium with its driver: mend it with  apt-get install chromium chromium-driver"
)


@pytest.fixture(params=["volcano"])
def address(request):
    pytest.importorskip("trame_pyvista", reason="no web page tested: trame-pyvista is missing")
    with served(request.param) as page:
        yield page.address


@pytest.fixture
def browser(tmp_path):
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in (
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-dev-shm-usage",
        "--window-size=1100,760",
        f"--user-data-dir={tmp_path}",
        "--host-resolver-rules=MAP evil.example 127.0.0.1",
    ):
        options.add_argument(argument)
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    yield driver
    driver.quit()


@pytest.mark.slow
@pytest.mark.skipif(MISSING is not None, reason=f"no web page tested: {MISSING}")
def test_page_loads_slider_moves_triangles_change_and_terrain_is_seen(address, browser):
    from selenium.webdriver import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys

    browser.get(address)

    def count():
        texts = [found.text for found in browser.find_elements(By.ID, "triangle-count")]
        return int(texts[0].split()[0].replace(",", "")) if texts and texts[0] else 0

    def settled():
        before = count()
        time.sleep(1.0)
        return before and before == count() and before

    # the page begins with a view of no size to speak of
    first = until(lambda: count() > 20_000 and settled())
    assert browser.title == "terrain-lod"
    assert "pixels: 1" in browser.find_element(By.TAG_NAME, "body").text

    view = until(lambda: browser.find_elements(By.CSS_SELECTOR, ".v-main img"))[0]
    seen = np.asarray(Image.open(BytesIO(view.screenshot_as_png)).convert("RGB")).astype(int)
    sky, ground = seen[5], seen[-40:]
    assert sky[:, 2].mean() > sky[:, 0].mean() + 30  # blue above
    assert ground.std(axis=(0, 1)).min() > 5  # and below it no blank canvas
    assert (ground[..., 1] > ground[..., 2] + 10).mean() > 0.5  # green and brown

    # the hand on the slider wins: the page does not set it back
    thumb = browser.find_element(By.CSS_SELECTOR, ".v-slider-thumb")
    thumb.click()
    thumb.send_keys(Keys.ARROW_RIGHT * 100)
    second = until(lambda: count() < 0.7 * first and settled())
    text = browser.find_element(By.TAG_NAME, "body").text
    assert "pixels: 1\n" not in text
    assert f"{second:,} triangles" in text

    # a drag in the picture turns the camera
    ActionChains(browser).move_to_element(view).click_and_hold().move_by_offset(
        120, 30
    ).release().perform()
    until(lambda: settled() not in (False, 0, second))


# tries what a page may
FOREIGN = """<title>trying</title><script>
const viewer = "127.0.0.1:PORT", said = {};
const tried = [
  new Promise(done => { const socket = new WebSocket("ws://" + viewer + "/ws");
    socket.onopen = () => done(said.socket = "in");
    socket.onerror = () => done(said.socket = "out"); }),
  fetch("http://" + viewer + "/", {credentials: "include"})
    .then(answer => answer.text()).then(text => said.fetch = text, () => said.fetch = "out")];
Promise.all(tried).then(() => document.title = JSON.stringify(said));
</script>"""


@contextmanager
def foreign_page(viewer_port):
    """Serve a page that tries to get into the viewer; yield its port."""

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(FOREIGN.replace("PORT", str(viewer_port)).encode())

        def log_message(self, *_):
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield server.server_address[1]
        server.shutdown()


@pytest.mark.slow
@pytest.mark.skipif(MISSING is not None, reason=f"no web page tested: {MISSING}")
def test_another_page_of_the_same_browser_stays_out(address, browser):
    from selenium.webdriver.common.by import By

    def shown():
        return browser.find_elements(By.ID, "triangle-count")

    browser.get(address)
    until(shown)
    root, token = address.split("?token=")
    assert token not in browser.current_url
    browser.refresh()  # by its cookie
    until(shown)
    browser.get(address)
    until(shown)
    port = int(root.split(":")[2].strip("/"))
    with foreign_page(port) as elsewhere:
        for name in ("127.0.0.1", "evil.example"):
            browser.get(f"http://{name}:{elsewhere}/")
            said = json.loads(until(lambda: browser.title.startswith("{") and browser.title))
            assert said == {"socket": "out", "fetch": "out"}
    # a foreign name that was made to point here
    browser.get(f"http://evil.example:{port}/?token={token}")
    assert "name of the machine" in browser.find_element(By.TAG_NAME, "body").text
    browser.get(address)
    until(shown)


@pytest.mark.slow
@pytest.mark.skipif(MISSING is not None, reason=f"no web page tested: {MISSING}")
@pytest.mark.parametrize("address", [str(POT)], indirect=True)
def test_patches_have_the_same_page_with_their_own_controls(address, browser):
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys

    def count():
        texts = [found.text for found in browser.find_elements(By.ID, "triangle-count")]
        return int(texts[0].split()[0].replace(",", "")) if texts and texts[0] else 0

    browser.get(address)
    assert until(count) == 24 * 50  # factor 5
    shown = browser.find_element(By.TAG_NAME, "body").text
    assert "factor: 5" in shown
    assert "level of detail" not in shown
    assert "largest error" not in shown
    view = until(lambda: browser.find_elements(By.CSS_SELECTOR, ".v-main img"))[0]
    seen = np.asarray(Image.open(BytesIO(view.screenshot_as_png)).convert("RGB")).astype(int)
    middle = seen[seen.shape[0] // 2, seen.shape[1] // 2]
    assert middle[0] > middle[2]  # clay before a blue sky
    assert seen[5, :, 2].mean() > seen[5, :, 0].mean() + 30
    thumb = browser.find_element(By.CSS_SELECTOR, ".v-slider-thumb")
    thumb.click()
    thumb.send_keys(Keys.ARROW_RIGHT * 50)
    until(lambda: count() > 24 * 60)


def test_port_that_is_taken_is_one_line(capsys):
    pytest.importorskip("trame_pyvista", reason="no web page tested: trame-pyvista is missing")
    with socket.socket() as holder:
        holder.bind(("127.0.0.1", 0))
        holder.listen()
        port = holder.getsockname()[1]
        assert run(["view", "volcano", "--web", "--port", str(port)]) == REFUSED
    error = capsys.readouterr().err.splitlines()
    assert f"cannot listen on 127.0.0.1, port {port}" in error[-1]
    assert "choose another with --port" in error[-1]


def test_missing_extra_names_itself(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "trame_pyvista", None)
    assert run(["view", "volcano", "--web"]) == REFUSED
    assert "install 'terrain_lod[web]'" in capsys.readouterr().err
