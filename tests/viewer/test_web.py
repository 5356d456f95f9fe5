"""The viewer as a page, in a real browser without a screen."""

from __future__ import annotations

import shutil
import socket
import subprocess
import sys
import time
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

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


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def until(condition, seconds=60.0):
    """Wait for something, and return it."""
    end = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < end, "nothing came of it in time"
        time.sleep(0.2)
    return found


@pytest.fixture(params=["volcano"])
def address(request):
    pytest.importorskip("trame_pyvista", reason="no web page tested: trame-pyvista is missing")
    port = free_port()
    command = [sys.executable, "-m", "terrain_lod", "view", request.param, "--web"]
    with subprocess.Popen(
        [*command, "--port", str(port)], stderr=subprocess.PIPE, text=True
    ) as server:
        try:
            until(lambda: server.poll() is not None or listens(port))
            yield f"http://127.0.0.1:{port}/"
        finally:
            server.terminate()
            said = server.communicate(timeout=60)[1]
    assert "Traceback" not in said, said


def listens(port):
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


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
    ):
        options.add_argument(argument)
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(DRIVER))
    yield driver
    driver.quit()


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
