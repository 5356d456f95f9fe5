"""Heights that float within the tolerance: fewer triangles for the same promise.

::

    leaves, for more than is allowed ─▶ pattern ─▶ weld ─▶ fit ─▶ measure
                  ▲                                                 │
                  └── tiles of leaves that exceed ask for less ◀────┘

How vertices are fitted: ``floating.py``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from ..device.device import DeviceArray, Kernel
from ..errors import InputError
from .choice import Allowance
from .floating import fit_heights
from .leaves import Drawn, Leaves
from .lod import AnyLod, PromiseLod, unweighted
from .measure import measure_patches
from .meshing import Tessellated
from .quadtree import DeviceQuadtree
from .steady import Steady

HEIGHTS: Final = ("ground", "fitted")

# leaves are chosen for so many times what is allowed, with vertices on the ground
_FIRST_ASK: Final = 1.9
# and then for less, by the square root of what they exceed, within these steps
LEAST_STEP: Final = 1 / 0.93
MOST_STEP: Final = 2.0
# leaves that still exceed by then are held by their neighbours, which are asked for less as well
_ROUNDS_ALONE: Final = 6

_MOST_ROUNDS: Final = 40

_GROUP: Final = 64


def check_fitted(lod: AnyLod, partitioning: str, steady: Steady | None) -> None:
    """Refuse levels of detail and partitionings whose heights cannot be fitted, or be steady.

    Raises
    ------
    InputError
    """
    if not isinstance(unweighted(lod), PromiseLod):
        raise InputError(
            f"expected a promise for fitted heights, such as MaxErrorLod, got "
            f"{type(unweighted(lod)).__name__}: it allows no error to float within"
        )
    if partitioning != "integer":
        raise InputError(
            f"expected the partitioning 'integer' for fitted heights, got {partitioning!r}"
        )
    if steady is not None:
        raise InputError(
            f"expected heights='ground' with {steady}, got 'fitted': heights that float do not stay"
        )


@dataclass(frozen=True, eq=False)
class Fitted:
    """A mesh whose vertices float, and what was measured of it.

    Attributes
    ----------
    made : Tessellated
    drawn : Drawn
        What is known of the patches.
    rounds : int
        How often the mesh was measured.
    """

    made: Tessellated
    drawn: Drawn
    rounds: int


def fitted_mesh(
    tree: DeviceQuadtree,
    allowance: Allowance,
    weights: DeviceArray | None,
    *,
    fewer_than: int,
) -> Fitted | None:
    """Return the cheapest mesh found whose floating vertices keep an error.

    None where that takes no fewer triangles than are known to do.

    Parameters
    ----------
    tree : DeviceQuadtree
    allowance : Allowance
        Without weights.
    weights : DeviceArray, (tiles,) float32, or None
        How many times a tile's error counts.
    fewer_than : int
        Triangles.
    """
    device, vertices = tree.device, None
    counted = tree.weights(weights)
    asked = replace(allowance, weights=counted)
    # for the choice of leaves errors count for less, tile by tile: heights make up for that
    of_tiles = np.float32(1.0) if weights is None else weights.host()
    choosing = device.empty(tree.ground.grid.count, np.float32)
    choosing.write(np.broadcast_to(of_tiles / np.float32(_FIRST_ASK), choosing.shape))
    for rounds in range(1, _MOST_ROUNDS + 1):
        with tree.marked() as (stamp, marks):
            chosen_for = replace(allowance, weights=tree.weights(choosing))
            leaves = Leaves(tree, stamp, marks, chosen_for)
            leaves.fit()
            drawn = leaves.drawn()
        made = Tessellated.of(leaves.patches, leaves.factors, "integer")
        if made.triangle_count >= fewer_than:
            return None
        allowed, shown = rooms_of(leaves, asked)
        vertices, patches = fit_heights(leaves.patches, made.pattern, allowed, before=vertices)
        measured = device.zeros(leaves.count, np.float32)
        measure_patches(patches, made.pattern, shown, measured)
        reach = 0 if rounds <= _ROUNDS_ALONE else 1
        if ask_for_less(leaves, allowed, measured, choosing, reach) == 0:
            held = allowed.host()
            if counted is not None:
                held = held * counted.host()[leaves.nodes]
            drawn = replace(drawn, measured=measured.host(), allowed=held)
            return Fitted(replace(made, patches=patches), drawn, rounds)
    return None


def _kernel(leaves: Leaves, name: str) -> Kernel:
    defines = {"GROUP": _GROUP, **leaves.patches.defines}
    return leaves.device.kernel("terrain/fitted.cl", name, **defines)


def _run(leaves: Leaves, name: str, **arguments: Any) -> None:
    """Launch a kernel with an item a leaf."""
    tree = leaves.tree
    _kernel(leaves, name)(
        (leaves.count,),
        (_GROUP,),
        grid=tree.ground.grid.record(),
        tree=tree.record,
        count=leaves.count,
        leaves=leaves.patches.arguments["leaves"],
        **arguments,
    )


def rooms_of(leaves: Leaves, asked: Allowance) -> tuple[DeviceArray, DeviceArray]:
    """Return the error that each leaf is allowed, 0 where nothing is drawn; and where it is."""
    allowed, shown = (leaves.device.empty(leaves.count, dtype) for dtype in (np.float32, np.uint8))
    _run(
        leaves,
        "rooms",
        **asked.arguments(leaves.tree),
        details=leaves.tree.details,
        edge_factors=leaves.factors.edge,
        allowed=allowed,
        drawn=shown,
    )
    return allowed, shown


def ask_for_less(
    leaves: Leaves, allowed: DeviceArray, measured: DeviceArray, weights: DeviceArray, reach: int
) -> int:
    """Make errors count for more in tiles of leaves that exceed, and so far around.

    Returns
    -------
    int
        How many leaves exceed.
    """
    device, count = leaves.device, weights.size
    exceeding = device.zeros(1, np.uint32)
    steps = device.empty(count, np.float32).fill(1.0)
    _run(
        leaves,
        "ask",
        allowed=allowed,
        measured=measured,
        least=LEAST_STEP,
        most=MOST_STEP,
        reach=reach,
        steps=steps,
        exceeding=exceeding,
    )
    _kernel(leaves, "tighten")((count,), (_GROUP,), tiles=count, steps=steps, weights=weights)
    return int(exceeding.host()[0])
