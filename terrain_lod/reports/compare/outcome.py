"""What a comparison found, and the files that say so."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from .trials import Course, Result


@dataclass(frozen=True, eq=False)
class SweepReport:
    """What a comparison found and wrote.

    Attributes
    ----------
    course : Course
        Ground and cameras.
    sweep, tiles, partitionings : list of Result
        Every contender at one tile size; the promises at every tile size; distance LOD in every
        partitioning.
    findings, speeds : list of str
        Sentences: those that hold for every run, and those about time.
    missing : list of str
        Peers that are not installed.
    files : dict of str to Path
        ``html``, ``json``, ``csv``, ``times``, the plots, and pictures where this machine draws.
    """

    course: Course
    sweep: list[Result]
    tiles: list[Result]
    partitionings: list[Result]
    findings: list[str]
    speeds: list[str]
    missing: list[str]
    files: dict[str, Path]

    @property
    def results(self) -> list[Result]:
        return [*self.sweep, *self.tiles, *self.partitionings]
