"""Chunks meshed and joined until what is asked holds.

::

    cut ─▶ a mesh of each chunk ─▶ joined ─▶ measured ─▶ Joined
     ▲          ▲                                │
     └─ finer ──┴── asked for less ◀── exceeds ◀─┘
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np

from ..mesh.mesh import Mesh
from ..terrain.lod import PromiseLod
from ..terrain.lod_promises import MaxErrorLod, ScreenErrorLod
from .cut import Cut, Place
from .join import join
from .piece import Piece
from .view import Asked
from .window import Window

# of what is asked, so much is asked of a chunk alone at first: joints, and of coarse levels the
# samples that they leave out, take the rest
_FIRST_SHARE: Final = 0.7
_FINEST_SHARE: Final = 0.95
# what exceeds is asked for less, by so much more than it exceeds
_LESS: Final = 0.97
# a chunk that would be asked for less than this is split
_LEAST_SHARE: Final = 0.25
_MOST_ROUNDS: Final = 12


@dataclass(frozen=True, eq=False)
class Joined:
    """Chunks of a cut that meet without a crack.

    Attributes
    ----------
    cut : Cut
    pieces : list of Piece
        Joined, one for each place of the cut.
    meshes : list of Mesh
        What they were made of.
    rounds : int
        How often it was tried.
    """

    cut: Cut
    pieces: list[Piece]
    meshes: list[Mesh]
    rounds: int

    @property
    def metres(self) -> float:
        """The largest error."""
        return max((float(piece.errors.max(initial=0.0)) for piece in self.pieces), default=0.0)

    @property
    def used(self) -> float:
        """The largest error of a patch as a part of what it is allowed."""
        return max(map(_used, self.pieces), default=0.0)


def keep(
    asked: Asked,
    cut_with: Callable[[frozenset[Place]], Cut],
    window: Callable[[Place], Window],
) -> Joined:
    """Cut, mesh and join until what is asked holds, or nothing more can be done.

    Parameters
    ----------
    asked : Asked
    cut_with : callable
        Returns the cut with these chunks split.
    window : callable
        Returns a chunk.
    """
    shares: dict[Place, float] = {}
    made: dict[tuple[Place, float], tuple[Piece, Mesh]] = {}
    finer: frozenset[Place] = frozenset()
    for rounds in range(1, _MOST_ROUNDS + 1):  # noqa: B007
        cut = cut_with(finer)
        for place in cut.places:
            shares.setdefault(place, _FIRST_SHARE if place[0] else _FINEST_SHARE)
        wanted = [(place, shares[place]) for place in cut.places]
        made = {
            (place, share): made.get((place, share))
            or window(place).piece(asked, _part_of(asked, share))
            for place, share in wanted
        }
        meshes = [made[key][1] for key in wanted]
        pieces = [
            window(place).measured(piece, mesh)
            for place, piece, mesh in zip(
                cut.places, join([made[key][0] for key in wanted]), meshes, strict=True
            )
        ]
        before, split = dict(shares), set(finer)
        for place, used in zip(cut.places, map(_used, pieces), strict=True):
            if used <= 1.0:
                continue
            less = shares[place] * _LESS / min(used, 2.0)
            if less >= _LEAST_SHARE:
                shares[place] = less
            elif place[0] > 0 and cut.is_enough:
                split.add(place)
        if before == shares and split == set(finer):
            break
        finer = frozenset(split)
    return Joined(cut, pieces, meshes, rounds)


def _part_of(asked: Asked, share: float) -> PromiseLod:
    """Return a part of the error that is asked for, as a level of detail."""
    if asked.camera is not None and not np.isinf(asked.pixels):
        return ScreenErrorLod(pixels=asked.pixels * share)
    return MaxErrorLod(metres=asked.metres * share)


def _used(piece: Piece) -> float:
    """Return the largest error of a patch as a part of what it is allowed."""
    with np.errstate(divide="ignore", invalid="ignore"):
        used = np.where(piece.errors > 0, piece.errors / piece.allowed, 0.0)
    return float(used.max(initial=0.0))
