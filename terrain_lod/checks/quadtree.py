"""Checks of the kernels that choose patches of every size: the tree, its joints, insides of leaves."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import numpy as np

from ..device.device import Device
from ..device.layout import VIEW
from ..reference.terrain import quadtree
from ..terrain.buffers import lattice_levels
from ..terrain.leaves import FIRST_SHARE, Leaves
from ..terrain.quadtree import DeviceQuadtree, cheapest_first
from .check import Array, Bound, Check, Difference, ulp
from .grounds import Ground, hard_grounds, plain_grounds

_METRES: Final = 3.0

_DRIFT: Final = Bound(
    "drift",
    "m",
    "16 ulp of the largest height, and 1e-6 of it above",
    "a bilinear height and a difference; what is stated is a bound, so a millionth is added",
)
_RANGES: Final = Bound("ranges and holes", "m", "exact", "they are samples, and counts of them")
_LEAVES: Final = Bound("leaves", "nodes", "exact", "a choice by measured errors")
_PLACES: Final = Bound("places", "1/65536 of a cell", "exact", "whole numbers, by one division")
_INSIDES: Final = Bound("insides", "segments", "exact", "a choice by measured errors")


def _tree(case: Ground, device: Device, levels: int | None = None) -> DeviceQuadtree:
    tiles = case.tiles(device)
    return DeviceQuadtree.of(tiles.ground, tiles.analysis, levels)


def _twin(case: Ground, tree: DeviceQuadtree) -> quadtree.Quadtree:
    return quadtree.Quadtree(case.sum, case.grid, tree.shapes, lattice_levels(case.grid.tile))


@contextmanager
def _leaves(tree: DeviceQuadtree) -> Iterator[Leaves]:
    """Yield the leaves for an error in metres, nothing culled."""
    view = np.zeros((), VIEW)
    with tree.marked() as (stamp, marks):
        yield Leaves(
            tree,
            stamp,
            marks,
            view,
            cull=False,
            metres=_METRES,
            pixels=np.inf,
            weights=tree.weights(None),
        )


def _expected(case: Ground, tree: DeviceQuadtree) -> quadtree.Leaves:
    order = cheapest_first(case.grid.tile)
    return quadtree.Leaves(_twin(case, tree), _METRES, FIRST_SHARE, order)


def _numbers(tree: DeviceQuadtree, nodes: list[quadtree.Node]) -> Array:
    return np.array(
        [
            tree.first[node.level] + node.row * tree.shapes[node.level][1] + node.column
            for node in nodes
        ],
        np.int64,
    )


def _nodes(case: Ground, device: Device) -> Iterator[Difference]:
    tree = _tree(case, device)
    twin, found = _twin(case, tree), tree.details.host()
    expected = []
    for node in twin.nodes():
        heights, known = twin.samples(node)
        drift = twin.drift(node) if twin.stride(node) > 1 else 0.0
        low, high = (heights[known].min(), heights[known].max()) if known.any() else [np.nan] * 2
        expected.append((drift, low, high))
    drifts, low, high = np.array(expected).T
    whole = found[:, 3] == 0
    highest = np.abs(np.nan_to_num(high)).max() + np.ptp(np.nan_to_num(high))
    allowed = 16 * ulp(case.highest) + 2e-6 * max(case.highest, highest)
    yield _DRIFT.met_by(found[whole, 0], drifts[whole], allowed)
    yield _RANGES.met_by(found[:, 1], low)
    yield _RANGES.met_by(found[:, 2], high)
    with _leaves(tree) as leaves:
        chosen = np.sort(leaves.nodes)
    yield _LEAVES.met_by(chosen, np.sort(_numbers(tree, _expected(case, tree).nodes)))


def _joints(case: Ground, device: Device) -> Iterator[Difference]:
    tree = _tree(case, device, levels=3)
    expected = _expected(case, tree)
    with _leaves(tree) as leaves:
        order = np.argsort(leaves.nodes, kind="stable")
        offsets, places = leaves.sides.offsets.host(), leaves.sides.places.host()
    by_number = sorted(zip(_numbers(tree, expected.nodes), expected.nodes, strict=True))
    found = [places[offsets[4 * leaf] : offsets[4 * leaf + 4]] for leaf in order]
    wanted = [side for _, leaf in by_number for side in expected.sides(leaf)]
    yield _PLACES.met_by(_joined(found), _joined(wanted))


def _insides(case: Ground, device: Device) -> Iterator[Difference]:
    # leaves whose samples are all looked at
    tree = _tree(case, device, levels=1 + lattice_levels(case.grid.tile))
    expected = _expected(case, tree)
    with _leaves(tree) as leaves:
        order = np.argsort(leaves.nodes, kind="stable")
        leaves.choose()
        found = leaves.factors.inside.host()[order]
    by_number = sorted(zip(_numbers(tree, expected.nodes), expected.nodes, strict=True))
    insides = [expected.inside(leaf) for _, leaf in by_number]
    # those that nothing holds for are split
    held = np.array([inside is not None for inside in insides], bool)
    wanted = [inside for inside in insides if inside is not None]
    yield _INSIDES.met_by(found[held], np.array(wanted).reshape(-1, 2))


def _joined(parts: list[Array]) -> Array:
    return np.concatenate(parts) if parts else np.zeros(0)


def _chosen_alike() -> dict[str, Ground]:
    """Return hard grounds whose errors are no ties: float32 and float64 choose alike."""
    ties = ("end of float32", "denormals", "1,000 km", "checkerboard", "plane of slope 1000")
    return {
        name: ground
        for name, ground in hard_grounds().items()
        if not any(tie in name for tie in ties)
    }


TREE: Final = Check(_nodes, plain_grounds, _chosen_alike)
JOINTS: Final = Check(_joints, plain_grounds, _chosen_alike)
LEAF_FIT: Final = Check(_insides, plain_grounds, _chosen_alike)
