"""Which nodes of the quadtree a mesh is made of: the cheapest, by what each costs by itself.

::

    visit, level by level ─▶ descend, subtree by subtree ─▶ choose, from below ─▶ collect
"""

from __future__ import annotations

from dataclasses import dataclass
from math import prod
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..device.device import DeviceArray
from ..device.scan import exclusive_scan
from .quadtree import DeviceQuadtree, Marks

# what is predicted differs from what is measured by roundings, of places above all
FIRST_SHARE: Final = 0.998


@dataclass(frozen=True, eq=False)
class Allowance:
    """The error that nodes may have: ``kernels/terrain/allowance.h``.

    Attributes
    ----------
    view : layout.VIEW record
    cull : bool
        Whether nodes out of view are left out.
    metres, pixels : float
        Infinite where not asked for.
    weights : DeviceArray, (N,) float32, or None
        How many times a node's error counts.
    hysteresis : float
        Share by which nodes may be held to less than they are allowed: what they were last.
    """

    view: npt.NDArray[Any]
    cull: bool
    metres: float
    pixels: float
    weights: DeviceArray | None = None
    hysteresis: float = 0.0

    def arguments(self, tree: DeviceQuadtree) -> dict[str, Any]:
        """Return what kernels take, by the names of their arguments."""
        return {
            "view": self.view,
            "cull": int(self.cull),
            "metres": self.metres,
            "pixels": self.pixels,
            "is_weighted": int(self.weights is not None),
            "weights": tree.deviations if self.weights is None else self.weights,
            "hysteresis": self.hysteresis,
        }


@dataclass(frozen=True, eq=False)
class Chosen:
    """The leaves that were chosen, in the marks alone.

    Attributes
    ----------
    count : int
    offsets : DeviceArray, uint32
        Where each node's leaves are put, those above the tree's depth first.
    """

    tree: DeviceQuadtree
    states: dict[str, Any]
    offsets: DeviceArray
    count: int

    def collect(self, leaves: DeviceArray, leaf_of: DeviceArray) -> None:
        """Write the nodes of the leaves, and the numbers of the leaves that nodes are."""
        nodes = self.offsets.size - 1
        self.tree.run(
            "choice.cl",
            "collect",
            nodes,
            tree=self.tree.record,
            **self.states,
            nodes=nodes,
            offsets=self.offsets,
            leaves=leaves,
            leaf_of=leaf_of,
        )


def choose_nodes(tree: DeviceQuadtree, stamp: int, marks: Marks, allowance: Allowance) -> Chosen:
    """Find the nodes of the cheapest mesh; note in the marks what becomes of each.

    Parameters
    ----------
    tree : DeviceQuadtree
    stamp : int
        The mesh's number.
    marks : Marks
    allowance : Allowance
    """
    device, depth = tree.device, tree.depth
    above = range(depth + 1, len(tree.shapes))
    # those from the depth up stand at the end
    count = tree.count - int(tree.first[depth])
    costs, counts = device.empty(count, np.float32), device.empty(count, np.uint32)
    states = {"stamp": stamp, "marks": marks.marks}
    asked = {
        **tree.arguments,
        **allowance.arguments(tree),
        **states,
        "share": FIRST_SHARE,
        "order": tree.order,
        "errors": tree.errors,
        "allowed": marks.allowed,
        "costs": costs,
    }
    for level in reversed(above):
        tree.run_groups("choice.cl", "visit", prod(tree.shapes[level]), **asked, level=level)
    tree.run_groups("choice.cl", "descend", prod(tree.shapes[depth]), **asked, leaf_counts=counts)
    chosen = {"tree": tree.record, **states}
    for level in above:
        items = prod(tree.shapes[level])
        tree.run("choice.cl", "choose", items, **chosen, level=level, costs=costs)
    tree.run("choice.cl", "count", count, **chosen, nodes=count, leaf_counts=counts)
    offsets, total = exclusive_scan(counts)
    return Chosen(tree, states, offsets, total)
