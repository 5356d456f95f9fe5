"""What the command line says, and where: results on stdout, everything else on stderr."""

from __future__ import annotations

import logging
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any, Final

Progress = Callable[[int, int], None]
"""Takes the steps done and the steps in all."""

PROGRAM: Final = "terrain-lod"

_logger: Final = logging.getLogger("terrain_lod")


def set_verbosity(verbose: int, quiet: bool) -> None:
    """Log to stderr: warnings by default, more with each -v, errors alone with -q."""
    levels = (logging.WARNING, logging.INFO, logging.DEBUG)
    _logger.setLevel(logging.ERROR if quiet else levels[min(verbose, len(levels) - 1)])
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter(f"{PROGRAM}: %(message)s"))
    _logger.handlers = [handler]
    warnings.showwarning = _log_warning


def _log_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    warn(f"warning: {message}")


def log(message: str, *values: object) -> None:
    """Say what is being done, to those who asked with -v."""
    _logger.info(message, *values)


def say(text: str) -> None:
    """Print a line of the result, unless -q."""
    if _logger.isEnabledFor(logging.WARNING):
        print(text)


def warn(text: str) -> None:
    """Print a warning, unless -q."""
    _logger.warning("%s", text)


def complain(text: str) -> None:
    """Print an error as one line."""
    print(f"{PROGRAM}: {text}", file=sys.stderr)


def say_table(columns: Sequence[str], rows: Sequence[Sequence[str]], title: str = "") -> None:
    """Print a table of the result, unless -q; numbers stand to the right."""
    if not _logger.isEnabledFor(logging.WARNING):
        return
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table

    table = Table(box=SIMPLE_HEAD, title=title or None, title_justify="left", title_style="bold")
    for index, name in enumerate(columns):
        numeric = index > 0 and all(row[index][:1].isdigit() for row in rows if row[index])
        table.add_column(name, justify="right" if numeric else "left", overflow="fold")
    for row in rows:
        table.add_row(*row)
    # a pipe or a file takes lines of any length
    console = Console(width=None if sys.stdout.isatty() else 160, highlight=False, markup=False)
    console.print(table)


@contextmanager
def progress_bar(label: str) -> Iterator[Progress | None]:
    """Yield what long work reports to: a bar on stderr, or None where stderr is no terminal."""
    if not sys.stderr.isatty() or not _logger.isEnabledFor(logging.WARNING):
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress as Bar

    with Bar(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(label, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
