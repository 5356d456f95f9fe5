"""A quadtree of patches over the tiles, and what is known of its nodes.

A node of level k covers 2^k x 2^k tiles, as far as there are any, and is meshed like a tile. Coarse
nodes are looked at on a lattice of samples; how far that is from all samples between is known as
their drift, and counts against every error that they promise.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import prod
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..device import layout
from ..device.device import Device, DeviceArray, Kernel
from .buffers import DeviceAnalysis, DeviceGround, lattice_levels
from .steady import Steady

_GROUP: Final = 64
_NODE_GROUP: Final = 32  # that look at one node together
_GATHERED: Final = 3  # levels of nodes that are found at once
_DEPTH: Final = 3  # levels below those that are looked at one after the other


def level_shapes(shape: tuple[int, int], levels: int | None = None) -> tuple[tuple[int, int], ...]:
    """Return rows and columns of the nodes of each level, from the tiles up to a single node.

    At most so many `levels`, the tiles' own included.
    """
    shapes = [shape]
    while max(shapes[-1]) > 1 and len(shapes) < (levels or layout.MAX_LEVELS):
        rows, columns = shapes[-1]
        shapes.append((-(-rows // 2), -(-columns // 2)))
    return tuple(shapes)


def cheapest_first(tile: int) -> npt.NDArray[np.int32]:
    """Return pairs of factors of an inside, tile (v - 1) + u - 1, the fewest triangles first.

    Beside sides of any factors, u x v segments make 2 (u - 1) (v - 1) - 2 triangles; one segment
    becomes two. Of pairs with equally many, the most even is first.
    """
    v, u = np.divmod(np.arange(tile**2, dtype=np.int32), tile)
    return np.lexsort([u + v, np.maximum(u, 1) * np.maximum(v, 1)]).astype(np.int32)


@dataclass(frozen=True, eq=False)
class Marks:
    """What becomes of each of N nodes in the mesh that is being made, and became of it in the last.

    Attributes
    ----------
    marks : DeviceArray, (N,) uint32
        Of the last mesh that looked at a node: its number, and what it made of it.
    allowed : DeviceArray, (N,) float32
    leaf_of : DeviceArray, (N,) int32
    """

    marks: DeviceArray
    allowed: DeviceArray
    leaf_of: DeviceArray


@dataclass(frozen=True, eq=False)
class DeviceQuadtree:
    """The N nodes over the tiles of a ground, level by level.

    Errors are measured when they are first asked for, and remembered; all else is never changed.

    Attributes
    ----------
    ground : DeviceGround
    shapes : tuple of (int, int)
        Rows and columns of the nodes of each level.
    drifts : DeviceArray, float32
        How far the samples of blocks of nodes are from the lattices of the levels that have one.
    details : DeviceArray, (N, 4) float32
        Drift, minimum, maximum, samples without data.
    deviations : DeviceArray, (N,) float32
        The largest of the node's tiles.
    order : DeviceArray, (T * T,) int32
        Pairs of factors, see :func:`cheapest_first`.
    errors, inner_errors : DeviceArray, (N, T, T) uint16
        Largest error of a node at a pair of factors, all of it or what lies within the pattern's
        outermost inner lines, as far as it is known: ``kernels/terrain/lattice.h``.
    """

    ground: DeviceGround
    shapes: tuple[tuple[int, int], ...]
    drifts: DeviceArray
    details: DeviceArray
    deviations: DeviceArray
    order: DeviceArray
    errors: DeviceArray
    inner_errors: DeviceArray
    _spare: list[tuple[int, Marks]] = field(default_factory=list)
    _lock: threading.Lock = field(default_factory=threading.Lock)
    _kernels: dict[tuple[str, str], Kernel] = field(default_factory=dict)

    @classmethod
    def of(
        cls, ground: DeviceGround, analysis: DeviceAnalysis, levels: int | None = None
    ) -> DeviceQuadtree:
        """Put a tree of at most so many levels over the tiles of a ground.

        Raises
        ------
        DeviceMemoryError
            If the device cannot hold what is to be known of its nodes.
        """
        device, tile = ground.device, ground.grid.tile
        shapes = level_shapes(ground.grid.shape, levels)
        count = sum(rows * columns for rows, columns in shapes)
        device.require(f"a quadtree of {count} nodes", *2 * [2 * count * tile**2], 20 * count)
        tree = cls(
            ground,
            shapes,
            device.empty(_block_count(shapes, lattice_levels(tile)), np.float32),
            device.empty((count, 4), np.float32),
            device.empty(count, np.float32),
            device.array(cheapest_first(tile)),
            errors=device.zeros((count, tile, tile), np.uint16),
            inner_errors=device.zeros((count, tile, tile), np.uint16),
        )
        tree._look_at(analysis, (0, 0, ground.grid.rows, ground.grid.columns))
        return tree

    def updated(
        self, ground: DeviceGround, analysis: DeviceAnalysis, changed: npt.NDArray[np.int32]
    ) -> DeviceQuadtree:
        """Return the tree over a ground that differs in some tiles alone.

        It forgets errors where they stand: nothing is lost to who goes on with this one.
        """
        tree = replace(
            self,
            ground=ground,
            _kernels={},  # holes may have come
            drifts=self.drifts.copy(0, self.drifts.size),
            details=self.details.copy(0, self.count),
            deviations=self.deviations.copy(0, self.count),
        )
        grid = ground.grid
        rows, columns = np.divmod(changed, grid.shape[1])
        top, left, bottom, right = (
            int(number) for number in (rows.min(), columns.min(), rows.max(), columns.max())
        )
        south, east = int(grid.corner_rows[bottom + 1]), int(grid.corner_columns[right + 1])
        window = int(grid.corner_rows[top]), int(grid.corner_columns[left]), south, east
        tree._look_at(analysis, window)
        for level in range(len(self.shapes)):
            down = (bottom >> level) - (top >> level) + 1
            across = (right >> level) - (left >> level) + 1
            tree.run(
                "tree.cl",
                "forget",
                down * across,
                tree=tree.record,
                level=level,
                row=top >> level,
                column=left >> level,
                rows=down,
                columns=across,
                errors=tree.errors,
                inner_errors=tree.inner_errors,
            )
        return tree

    @property
    def device(self) -> Device:
        return self.ground.device

    @property
    def count(self) -> int:
        return sum(rows * columns for rows, columns in self.shapes)

    @property
    def depth(self) -> int:
        """The level below which nodes are looked at subtree by subtree."""
        return min(_DEPTH, len(self.shapes) - 1)

    @property
    def first(self) -> npt.NDArray[np.int32]:
        """The first node of each level, and the end; (levels + 1,)."""
        sizes = [rows * columns for rows, columns in self.shapes]
        return np.cumsum([0, *sizes]).astype(np.int32)

    @cached_property
    def record(self) -> npt.NDArray[Any]:
        """The ``layout.TREE`` record that kernels take."""
        record = np.zeros((), layout.TREE)
        levels = len(self.shapes)
        record["levels"] = levels
        record["rows"][:levels], record["columns"][:levels] = np.transpose(self.shapes)
        record["first"][:levels] = self.first[:-1]
        return record

    @property
    def arguments(self) -> dict[str, Any]:
        """What kernels that read ground and nodes take, by the names of their arguments."""
        return {**self.ground.arguments, "tree": self.record, "details": self.details}

    def run(self, file: str, name: str, items: int, /, **arguments: Any) -> None:
        """Launch a kernel of ``kernels/terrain/``, a work-item for each of `items`."""
        self._kernel(file, name)((items,), (_GROUP,), **arguments)

    def run_groups(self, file: str, name: str, count: int, /, **arguments: Any) -> None:
        """Launch a kernel of ``kernels/terrain/``, a group for each of `count`."""
        group = self.device.group_size(_NODE_GROUP)
        self._kernel(file, name)((count * group,), (group,), **arguments)

    def _kernel(self, file: str, name: str) -> Kernel:
        if (file, name) not in self._kernels:
            kernel = self.device.kernel(f"terrain/{file}", name, **self._defines)
            self._kernels[file, name] = kernel
        return self._kernels[file, name]

    @cached_property
    def _defines(self) -> dict[str, int]:
        tile = self.ground.grid.tile
        return {
            "TILE": tile,
            "FINER": lattice_levels(tile),
            "DEPTH": self.depth,
            "GROUP": self.device.group_size(_NODE_GROUP),
            "LANES": self.device.lanes,
            **self.ground.defines,
        }

    @contextmanager
    def marked(self, steady: Steady | None = None) -> Iterator[tuple[int, Marks]]:
        """Yield the number of a new mesh, and marks of nodes that nobody else writes meanwhile."""
        if steady is not None:
            with steady.lock:
                stamp, marks = steady.marks if steady.of is self else (0, self._blank())
                steady.of, steady.marks = self, (stamp + 1, marks)
                yield stamp + 1, marks
            return
        with self._lock:
            stamp, marks = self._spare.pop() if self._spare else (0, self._blank())
        try:
            yield stamp + 1, marks
        finally:
            with self._lock:
                self._spare.append((stamp + 1, marks))

    def weights(self, of_tiles: DeviceArray | None) -> DeviceArray | None:
        """Return a weight a node, the largest of its tiles'; none where there are none."""
        if of_tiles is None:
            return None
        weights = self.device.empty(self.count, np.float32)
        weights.paste(of_tiles, 0)
        for level, (rows, columns) in list(enumerate(self.shapes))[1:]:
            self.run(
                "tree.cl", "lift", rows * columns, tree=self.record, level=level, weights=weights
            )
        return weights

    def _blank(self) -> Marks:
        device, count = self.device, self.count
        return Marks(
            marks=device.zeros(count, np.uint32),
            allowed=device.empty(count, np.float32).fill(np.nan),
            leaf_of=device.empty(count, np.int32),
        )

    def _look_at(self, analysis: DeviceAnalysis, changed: tuple[int, int, int, int]) -> None:
        """Find what is to be known of all nodes, where samples of one window alone have changed."""
        top, left, bottom, right = changed
        if self.drifts.size:
            self.run_groups(
                "tree.cl",
                "drift",
                self.drifts.size,
                **self.ground.arguments,
                tree=self.record,
                top=top,
                left=left,
                bottom=bottom,
                right=right,
                drifts=self.drifts,
            )
        first = self.first
        for level in range(0, max(len(self.shapes) - 1, 1), _GATHERED):
            below, last = level + (level > 0), min(level + _GATHERED + 1, len(self.shapes))
            count = int(first[last] - first[below])
            self.run(
                "tree.cl",
                "gather",
                count,
                tree=self.record,
                level=level,
                count=count,
                tiles=analysis.details,
                drifts=self.drifts,
                details=self.details,
                deviations=self.deviations,
            )


def _block_count(shapes: tuple[tuple[int, int], ...], finer: int) -> int:
    """Return how many blocks drifts are found by: ``kernels/terrain/tree.cl``."""
    levels = range(finer + 1, len(shapes))
    return sum(prod(shapes[min(level, max(3, level - 5))]) for level in levels)
