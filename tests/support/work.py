"""Tasks that processes can be sent: they find them here, by name."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path


def square(number: int) -> int:
    return number * number


def square_or_die_once(task: tuple[Path, int]) -> int:
    """Return the square; the first process to see the third number dies as if it were killed."""
    folder, number = task
    if number == 3 and not (folder / "died").exists():
        (folder / "died").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def die(number: int) -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return number


def refuse(number: int) -> int:
    raise ValueError(f"not {number}")


def write_slowly(task: tuple[Path, int]) -> int:
    """Leave one file as it begins and another as it ends."""
    folder, number = task
    (folder / f"{number}.begun").touch()
    time.sleep(0.3)
    (folder / f"{number}.ended").touch()
    return number
