"""Ctrl-C while the program is still being imported: one line, as afterwards.

Python would print where in the imports it was. Imported first of all, and only for the program
itself: whoever imports the package keeps what signals mean to them.
"""

from __future__ import annotations

import os
import signal
import sys
from contextlib import suppress
from pathlib import Path
from typing import Final, NoReturn

INTERRUPTED: Final = 130  # exit code


def end() -> NoReturn:
    """End the process at once.

    OpenCL's and VTK's threads may still be at work; their libraries, closed under them as Python
    ends, now and then crash.
    """
    with suppress(OSError, ValueError):
        sys.stdout.flush()
    os._exit(INTERRUPTED)


def _end_imports(*_: object) -> NoReturn:
    os.write(2, b"terrain-lod: interrupted\n")
    end()


def raise_interrupts() -> None:
    """Let Ctrl-C be an exception again, so that what is half written is removed."""
    if signal.getsignal(signal.SIGINT) is _end_imports:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _is_the_program() -> bool:
    # "-m" until the package is imported
    by_module = sys.argv[:1] == ["-m"] and "terrain_lod" in sys.orig_argv
    return by_module or Path(*sys.argv[:1]).stem == "terrain-lod"


if _is_the_program() and signal.getsignal(signal.SIGINT) is signal.default_int_handler:
    signal.signal(signal.SIGINT, _end_imports)
