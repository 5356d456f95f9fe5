"""A kind of input: how one is made and tried."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

Trial = Callable[[random.Random, Path], None]


class Wrong(AssertionError):
    """A result that is not what it should be."""


@dataclass(frozen=True)
class Kind:
    """One row of the table.

    Attributes
    ----------
    trial : Callable
        Makes one input by dice, in an empty folder, and feeds it in.
    share : float
        How many of a run's inputs are of this kind, compared with the others.
    seconds : int
        Of a processor that one input may take.
    """

    trial: Trial
    share: float = 1.0
    seconds: int = 20


def require(held: bool, what: str) -> None:
    """Say what is wrong if something did not hold."""
    if not held:
        raise Wrong(what)
