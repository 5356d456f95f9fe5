"""Trials one after another, in a process that may die of them; see ``runner.py``.

::

    python -m fuzz.child KIND SEED FIRST END FOLDER

Writes a line of JSON for every input: its number, and what came of it.
"""

from __future__ import annotations

import contextlib
import json
import logging
import os
import random
import shutil
import signal
import sys
import warnings
from pathlib import Path
from typing import Final, TextIO

from fuzz.kind import Kind, Trial, Wrong
from fuzz.kinds import KINDS
from terrain_lod.errors import TerrainError

GOOD: Final = "good"
DOCUMENTED: Final = "documented error"

# of address space, and of memory in use, that no small input needs
_BYTES_TO_RESERVE: Final = 4 << 30
_BYTES_TO_USE: Final = 1 << 30
# of a clock, for each of a processor: others work here, too
_PATIENCE: Final = 6


def main(name: str, seed: int, first: int, end: int, folder: Path) -> None:
    kind = KINDS[name]
    answers, said = _own_streams(folder)
    _limit_address_space()
    logging.getLogger("terrain_lod").setLevel(logging.CRITICAL)  # what it says of files is meant
    for number in range(first, end):
        found = _tried(kind, dice(name, seed, number), folder / str(number), said)
        print(json.dumps([number, found]), file=answers, flush=True)


def dice(name: str, seed: int, number: int) -> random.Random:
    """Return the dice of one input, whatever came before it."""
    return random.Random(f"{name} {seed} {number}")


def _tried(kind: Kind, chance: random.Random, folder: Path, said: Path) -> str:
    """Return what came of one input; its folder stays where that is wrong."""
    folder.mkdir()
    heard = said.stat().st_size
    _forget_peak()
    before = _peak()
    # whichever comes first ends this process
    signal.setitimer(signal.ITIMER_PROF, kind.seconds)
    signal.alarm(_PATIENCE * kind.seconds)
    found = outcome(kind.trial, chance, folder)
    signal.setitimer(signal.ITIMER_PROF, 0)
    signal.alarm(0)
    taken = _peak() - before
    if found in (GOOD, DOCUMENTED):
        words = said.read_text(errors="replace")[heard:].strip()
        if words:
            return f"printed {words[:200]!r}"
        if taken > _BYTES_TO_USE:
            return f"took {taken / 1e9:.1f} GB"
        shutil.rmtree(folder)
    return found


def outcome(trial: Trial, chance: random.Random, folder: Path) -> str:
    """Return GOOD, DOCUMENTED or what is wrong."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            # what is said to users is said to the caller; libraries are to be silent
            warnings.filterwarnings("ignore", category=UserWarning, module="fuzz")
            trial(chance, folder)
    except TerrainError as error:
        message = str(error)
        return DOCUMENTED if message and "\n" not in message else f"a message of lines: {error!r}"
    except Wrong as wrong:
        return str(wrong)
    except Exception as error:
        return f"{type(error).__name__}: {error}"[:400]
    return GOOD


def _own_streams(folder: Path) -> tuple[TextIO, Path]:
    """Keep stdout for the answers; return it, and the file that anything else is printed to."""
    answers = os.fdopen(os.dup(1), "w")
    said = folder / "said"
    with said.open("ab") as file:
        os.dup2(file.fileno(), 1)
        os.dup2(file.fileno(), 2)
    return answers, said


def _limit_address_space() -> None:
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        pages = int(Path("/proc/self/statm").read_text().split()[0])
        limit = pages * resource.getpagesize() + _BYTES_TO_RESERVE
        resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


def _forget_peak() -> None:
    with contextlib.suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5")


def _peak() -> int:
    """Return the most bytes in use so far, 0 where nobody knows."""
    with contextlib.suppress(OSError):
        for line in Path("/proc/self/status").read_text().splitlines():
            if line.startswith("VmHWM"):
                return int(line.split()[1]) * 1024
    return 0


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:5]), Path(sys.argv[5]))
