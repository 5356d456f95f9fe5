"""The viewer as a page, served by a process of its own."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from urllib.parse import urlsplit


def until(condition: Callable[[], Any], seconds: float = 60.0) -> Any:
    """Wait for something, and return it."""
    end = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < end, "nothing came of it in time"
        time.sleep(0.1)
    return found


@dataclass
class Served:
    """A page that is served.

    Attributes
    ----------
    process : subprocess.Popen
    address : str
        As printed, token included.
    said : Path
        What it wrote to stderr.
    """

    process: subprocess.Popen[bytes]
    address: str
    said: Path

    @property
    def port(self) -> int:
        return urlsplit(self.address).port or 0

    @property
    def token(self) -> str:
        return self.address.partition("token=")[2]


@contextmanager
def served(*arguments: str) -> Iterator[Served]:
    """Serve a page at any free port; nothing may be said of it that looks like a fault."""
    command = [sys.executable, "-m", "terrain_lod", "view", *arguments, "--web", "--port", "0"]
    with TemporaryDirectory() as folder, (Path(folder) / "stderr").open("w") as stderr:
        said = Path(folder) / "stderr"
        with subprocess.Popen(command, stderr=stderr) as process:

            def address() -> str | None:
                assert process.poll() is None, said.read_text()
                words = said.read_text().split()
                return next((word for word in words if word.startswith("http://")), None)

            try:
                yield Served(process, until(address), said)
            finally:
                process.terminate()
                process.wait(60)
        text = said.read_text()
        assert "Traceback" not in text, text
        assert "rror" not in text, text
