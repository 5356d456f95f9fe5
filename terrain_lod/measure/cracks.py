r"""Does a mesh have cracks? Open edges that face another surface, T-junctions, folds.

An open edge is used by one triangle only. It is harmless on the outline of a mesh, or of a hole in
it; it is a crack where the mesh goes on at its other side:

::

    other factors at the two sides        another height at the same place, seen from the side

       \     \     \     /                     ____
    ----*-----*-----*-----  open edges             \____  gap
    =========*============  open edges         _________
          \    /
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

from ..arguments import flag
from ..mesh.mesh import Mesh
from ..mesh.open_edges import Indices, topology, weld
from ..mesh.soundness import sound_mesh
from .opposed_edges import ROUNDING, Pieces, opposed_pieces

# a heightfield's triangles face one way, but for this part of their area
_FOLDED_PART: Final = 0.1
# how many places a report tells
_PLACES: Final = 5

Array = npt.NDArray[np.float64]


class Crack(NamedTuple):
    """A place where a mesh is open.

    Attributes
    ----------
    gap : float
        Distance between the two sides in world units; infinite where there is no other side.
    point : (float, float, float)
        In the world.
    """

    gap: float
    point: tuple[float, float, float]


@dataclass(frozen=True)
class CrackReport:
    """What keeps a mesh from being watertight; false where nothing does.

    Attributes
    ----------
    open_edges : int
        Edges of one triangle only, on outlines and in cracks.
    cracks : int
        Those of them at which the mesh goes on at the other side; all, if it was to be closed.
    t_junctions : int
        Vertices in the middle of an edge of the other side.
    folded : int
        Triangles of a heightfield that face down.
    unbalanced : int
        Edges that several triangles use, but not as often one way as the other: three at one
        edge, or neighbours that face opposite ways.
    left_out : int
        Triangles with two corners at the same position, or that repeat another: not judged.
    largest_gap : float
        In world units; 0 where both sides of each crack coincide.
    places : tuple of Crack
        The widest few, widest first.
    """

    open_edges: int
    cracks: int
    t_junctions: int
    folded: int
    unbalanced: int
    left_out: int
    largest_gap: float
    places: tuple[Crack, ...]

    def __bool__(self) -> bool:
        return bool(self.cracks or self.t_junctions or self.folded or self.unbalanced)

    def __str__(self) -> str:
        found = [
            f"{count} {name}{'' if count == 1 else 's'}"
            for count, name in (
                (self.cracks, "cracked edge"),
                (self.t_junctions, "T-junction"),
                (self.folded, "folded triangle"),
                (self.unbalanced, "unbalanced edge"),
            )
            if count
        ]
        if not found:
            return f"watertight, {self.open_edges} edges on outlines"
        if self.places:
            x, y, z = self.places[0].point
            found.append(f"largest gap {self.largest_gap:.4g} at ({x:.10g}, {y:.10g}, {z:.10g})")
        return ", ".join(found)


def crack_report(mesh: Mesh, *, closed: bool = False) -> CrackReport:
    """Look for cracks in a mesh.

    Vertices at the same position, bit for bit, are taken as one. A mesh is a heightfield if it is
    a terrain's, or if nine tenths of its area, seen from above, face one way. A heightfield's open
    edges are compared seen from above, so that sides at different heights are found whatever their
    distance; any other mesh's are compared in space.

    Ends that nearly meet count as meeting: within a quarter of the open edges at them, of the
    heights of the triangles over these, and of the mean open edge. What gapes wider is a hole with
    an outline, and allowed unless the mesh is to be closed.

    Parameters
    ----------
    mesh : Mesh
    closed : bool, optional
        The mesh is to have no outline at all: every open edge is a crack.

    Returns
    -------
    CrackReport
        False where the mesh is watertight.

    Raises
    ------
    InputError
        If the mesh has positions that are not finite or corners that are no vertices.

    Examples
    --------
    >>> if report := crack_report(mesh):                        # doctest: +SKIP
    ...     print(report)
    """
    mesh, closed = sound_mesh(mesh), flag("closed", closed)
    numbers = weld(mesh.vertices)
    points = np.empty((int(numbers.max(initial=-1)) + 1, 3))
    points[numbers] = mesh.vertices
    surface = topology(numbers[mesh.triangles])
    is_heightfield, folded = _facing(points, surface.triangles, known=mesh.patches is not None)
    starts, ends = points[surface.open_edges].transpose(1, 0, 2)
    apexes = points[surface.open_apexes]
    pieces = opposed_pieces(starts, ends, apexes, from_above=is_heightfield)
    cracked = np.unique(pieces.edge)
    if closed:
        lonely = np.delete(np.arange(len(starts)), cracked)
        pieces = pieces.joined_by(lonely, (starts[lonely] + ends[lonely]) / 2)
        cracked = np.arange(len(starts))
    return CrackReport(
        open_edges=len(starts),
        cracks=len(cracked),
        t_junctions=pieces.t_junctions,
        folded=folded,
        unbalanced=surface.unbalanced,
        left_out=surface.left_out,
        largest_gap=float(pieces.gap.max(initial=0.0)),
        places=_widest(pieces, mesh.origin),
    )


def _facing(points: Array, triangles: Indices, *, known: bool) -> tuple[bool, int]:
    """Return whether a mesh is a heightfield, and how many of its triangles face the wrong way."""
    x, y = points[:, 0], points[:, 1]
    a, b, c = triangles.T
    across = np.stack([x[b] - x[a], x[c] - x[a], y[b] - y[a], y[c] - y[a]])
    area = across[0] * across[3] - across[1] * across[2]
    up, down = area[area > 0].sum(), -area[area < 0].sum()
    if not known and min(up, down) >= _FOLDED_PART * (up + down):
        return False, 0
    # an area that comes from the corners' rounding says nothing
    extent = np.abs(across, out=across).reshape(2, 2, -1).max(axis=1, initial=0.0)
    largest = np.abs(points[:, :2]).max(axis=0, initial=0.0)
    noise = ROUNDING * np.maximum(largest[0] * extent[1], largest[1] * extent[0])
    return True, int(np.count_nonzero(area < -noise if up >= down else area > noise))


def _widest(pieces: Pieces, origin: Array) -> tuple[Crack, ...]:
    """Return the widest few cracks at different nodes."""
    # a node ends a few pieces: among so many are as many nodes as wanted
    order = np.argsort(-pieces.gap, kind="stable")[: 50 * _PLACES]
    _, first = np.unique(pieces.node[order], return_index=True)
    return tuple(
        Crack(float(pieces.gap[index]), tuple((pieces.point[index] + origin).tolist()))
        for index in order[np.sort(first)[:_PLACES]]
    )
