"""The mesh of one chunk, for this view and for the next ones."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from ..mesh.mesh import Mesh
from .piece import Piece
from .view import Asked, Boxes

# patches that might be coarser by more than this are made anew
_FINER: Final = 1.25


@dataclass(frozen=True, eq=False)
class Made:
    """What a chunk shows.

    Attributes
    ----------
    asked : Asked
        What it was made for.
    share : float
        The part of that error that it was asked for.
    piece : Piece
    mesh : Mesh
        What the piece was made of.
    boxes : Boxes
        Around its patches, all their samples included.
    """

    asked: Asked
    share: float
    piece: Piece
    mesh: Mesh
    boxes: Boxes

    def seen(self, asked: Asked) -> Made | None:
        """Return it as another camera sees it; None where that one deserves another.

        It does where a patch is off by more than it may be, or much less than it may be, or where
        one that was left out may come into view. Errors are in metres, so they hold from anywhere.
        """
        if asked == self.asked:
            return self
        mine = self.asked
        if (asked.metres, asked.pixels, asked.cull) != (mine.metres, mine.pixels, mine.cull):
            return None
        patches, piece = self.mesh.patches, self.piece
        assert patches is not None  # of a terrain
        shown, drawn = asked.shows(self.boxes), patches.drawn
        allowed = asked.allowed(self.boxes)
        exceeding = piece.errors > allowed
        wasteful = allowed > _FINER * piece.allowed
        if (shown & (~drawn | exceeding | wasteful)).any():
            return None
        return replace(self, piece=replace(piece, allowed=allowed))
