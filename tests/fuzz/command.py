"""The command line of the long run, and its table."""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

from fuzz.kinds import KINDS
from fuzz.runner import Counts, run

_ROW = "{:24} {:>8} {:>8} {:>12} {:>8} {:>8}"


def main() -> None:
    """Try inputs of every kind; exits with 1 if one of them went wrong."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="of all dice (default: %(default)s)")
    parser.add_argument(
        "--inputs", type=int, default=10_000, help="of all kinds together (default: %(default)s)"
    )
    parser.add_argument(
        "--kind", action="append", choices=KINDS, help="these alone; may be given again"
    )
    parser.add_argument("--number", type=int, help="of one input of a run, to try it again")
    told = parser.parse_args()

    names = told.kind or list(KINDS)
    shares = sum(KINDS[name].share for name in names)
    folder = Path(tempfile.mkdtemp(prefix="terrain_lod-fuzz-"))
    print(_ROW.format("kind", "inputs", "good", "documented", "wrong", "seconds"), flush=True)
    total = Counts()
    for name in names:
        count = max(1, round(told.inputs * KINDS[name].share / shares))
        numbers = range(count) if told.number is None else range(told.number, told.number + 1)
        start = time.monotonic()
        counts = run(name, told.seed, numbers, folder / name.replace(" ", "_"))
        _print_row(name, counts, time.monotonic() - start)
        for number, found in counts.wrong.items():
            print(f"  {number}: {found}", flush=True)
        total.good += counts.good
        total.documented += counts.documented
        total.wrong |= {
            len(total.wrong) + i: found for i, found in enumerate(counts.wrong.values())
        }
    _print_row("all", total, 0)
    if total.wrong:
        print(f"the inputs that went wrong are in {folder}; --kind and --number try one again")
    sys.exit(bool(total.wrong))


def _print_row(name: str, counts: Counts, seconds: float) -> None:
    wrong = len(counts.wrong)
    inputs = counts.good + counts.documented + wrong
    row = name, inputs, counts.good, counts.documented, wrong, f"{seconds:.0f}"
    print(_ROW.format(*row), flush=True)
