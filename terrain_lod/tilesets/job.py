"""One folder of tiles to write: what is the same for all of its tiles."""

from __future__ import annotations

import gzip
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..paths import replacing, require_made
from .levels import Level
from .schemes import Scheme, tiles_over
from .source import Source


@dataclass(frozen=True, eq=False)
class Job:
    """What a tile is made from.

    Attributes
    ----------
    source : Source
    scheme : Scheme
    levels : dict of int to Level
        From the first level that there is to the deepest.
    folder : Path
    gzipped : bool
    skirts : bool
        Whether meshes end in walls that hide what is between two levels.
    frozen : bool
        Whether all levels have the borders of the deepest.
    implicit : bool
        Whether 3D Tiles are named by a rule instead of one by one.
    picture : bool
        Whether tiles are pictures.
    encoding : str
        How heights are packed in their colours.
    about : dict
        What is said of all tiles together: where they come from and what their heights are.
    """

    source: Source
    scheme: Scheme
    levels: dict[int, Level]
    folder: Path
    gzipped: bool
    skirts: bool = False
    frozen: bool = False
    implicit: bool = True
    picture: bool = False
    encoding: str = ""
    about: dict[str, Any] = field(default_factory=dict)

    @property
    def deepest(self) -> int:
        return max(self.levels)

    def tiles(self, z: int) -> tuple[range, range]:
        """Return columns and rows of the tiles of a level."""
        columns, rows = tiles_over(self.scheme, z, self.source.bounds)
        # a client begins with all that there are
        return (range(self.scheme.roots), rows) if z == 0 else (columns, rows)

    def skirt(self, z: int) -> float:
        """Return the height of the walls around tiles of a level, metres.

        At any place of a border, two levels are no farther apart than both errors together: of
        the levels beside this one, the coarser is the farther. The coarsest has its own twice.
        """
        return self.levels[z].asked + self.levels.get(z - 1, self.levels[z]).asked

    def write(self, path: str, content: bytes) -> int:
        """Write a file, whole or not at all, and return its size."""
        final = self.folder / path
        require_made(final.parent)
        if self.gzipped:
            # no time in it: the same tile is the same file
            content = gzip.compress(content, 6, mtime=0)
        with replacing(final) as temporary:
            temporary.write_bytes(content)
        return len(content)
