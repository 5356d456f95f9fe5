"""The hull stage of promises: the nodes of the quadtree that are patches, and their factors.

::

    nodes, by what each costs (choice.py) ─▶ leaves ─▶ sides ─▶ insides ─▶ measure
                                               ▲                  │           │
                                               └── split what ◀───┴───────────┘
                                                   nothing holds for
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..device import layout
from ..device.device import DeviceArray
from ..device.scan import exclusive_scan
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from .buffers import PatchSet
from .choice import FIRST_SHARE, Allowance, choose_nodes
from .measure import measure_patches
from .quadtree import DeviceQuadtree, Marks

# the least share of what is allowed that a pattern is still asked for; below it leaves are split,
# and tiles meshed in full
_LEAST_SHARE: Final = 0.05

# arrays with a row a leaf
_OF_LEAVES: Final = {
    "_leaves": ((), np.int32),
    "_shares": ((), np.float32),
    "_changed": ((), np.uint8),
    "_unmeasured": ((), np.uint8),
    "_failed": ((), np.uint8),
    "_keys": ((layout.EDGES,), np.uint32),
    "_side_factors": ((layout.EDGES,), np.int32),
    "_side_rooms": ((layout.EDGES,), np.float32),
    "_edges": ((layout.EDGES,), np.float32),
    "_insides": ((layout.INSIDES,), np.float32),
    "measured": ((), np.float32),
}


@dataclass(frozen=True, eq=False)
class Drawn:
    """What is known of P leaves; all 0 of those that were split.

    Attributes
    ----------
    areas : (P, 4) int32
        First row, first column, rows and columns of their cells.
    measured, allowed, deviation : (P,) float32
        Errors, and how far their tiles' samples deviate from planes.
    """

    areas: npt.NDArray[np.int32]
    measured: npt.NDArray[np.float32]
    allowed: npt.NDArray[np.float32]
    deviation: npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class Sides:
    """Where the points of the sides of P leaves lie.

    Attributes
    ----------
    offsets : DeviceArray, (P * 4 + 1,) uint32
    places : DeviceArray, int32
        In 1/65536 of a cell from the leaf's first sample, east or south.
    """

    offsets: DeviceArray
    places: DeviceArray


class Leaves:
    """The P leaves of one mesh, as far as it has come.

    Parameters
    ----------
    tree : DeviceQuadtree
    stamp : int
        The mesh's number.
    marks : Marks
    allowance : Allowance

    Attributes
    ----------
    count : int
        P, leaves that were split included.
    sides : Sides
    measured : DeviceArray, float32
        Error of each leaf's triangles, and more rows than leaves.
    """

    _leaves: DeviceArray
    _shares: DeviceArray
    _changed: DeviceArray
    _unmeasured: DeviceArray
    _failed: DeviceArray
    _keys: DeviceArray
    _side_factors: DeviceArray
    _side_rooms: DeviceArray
    _edges: DeviceArray
    _insides: DeviceArray
    measured: DeviceArray

    def __init__(
        self,
        tree: DeviceQuadtree,
        stamp: int,
        marks: Marks,
        allowance: Allowance,
    ) -> None:
        self.tree, self.device = tree, tree.device
        self._stamp, self._marks = stamp, marks
        self._asked = allowance.arguments(tree)
        self.count, self._room = 0, -1
        chosen = choose_nodes(tree, stamp, marks, allowance)
        self._append(chosen.count)
        chosen.collect(self._leaves, marks.leaf_of)
        self._lay_sides()

    @property
    def _states(self) -> dict[str, Any]:
        return {"stamp": self._stamp, "marks": self._marks.marks}

    def _append(self, extra: int) -> None:
        """Make room for more leaves, of which nothing is known."""
        first, self.count = self.count, self.count + extra
        if self.count > self._room:
            self._room = self.count + self.count // 4  # most meshes split no more
            for name, (shape, dtype) in _OF_LEAVES.items():
                longer = self.device.empty((self._room, *shape), dtype)
                if first:
                    longer.paste(getattr(self, name).head(first), 0)
                setattr(self, name, longer)
        self.tree.run(
            "leaves.cl",
            "begin",
            extra,
            first=first,
            count=extra,
            share=FIRST_SHARE,
            shares=self._shares,
            changed=self._changed,
            unmeasured=self._unmeasured,
            failed=self._failed,
            keys=self._keys,
            factors=self._side_factors,
            inside_factors=self._insides,
            measured=self.measured,
        )

    @property
    def factors(self) -> DeviceFactors:
        """Factors of all leaves, 0 of those that were split."""
        return DeviceFactors(self._edges.head(self.count), self._insides.head(self.count))

    def drawn(self) -> Drawn:
        """Bring down what is known of the leaves."""
        device, count = self.device, self.count
        areas, known = device.empty((count, 4), np.int32), device.empty((count, 4), np.float32)
        self.tree.run(
            "leaves.cl",
            "describe",
            count,
            grid=self.tree.ground.grid.record(),
            tree=self.tree.record,
            is_weighted=self._asked["is_weighted"],
            weights=self._asked["weights"],
            count=count,
            leaves=self._leaves,
            **self._states,
            allowed=self._marks.allowed,
            measured=self.measured,
            deviations=self.tree.deviations,
            areas=areas,
            known=known,
        )
        measured, allowed, deviation, _ = known.host().T
        return Drawn(areas.host(), measured, allowed, deviation)

    @property
    def nodes(self) -> npt.NDArray[np.int32]:
        """The node of each leaf; (P,)."""
        nodes: npt.NDArray[np.int32] = self._leaves.head(self.count).host()
        return nodes

    @property
    def patches(self) -> PatchSet:
        """The leaves as the stages after this one see them."""
        arguments = {
            "tree": self.tree.record,
            "leaves": self._leaves,
            "side_offsets": self.sides.offsets,
            "side_places": self.sides.places,
            "inside_factors": self._insides,
            "lifts": self._insides,  # not looked at until there are any
        }
        header = "terrain/patch_leaves.h"
        return PatchSet(self.tree.ground, header, self.count, arguments, self.tree.details)

    def _lay_sides(self) -> None:
        """Find the factors of all sides, and where their points lie."""
        device, count = self.device, self.count
        sides = count * layout.EDGES
        counts = device.empty(sides, np.uint32)
        shared = {
            **self.tree.arguments,
            **self._states,
            "allowed": self._marks.allowed,
            "count": count,
            "leaves": self._leaves,
            "shares": self._shares,
            "leaf_of": self._marks.leaf_of,
            "factors": self._side_factors,
        }
        self.tree.run("joints.cl", "side_factors", sides, **shared, rooms=self._side_rooms)
        self.tree.run(
            "joints.cl",
            "side_counts",
            sides,
            **shared,
            keys=self._keys,
            counts=counts,
            edge_factors=self._edges,
            changed=self._changed,
            failed=self._failed,
        )
        offsets, total = exclusive_scan(counts)
        places = device.empty(total, np.int32)
        self.tree.run(
            "joints.cl",
            "side_places",
            sides,
            **shared,
            offsets=offsets,
            places=places,
        )
        self.sides = Sides(offsets, places)

    def choose(self) -> None:
        """Find the cheapest inside of each leaf that changed, beside its sides."""
        self.tree.run_groups(
            "leaf_fit.cl",
            "fit_leaves",
            self.count,
            **self.tree.arguments,
            **self._states,
            order=self.tree.order,
            errors=self.tree.errors,
            inner_errors=self.tree.inner_errors,
            allowed=self._marks.allowed,
            count=self.count,
            leaves=self._leaves,
            shares=self._shares,
            side_offsets=self.sides.offsets,
            side_places=self.sides.places,
            changed=self._changed,
            inside_factors=self._insides,
            unmeasured=self._unmeasured,
            failed=self._failed,
        )

    def fit(self) -> None:
        """Find insides that hold, and split leaves until all have some."""
        self.choose()
        while self._split():
            self._lay_sides()
            self.choose()

    def _split(self) -> bool:
        """Put the children of failed leaves behind the others; say whether there were any."""
        tree, device, count = self.tree, self.device, self.count
        children = device.empty(count, np.uint32)
        self.tree.run(
            "leaves.cl",
            "count_children",
            count,
            tree=tree.record,
            count=count,
            leaves=self._leaves,
            failed=self._failed,
            child_counts=children,
        )
        offsets, total = exclusive_scan(children)
        if total == 0:
            return False
        self._append(total)
        self.tree.run(
            "leaves.cl",
            "split",
            count,
            grid=tree.ground.grid.record(),
            tree=tree.record,
            details=tree.details,
            **self._asked,
            **self._states,
            count=count,
            child_counts=children,
            child_offsets=offsets,
            allowed=self._marks.allowed,
            leaf_of=self._marks.leaf_of,
            leaves=self._leaves,
            changed=self._changed,
            failed=self._failed,
        )
        return True

    def measure(self, pattern: DevicePattern) -> None:
        """Measure the triangles of the leaves that changed, at every sample."""
        measure_patches(self.patches, pattern, self._unmeasured, self.measured)

    def tighten(self) -> tuple[int, int]:
        """Ask leaves that exceed for less; note those that nothing holds for.

        Returns
        -------
        exceeding, refinable : int
            Leaves that exceed, and those of them that can do better.
        """
        counts = self.device.zeros(2, np.uint32)
        self.tree.run(
            "leaves.cl",
            "tighten",
            self.count,
            tree=self.tree.record,
            **self._states,
            count=self.count,
            least_share=_LEAST_SHARE,
            leaves=self._leaves,
            allowed=self._marks.allowed,
            measured=self.measured,
            shares=self._shares,
            changed=self._changed,
            unmeasured=self._unmeasured,
            failed=self._failed,
            counts=counts,
        )
        exceeding, refinable = (int(number) for number in counts.host())
        return exceeding, refinable

    def refine(self) -> None:
        """Split what :meth:`tighten` noted, and lay the sides of what has changed."""
        self._split()
        self._lay_sides()
