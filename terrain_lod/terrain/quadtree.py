"""A quadtree of patches over the tiles, and what is known of its nodes.

A node of level k covers 2^k x 2^k tiles, as far as there are any, and is meshed like a tile. Coarse
nodes are looked at on a lattice of samples; how far that is from all samples between is known as
their drift, and counts against every error that they promise.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..device import layout
from ..device.device import Device, DeviceArray, Kernel
from .buffers import DeviceAnalysis, DeviceGround, lattice_levels
from .steady import Steady

_GROUP: Final = 64
_UNMEASURED: Final = -1e-30  # ``kernels/terrain/lattice.h``


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
    allowed, costs : DeviceArray, (N,) float32
    leaf_of : DeviceArray, (N,) int32
    """

    marks: DeviceArray
    allowed: DeviceArray
    costs: DeviceArray
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
    drifts : tuple of DeviceArray, (P,) float32
        How far the samples of each tile are from the lattice of a level, for levels that have one.
    details : DeviceArray, (N, 4) float32
        Drift, minimum, maximum, samples without data.
    order : DeviceArray, (T * T,) int32
        Pairs of factors, see :func:`cheapest_first`.
    errors, inner_errors : DeviceArray, (N, T, T) float32
        Largest error of a node at a pair of factors, all of it or what lies within the pattern's
        outermost inner lines; negative, and then no more than a lower limit, where it is unknown.
    """

    ground: DeviceGround
    shapes: tuple[tuple[int, int], ...]
    drifts: tuple[DeviceArray, ...]
    details: DeviceArray
    order: DeviceArray
    errors: DeviceArray
    inner_errors: DeviceArray
    _spare: list[tuple[int, Marks]] = field(default_factory=list)
    _lock: threading.Lock = field(default_factory=threading.Lock)

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
        device.require(f"a quadtree of {count} nodes", *2 * [4 * count * tile**2], 16 * count)
        finer = lattice_levels(tile)
        tree = cls(
            ground,
            shapes,
            tuple(device.empty(ground.grid.count, np.float32) for _ in shapes[finer + 1 :]),
            device.empty((count, 4), np.float32),
            device.array(cheapest_first(tile)),
            errors=device.empty((count, tile, tile), np.float32).fill(_UNMEASURED),
            inner_errors=device.empty((count, tile, tile), np.float32).fill(_UNMEASURED),
        )
        tree._look_at(analysis, np.arange(ground.grid.count, dtype=np.int32))
        return tree

    def updated(
        self, ground: DeviceGround, analysis: DeviceAnalysis, changed: npt.NDArray[np.int32]
    ) -> DeviceQuadtree:
        """Return the tree over a ground that differs in some tiles alone."""
        tree = DeviceQuadtree(
            ground,
            self.shapes,
            tuple(drift.copy(0, drift.shape[0]) for drift in self.drifts),
            self.details.copy(0, self.count),
            self.order,
            self.errors.copy(0, self.count),
            self.inner_errors.copy(0, self.count),
        )
        tree._look_at(analysis, changed)
        rows, columns = np.divmod(changed, ground.grid.shape[1])
        for level in range(len(self.shapes)):
            top, left = int(rows.min()) >> level, int(columns.min()) >> level
            down = (int(rows.max()) >> level) - top + 1
            across = (int(columns.max()) >> level) - left + 1
            tree.kernel("tree.cl", "forget")(
                (down * across,),
                (tree.group,),
                tree=tree.record(),
                level=level,
                row=top,
                column=left,
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
    def group(self) -> int:
        """Work-items of a group that have nothing to share."""
        return self.device.group_size(_GROUP)

    @property
    def first(self) -> npt.NDArray[np.int32]:
        """The first node of each level, and the end; (levels + 1,)."""
        sizes = [rows * columns for rows, columns in self.shapes]
        return np.cumsum([0, *sizes]).astype(np.int32)

    def areas(self, nodes: npt.NDArray[np.int32]) -> npt.NDArray[np.int32]:
        """Return first row, first column, rows and columns of the cells of nodes; all 0 of -1.

        Returns
        -------
        (P, 4) int32
        """
        grid, first = self.ground.grid, self.first
        level = np.searchsorted(first, nodes, side="right") - 1
        columns = np.array([columns for _, columns in self.shapes])[level]
        row, column = np.divmod(nodes - first[level], columns)
        spans = []
        for place, corners in ((row, grid.corner_rows), (column, grid.corner_columns)):
            last = len(corners) - 1
            begin = corners[np.minimum(place << level, last)]
            spans.append((begin, corners[np.minimum((place + 1) << level, last)] - begin))
        (top, down), (left, across) = spans
        areas: npt.NDArray[np.int32] = np.stack([top, left, down, across], axis=1).astype(np.int32)
        areas[nodes < 0] = 0
        return areas

    def spread(self, values: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
        """Return the largest value of the tiles of each node, of one a tile; (N,)."""
        rows = [values.reshape(self.shapes[0])]
        for _ in self.shapes[1:]:
            below = np.pad(rows[-1], [(0, extent % 2) for extent in rows[-1].shape], mode="edge")
            rows.append(np.fmax.reduce([below[i::2, j::2] for i in (0, 1) for j in (0, 1)]))
        return np.concatenate([level.ravel() for level in rows])

    def record(self) -> npt.NDArray[Any]:
        """Return the ``layout.TREE`` record that kernels take."""
        record = np.zeros((), layout.TREE)
        levels = len(self.shapes)
        record["levels"] = levels
        record["rows"][:levels], record["columns"][:levels] = np.transpose(self.shapes)
        record["first"][:levels] = self.first[:-1]
        return record

    @property
    def arguments(self) -> dict[str, Any]:
        """What kernels that read ground and nodes take, by the names of their arguments."""
        return {**self.ground.arguments, "tree": self.record(), "details": self.details}

    def kernel(self, file: str, name: str, **defines: int | float | str) -> Kernel:
        """Return a kernel of ``kernels/terrain/`` built for this tree."""
        tile = self.ground.grid.tile
        own = {"TILE": tile, "FINER": lattice_levels(tile), **self.ground.defines}
        return self.device.kernel(f"terrain/{file}", name, **own, **defines)

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

    def weights(self, of_tiles: DeviceArray | None) -> DeviceArray:
        """Return a weight a node: the largest of its tiles', 1 where there are none."""
        weights = self.device.empty(self.count, np.float32).fill(1.0)
        if of_tiles is None:
            return weights
        weights.paste(of_tiles, 0)
        for level, (rows, columns) in list(enumerate(self.shapes))[1:]:
            self.kernel("tree.cl", "lift")(
                (rows * columns,), (self.group,), tree=self.record(), level=level, weights=weights
            )
        return weights

    def _blank(self) -> Marks:
        device, count = self.device, self.count
        return Marks(
            marks=device.zeros(count, np.uint32),
            allowed=device.empty(count, np.float32).fill(np.nan),
            costs=device.empty(count, np.float32),
            leaf_of=device.empty(count, np.int32),
        )

    def _look_at(self, analysis: DeviceAnalysis, changed: npt.NDArray[np.int32]) -> None:
        """Find drifts, ranges and holes of all nodes, where only some tiles have changed."""
        tiles = analysis.details.host().reshape(-1, 4)
        tiles[:, 0] = 0.0
        self.details.write(tiles)
        finer = lattice_levels(self.ground.grid.tile)
        for level, (rows, columns) in list(enumerate(self.shapes))[1:]:
            drifts = self.drifts[level - finer - 1] if level > finer else self.details
            if level > finer:
                # a point of the lattice is known to tiles as far as the next ones
                touched = self._around(changed, 1 << (level - finer))
                self.kernel("tree.cl", "drift")(
                    (len(touched),),
                    (self.group,),
                    **self.ground.arguments,
                    level=level,
                    count=len(touched),
                    tiles=self.device.array(touched),
                    drifts=drifts,
                )
            self.kernel("tree.cl", "gather")(
                (rows * columns,),
                (self.group,),
                grid=self.ground.grid.record(),
                tree=self.record(),
                level=level,
                drifts=drifts,
                details=self.details,
            )

    def _around(self, tiles: npt.NDArray[np.int32], samples: int) -> npt.NDArray[np.int32]:
        """Return all tiles that hold a sample so near to those of `tiles`."""
        grid = self.ground.grid
        if len(tiles) == grid.count:
            return tiles
        rows, columns = np.divmod(tiles, grid.shape[1])
        ranges = [
            slice(
                max(int(corners[numbers.min()]) - samples, 0),
                min(int(corners[numbers.max() + 1]) + samples, int(corners[-1])) + 1,
            )
            for numbers, corners in ((rows, grid.corner_rows), (columns, grid.corner_columns))
        ]
        return grid.touching(*ranges)
