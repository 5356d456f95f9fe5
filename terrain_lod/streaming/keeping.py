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

from .cut import Cut, Place
from .join import join
from .made import Made
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
    made : list of Made
        What they were before.
    rounds : int
        How often it was tried.
    """

    cut: Cut
    pieces: list[Piece]
    made: list[Made]
    rounds: int

    @property
    def metres(self) -> float:
        """The largest error."""
        return max((float(piece.errors.max(initial=0.0)) for piece in self.pieces), default=0.0)

    @property
    def used(self) -> float:
        """The largest error of a patch as a part of what it is allowed."""
        return max(map(_used, self.pieces), default=0.0)

    def seen(self, asked: Asked) -> dict[Place, Made]:
        """Return the chunks that do for another view as they are."""
        found = {
            place: made.seen(asked) for place, made in zip(self.cut.places, self.made, strict=True)
        }
        return {place: made for place, made in found.items() if made is not None}


def keep(
    asked: Asked,
    cut_with: Callable[[frozenset[Place]], Cut],
    window: Callable[[Place], Window],
    before: Joined | None,
) -> Joined:
    """Cut, mesh and join until what is asked holds, or nothing more can be done.

    Parameters
    ----------
    asked : Asked
    cut_with : callable
        Returns the cut with these chunks split.
    window : callable
        Returns a chunk.
    before : Joined or None
        The last view; what of it does for this one is not made again.
    """
    made = {} if before is None else before.seen(asked)
    shares = {place: known.share for place, known in made.items()}
    finer: frozenset[Place] = frozenset()
    for rounds in range(1, _MOST_ROUNDS + 1):  # noqa: B007
        cut = cut_with(finer)
        for place in cut.places:
            shares.setdefault(place, _FIRST_SHARE if place[0] else _FINEST_SHARE)
        for place in cut.places:
            if place not in made or made[place].share != shares[place]:
                made[place] = window(place).made(asked, shares[place])
        used = [made[place] for place in cut.places]
        pieces = [
            window(place).measured(piece, known.mesh)
            for place, piece, known in zip(
                cut.places, join([known.piece for known in used]), used, strict=True
            )
        ]
        shares_before, split = dict(shares), set(finer)
        for place, exceeds in zip(cut.places, map(_used, pieces), strict=True):
            if exceeds <= 1.0:
                continue
            less = shares[place] * _LESS / min(exceeds, 2.0)
            if less >= _LEAST_SHARE:
                shares[place] = less
            elif place[0] > 0 and cut.is_enough:
                split.add(place)
        if shares_before == shares and split == set(finer):
            break
        finer = frozenset(split)
    return Joined(cut, pieces, used, rounds)


def _used(piece: Piece) -> float:
    """Return the largest error of a patch as a part of what it is allowed."""
    with np.errstate(divide="ignore", invalid="ignore"):
        used = np.where(piece.errors > 0, piece.errors / piece.allowed, 0.0)
    return float(used.max(initial=0.0))
