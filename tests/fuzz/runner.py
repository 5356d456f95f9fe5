"""Children that try inputs, and what came of all of them."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from fuzz.child import DOCUMENTED, GOOD

_TESTS: Final = Path(__file__).parents[1]
# inputs of one child: what grows shows, and ends
_SLICE: Final = 500


@dataclass
class Counts:
    """What came of the inputs of one kind, and which of them went wrong."""

    good: int = 0
    documented: int = 0
    wrong: dict[int, str] = field(default_factory=dict)

    def add(self, number: int, found: str) -> None:
        self.good += found == GOOD
        self.documented += found == DOCUMENTED
        if found not in (GOOD, DOCUMENTED):
            self.wrong[number] = found


def run(name: str, seed: int, numbers: range, folder: Path) -> Counts:
    """Try inputs of a kind in children, and start the next where one dies."""
    counts = Counts()
    first = numbers.start
    while first < numbers.stop:
        end = min(first + _SLICE, numbers.stop)
        for number, found in _answers(name, seed, first, end, folder):
            counts.add(number, found)
            first = number + 1
    return counts


def _answers(name: str, seed: int, first: int, end: int, folder: Path) -> Iterator[tuple[int, str]]:
    """Yield the outcomes of one child, its own end among them if it came too early."""
    folder.mkdir(parents=True, exist_ok=True)
    child = subprocess.Popen(
        [sys.executable, "-m", "fuzz.child", name, *map(str, (seed, first, end)), str(folder)],
        cwd=_TESTS,
        stdout=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )
    assert child.stdout is not None
    number = first - 1
    try:
        for line in child.stdout:
            number, found = json.loads(line)
            yield number, found
        if child.wait() or number + 1 < end:
            yield number + 1, _end_of(child.returncode, folder / "said")
    finally:
        with suppress(ProcessLookupError):  # and what it started
            os.killpg(child.pid, signal.SIGKILL)
        child.wait()
        child.stdout.close()


def _end_of(code: int, said: Path) -> str:
    """Return how a child ended, and its last words."""
    how = f"ended by {signal.Signals(-code).name}" if code < 0 else f"ended with {code}"
    words = said.read_text(errors="replace").strip() if said.exists() else ""
    return f"{how} {words.splitlines()[-1][:200]!r}" if words else how
