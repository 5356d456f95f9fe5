"""Heights that float within the tolerance: fewer triangles for the same promise.

::

    leaves, for more than is allowed ─▶ pattern ─▶ weld ─▶ fit ─▶ measure
                  ▲                                                 │
                  └── tiles of leaves that exceed ask for less ◀────┘

The kernels, and what they minimise: ``kernels/terrain/fitted.cl``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..device.device import DeviceArray, Kernel
from ..errors import InputError
from ..tessellation.pattern import DevicePattern
from .buffers import PatchSet
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
_LEAST_STEP: Final = 1 / 0.93
_MOST_STEP: Final = 2.0
# leaves that still exceed by then are held by their neighbours, which are asked for less as well
_ROUNDS_ALONE: Final = 6

_PASSES: Final = 16
_MOST_ROUNDS: Final = 40

_GROUP: Final = 64
_NOBODY: Final = -1
_INFINITE: Final = int(np.float32(np.inf).view(np.int32))


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
class Vertices:
    """The vertices of N points of a pattern, and where they stand.

    Attributes
    ----------
    places : DeviceArray, (N, 4) int32
        Of the points: cells, and fractions in 1/65536 of a cell, east and south.
    table : DeviceArray, int32
        Where points are found by their places.
    numbers : DeviceArray, (N,) int32
        Of the vertex of each point: one of the points at its place, which stands for all.
    above : DeviceArray, (N,) float32
        Of those that stand for all: height above the ground.
    """

    places: DeviceArray
    table: DeviceArray
    numbers: DeviceArray
    above: DeviceArray

    @property
    def found(self) -> dict[str, Any]:
        """What finds these vertices in a later round."""
        return {
            "earlier_places": self.places,
            "earlier_last": self.table.size - 1,
            "earlier_table": self.table,
            "earlier_heights": self.above,
        }


def fit_heights(
    patches: PatchSet,
    pattern: DevicePattern,
    allowed: DeviceArray,
    *,
    passes: int = _PASSES,
    before: Vertices | None = None,
) -> tuple[Vertices, PatchSet]:
    """Move the vertices of a pattern until its triangles are within what patches allow.

    Parameters
    ----------
    patches : PatchSet
    pattern : DevicePattern
    allowed : DeviceArray, (P,) float32
        Vertical error of each patch.
    passes : int
        How often all vertices are moved; patches that nothing pulls at are left alone.
    before : Vertices, optional
        Those that stand at the same places begin where they were.

    Returns
    -------
    vertices : Vertices
    patches : PatchSet
        Whose points stand there: those that share a place at the same height, to the bit.

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold the vertices.
    """
    device, count = patches.device, pattern.points.shape[0]
    group = device.group_size(_GROUP)
    slots = 1 << max(2 * count - 1, 1).bit_length()
    device.require(f"heights of {count} vertices", 32 * count, 29 * count, 4 * slots)
    items = device.runs(patches.count) * group

    # looked at where they will be measured
    defines = replace(patches, is_lifted=True).defines

    def run(name: str, items: int, **arguments: Any) -> None:
        kernel = device.kernel("terrain/fitted.cl", name, GROUP=group, **defines)
        kernel((items,), (group,), **arguments)

    shared = {"patches": patches.count, "point_offsets": pattern.point_offsets}
    placed = {**patches.ground.arguments, **patches.arguments, **shared}
    places, corners = device.empty((count, 4), np.int32), device.empty((count, 4), np.float32)
    run("put_points", items, **placed, points=pattern.points, places=places, corners=corners)
    table = device.empty(slots, np.int32).fill(_NOBODY)
    numbers, finest = (device.empty(count, np.int32) for _ in range(2))
    finest.fill(_INFINITE)
    run(
        "weld",
        patches.count,
        **shared,
        places=places,
        allowed=allowed,
        last=slots - 1,
        table=table,
        vertices=numbers,
        finest=finest,
    )
    vertices = Vertices(places, table, numbers, device.zeros(count, np.float32))
    of_vertices = {"count": count, "vertices": numbers}
    if before is not None:
        run(
            "recall",
            count,
            **of_vertices,
            places=places,
            **before.found,
            heights_above=vertices.above,
        )
    last = vertices.above.copy(0, count)
    moved, asking = device.zeros(count, np.uint8), device.zeros(patches.count, np.uint8).fill(1)
    sums = {"pulls": device.zeros(count, np.int32), "weights": device.zeros(count, np.int32)}
    moving = {"finest": finest, "heights_above": vertices.above, "moved": moved, **sums}
    for _ in range(passes):
        run(
            "pull",
            items,
            **placed,
            **moving,
            details=patches.details,
            triangle_offsets=pattern.primitive_offsets,
            triangles=pattern.primitives,
            corners=corners,
            vertices=numbers,
            allowed=allowed,
            asking=asking,
            scratch=group * 4,
        )
        run("move", count, **of_vertices, **moving, before=last)
    lifts = device.empty(count, np.float32)
    run("spread", count, **of_vertices, heights_above=vertices.above, lifts=lifts)
    return vertices, patches.lifted(lifts)


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
    view: npt.NDArray[Any],
    *,
    cull: bool,
    metres: float,
    pixels: float,
    weights: DeviceArray | None,
    fewer_than: int,
) -> Fitted | None:
    """Return the cheapest mesh found whose floating vertices keep an error.

    None where that takes no fewer triangles than are known to do.

    Parameters
    ----------
    tree : DeviceQuadtree
    view : layout.VIEW record
    cull : bool
    metres, pixels : float
        Errors allowed; infinite where not asked for.
    weights : DeviceArray, (tiles,) float32, or None
        How many times a tile's error counts.
    fewer_than : int
        Triangles.
    """
    device, vertices = tree.device, None
    asked: dict[str, Any] = {"view": view, "cull": cull, "metres": metres, "pixels": pixels}
    counted = tree.weights(weights)
    # for the choice of leaves errors count for less, tile by tile: heights make up for that
    of_tiles = np.float32(1.0) if weights is None else weights.host()
    choosing = device.empty(tree.ground.grid.count, np.float32)
    choosing.write(np.broadcast_to(of_tiles / np.float32(_FIRST_ASK), choosing.shape))
    for rounds in range(1, _MOST_ROUNDS + 1):
        with tree.marked() as (stamp, marks):
            leaves = Leaves(tree, stamp, marks, **asked, weights=tree.weights(choosing))
            leaves.fit()
            drawn = leaves.drawn()
        made = Tessellated.of(leaves.patches, leaves.factors, "integer")
        if made.triangle_count >= fewer_than:
            return None
        allowed, shown = _rooms(leaves, asked, counted)
        vertices, patches = fit_heights(leaves.patches, made.pattern, allowed, before=vertices)
        measured = device.zeros(leaves.count, np.float32)
        measure_patches(patches, made.pattern, shown, measured)
        reach = 0 if rounds <= _ROUNDS_ALONE else 1
        if _ask_for_less(leaves, allowed, measured, choosing, reach) == 0:
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


def _rooms(
    leaves: Leaves, asked: dict[str, Any], weights: DeviceArray | None
) -> tuple[DeviceArray, DeviceArray]:
    """Return the error that each leaf is allowed, 0 where nothing is drawn; and where it is."""
    allowed, shown = (leaves.device.empty(leaves.count, dtype) for dtype in (np.float32, np.uint8))
    _run(
        leaves,
        "rooms",
        **asked,
        is_weighted=int(weights is not None),
        weights=leaves.tree.deviations if weights is None else weights,
        hysteresis=0.0,
        details=leaves.tree.details,
        edge_factors=leaves.factors.edge,
        allowed=allowed,
        drawn=shown,
    )
    return allowed, shown


def _ask_for_less(
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
        least=_LEAST_STEP,
        most=_MOST_STEP,
        reach=reach,
        steps=steps,
        exceeding=exceeding,
    )
    _kernel(leaves, "tighten")((count,), (_GROUP,), tiles=count, steps=steps, weights=weights)
    return int(exceeding.host()[0])
