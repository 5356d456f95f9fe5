"""Chromium without a window and with software GL, which asks this machine alone."""

from __future__ import annotations

import base64
import io
import json
import os
import shutil
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service

from terrain_lod.tilesets.serve import HOST, Site, server_of

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--window-size=900,600",
    "--force-device-scale-factor=1",
    "--hide-scrollbars",
    "--disable-background-networking",
    f"--host-resolver-rules=MAP * ~NOTFOUND , EXCLUDE {HOST}",
)


def library(name: str) -> Path:
    """Return npm's copy of a library, or skip the test and say what is missing."""
    folder = Path(os.environ.get("NODE_PATH", "")) / name
    npm = f"NODE_PATH with {name} (npm install {name})"
    wanted = {"chromium": shutil.which("chromium"), "chromedriver": shutil.which("chromedriver"),
              npm: folder.is_dir() and "there"}  # fmt: skip
    missing = [what for what, found in wanted.items() if not found]
    if missing:
        pytest.skip(f"real clients need {', '.join(missing)}")
    return folder


@dataclass
class Page:
    """A page of ``terrain-lod serve``, opened."""

    driver: webdriver.Chrome
    address: str

    def ask(self, script: str, *arguments: Any) -> Any:
        """Run an async function's body and return what it returns."""
        done = self.driver.execute_async_script(
            "const [given, done] = [[...arguments].slice(0, -1), arguments[arguments.length - 1]];"
            f"(async (...given) => {{ {script} }})(...given)"
            ".then(value => done({ value }), error => done({ error: String(error.stack) }))",
            *arguments,
        )
        assert "error" not in done, done["error"]
        return done.get("value")

    def wait(self, condition: str, seconds: float = 120.0) -> None:
        end = time.monotonic() + seconds
        while not self.driver.execute_script(f"return {condition}"):
            assert time.monotonic() < end, f"{condition} did not come true; {self.complaints()}"
            time.sleep(0.2)

    def settle(self, loaded: str, looks: int = 8) -> None:
        """Wait until something has been true at so many looks in a row, 0.2 s apart."""
        end, row = time.monotonic() + 120, 0
        while row < looks:
            assert time.monotonic() < end, f"{loaded} did not last; {self.complaints()}"
            time.sleep(0.2)
            row = row + 1 if self.driver.execute_script(f"return {loaded}") else 0

    def picture(self, script: str) -> np.ndarray:
        """Return the picture, (rows, columns, 3), that a script's data URL holds."""
        data = self.ask(script).split(",")[1]
        return np.asarray(Image.open(io.BytesIO(base64.b64decode(data))).convert("RGB"))

    def complaints(self) -> list[str]:
        """Return what the console says is wrong."""
        return [line["message"] for line in self.driver.get_log("browser")
                if line["level"] == "SEVERE"]  # fmt: skip

    def elsewhere(self) -> list[str]:
        """Return what was asked of others than our server."""
        asked = set()
        for line in self.driver.get_log("performance"):
            message = json.loads(line["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                asked.add(message["params"]["request"]["url"])
        own = (self.address, "data:", "blob:", "chrome:", "about:")
        return [url for url in asked if not url.startswith(own)]


@contextmanager
def chromium() -> Iterator[webdriver.Chrome]:
    """Start Chromium, and end it."""
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    for flag in FLAGS:
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(options, Service(shutil.which("chromedriver")))
    try:
        driver.set_script_timeout(180)
        yield driver
    finally:
        driver.quit()


@contextmanager
def opened(site: Site) -> Iterator[Page]:
    """Serve a site and open it in Chromium."""
    server = server_of(site)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        with chromium() as driver:
            address = f"http://{HOST}:{server.server_address[1]}/"
            driver.get(address)
            yield Page(driver, address)
    finally:
        server.shutdown()
        server.server_close()
