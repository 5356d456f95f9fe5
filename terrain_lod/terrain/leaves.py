"""The hull stage of promises: which nodes of the quadtree are patches, and with which factors.

::

    visit, from the top down ─▶ choose, from the bottom up ─▶ leaves ─▶ sides ─▶ insides ─▶ measure
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
from .measure import measure_patches
from .quadtree import DeviceQuadtree, Marks

# what is predicted differs from what is measured by roundings, of places above all
FIRST_SHARE: Final = 0.998

# the least share of what is allowed that a pattern is still asked for; below it leaves are split,
# and tiles meshed in full
_LEAST_SHARE: Final = 0.05

# arrays with a row a leaf
_OF_LEAVES: Final = (
    "_leaves",
    "_shares",
    "_changed",
    "_unmeasured",
    "_failed",
    "_keys",
    "measured",
)


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
    view : layout.VIEW record
    cull : bool
    metres, pixels : float
        Errors allowed; infinite where not asked for.
    weights : DeviceArray, (N,) float32
        How many times a node's error counts.

    Attributes
    ----------
    count : int
        P, leaves that were split included.
    factors : DeviceFactors
        0 where a leaf was split.
    sides : Sides
    measured : DeviceArray, (P,) float32
        Error of each leaf's triangles.
    """

    def __init__(
        self,
        tree: DeviceQuadtree,
        stamp: int,
        marks: Marks,
        view: npt.NDArray[Any],
        *,
        cull: bool,
        metres: float,
        pixels: float,
        weights: DeviceArray,
    ) -> None:
        self.tree, self.device = tree, tree.device
        self._stamp, self._marks = stamp, marks
        self._asked = {
            "view": view,
            "cull": int(cull),
            "metres": metres,
            "pixels": pixels,
            "weights": weights,
        }
        self.count = 0
        self._take(self._select())
        self._lay_sides()

    def _run(self, file: str, name: str, items: int, /, **arguments: Any) -> None:
        self.tree.kernel(file, name)((items,), (self.tree.group,), **arguments)

    @property
    def _states(self) -> dict[str, Any]:
        return {"stamp": self._stamp, "marks": self._marks.marks}

    def _select(self) -> DeviceArray:
        """Return the nodes of the cheapest mesh found, by what each costs by itself."""
        tree, device = self.tree, self.device
        first, roots = int(tree.first[-2]), int(tree.first[-1] - tree.first[-2])
        visited = device.empty(tree.count, np.int32)
        visited.write(np.arange(first, first + roots, dtype=np.int32))
        frontiers, begin, count = [], 0, roots
        while count:
            children = device.empty(count, np.uint32)
            self._run(
                "tree.cl",
                "visit",
                count,
                **tree.arguments,
                **self._asked,
                **self._states,
                share=FIRST_SHARE,
                order=tree.order,
                errors=tree.errors,
                first=begin,
                count=count,
                visited=visited,
                allowed=self._marks.allowed,
                costs=self._marks.costs,
                child_counts=children,
            )
            frontier = {"tree": tree.record(), "first": begin, "count": count, "visited": visited}
            frontiers.append((count, frontier))
            offsets, total = exclusive_scan(children)
            self._run(
                "tree.cl",
                "expand",
                count,
                **frontier,
                child_counts=children,
                child_offsets=offsets,
            )
            begin, count = begin + count, total
        for items, frontier in reversed(frontiers):
            costs = self._marks.costs
            self._run("tree.cl", "choose", items, **frontier, **self._states, costs=costs)
        is_leaf = device.empty(begin, np.uint32)
        seen = {"count": begin, "visited": visited}
        self._run(
            "tree.cl", "settle", begin, tree=tree.record(), **seen, **self._states, is_leaf=is_leaf
        )
        offsets, total = exclusive_scan(is_leaf)
        leaves = device.empty(total, np.int32)
        self._run(
            "tree.cl",
            "collect",
            begin,
            **seen,
            is_leaf=is_leaf,
            offsets=offsets,
            leaves=leaves,
            leaf_of=self._marks.leaf_of,
        )
        return leaves

    def _take(self, leaves: DeviceArray) -> None:
        device, count = self.device, leaves.size
        self.count = count
        self._leaves = leaves
        self._shares = device.empty(count, np.float32).fill(FIRST_SHARE)
        self._changed = device.zeros(count, np.uint8).fill(1)
        self._unmeasured = device.zeros(count, np.uint8).fill(1)
        self._failed = device.zeros(count, np.uint8)
        self._keys = device.zeros((count, layout.EDGES), np.uint32)
        self.measured = device.zeros(count, np.float32)
        self.factors = DeviceFactors(
            device.empty((count, layout.EDGES), np.float32),
            device.zeros((count, layout.INSIDES), np.float32),
        )

    def drawn(self) -> npt.NDArray[np.int32]:
        """Return the node of each leaf, -1 where it was split; (P,)."""
        there = self.factors.edge.host()[:, 0] > 0
        return np.where(there, self.nodes, np.int32(-1))

    @property
    def nodes(self) -> npt.NDArray[np.int32]:
        """The node of each leaf; (P,)."""
        nodes: npt.NDArray[np.int32] = self._leaves.host()
        return nodes

    @property
    def allowed(self) -> npt.NDArray[np.float32]:
        """The error that each leaf is allowed; (P,)."""
        allowed: npt.NDArray[np.float32] = self._marks.allowed.host()[self.nodes]
        return allowed

    @property
    def patches(self) -> PatchSet:
        """The leaves as the stages after this one see them."""
        arguments = {
            "tree": self.tree.record(),
            "leaves": self._leaves,
            "side_offsets": self.sides.offsets,
            "side_places": self.sides.places,
            "inside_factors": self.factors.inside,
            "lifts": self.factors.inside,  # not looked at until there are any
        }
        header = "terrain/patch_leaves.h"
        return PatchSet(self.tree.ground, header, self.count, arguments, self.tree.details)

    def _lay_sides(self) -> None:
        """Find the factors of all sides, and where their points lie."""
        device, count = self.device, self.count
        own = device.empty((count, layout.EDGES), np.int32)
        counts = device.empty(count * layout.EDGES, np.uint32)
        shared = {
            **self.tree.arguments,
            **self._states,
            "allowed": self._marks.allowed,
            "count": count,
            "leaves": self._leaves,
            "shares": self._shares,
            "leaf_of": self._marks.leaf_of,
            "factors": own,
        }
        self._run("joints.cl", "side_factors", count, **shared)
        self._run(
            "joints.cl",
            "side_counts",
            count * layout.EDGES,
            **shared,
            keys=self._keys,
            counts=counts,
            edge_factors=self.factors.edge,
            changed=self._changed,
            failed=self._failed,
        )
        offsets, total = exclusive_scan(counts)
        places = device.empty(total, np.int32)
        self._run(
            "joints.cl",
            "side_places",
            count * layout.EDGES,
            **shared,
            offsets=offsets,
            places=places,
        )
        self.sides = Sides(offsets, places)

    def choose(self) -> None:
        """Find the cheapest inside of each leaf that changed, beside its sides."""
        self._run(
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
            inside_factors=self.factors.inside,
            unmeasured=self._unmeasured,
            failed=self._failed,
        )
        self._changed.fill(0)

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
        self._run(
            "tree.cl",
            "count_children",
            count,
            tree=tree.record(),
            count=count,
            leaves=self._leaves,
            failed=self._failed,
            child_counts=children,
        )
        offsets, total = exclusive_scan(children)
        if total == 0:
            return False
        self._failed.fill(0)
        self.count += total
        for name in _OF_LEAVES:
            setattr(self, name, _extended(getattr(self, name), total))
        self.factors = DeviceFactors(
            _extended(self.factors.edge, total), _extended(self.factors.inside, total)
        )
        self._run(
            "tree.cl",
            "split",
            count,
            grid=tree.ground.grid.record(),
            tree=tree.record(),
            details=tree.details,
            **self._asked,
            **self._states,
            share=FIRST_SHARE,
            count=count,
            child_counts=children,
            child_offsets=offsets,
            allowed=self._marks.allowed,
            leaf_of=self._marks.leaf_of,
            leaves=self._leaves,
            shares=self._shares,
            changed=self._changed,
        )
        return True

    def measure(self, pattern: DevicePattern) -> None:
        """Measure the triangles of the leaves that changed, at every sample."""
        measure_patches(self.patches, pattern, self._unmeasured, self.measured)
        self._unmeasured.fill(0)

    def tighten(self) -> tuple[int, int]:
        """Ask leaves that exceed for less; note those that nothing holds for.

        Returns
        -------
        exceeding, refinable : int
            Leaves that exceed, and those of them that can do better.
        """
        counts = self.device.zeros(2, np.uint32)
        self._run(
            "tree.cl",
            "tighten",
            self.count,
            tree=self.tree.record(),
            **self._states,
            count=self.count,
            least_share=_LEAST_SHARE,
            leaves=self._leaves,
            allowed=self._marks.allowed,
            measured=self.measured,
            shares=self._shares,
            changed=self._changed,
            failed=self._failed,
            counts=counts,
        )
        exceeding, refinable = (int(number) for number in counts.host())
        return exceeding, refinable

    def refine(self) -> None:
        """Split what :meth:`tighten` noted, and lay the sides of what has changed."""
        self._split()
        self._lay_sides()


def _extended(array: DeviceArray, extra: int) -> DeviceArray:
    """Return a copy with room for so many more rows, all zero."""
    longer = array.device.zeros((array.shape[0] + extra, *array.shape[1:]), array.dtype)
    longer.paste(array, 0)
    return longer
