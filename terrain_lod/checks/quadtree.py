"""Checks of the kernels that choose patches of every size."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Final

import numpy as np

from ..device.device import Device
from ..device.layout import VIEW
from ..ground.heightmap import Heightmap
from ..reference.terrain import quadtree
from ..terrain.buffers import lattice_levels
from ..terrain.choice import FIRST_SHARE, Allowance
from ..terrain.fitted import LEAST_STEP, MOST_STEP, ask_for_less, rooms_of
from ..terrain.leaves import Leaves
from ..terrain.quadtree import DeviceQuadtree, cheapest_first
from .check import Array, Bound, Check, Difference, ulp
from .grounds import Ground

_METRES: Final = 3.0
_STEP: Final = 30.0

_DRIFT: Final = Bound(
    "drift",
    "m",
    "16 ulp of the largest height, and 1e-6 of it above",
    "a bilinear height and a difference; what is stated is a bound, so a millionth is added",
)
_RANGES: Final = Bound("ranges and holes", "m", "exact", "they are samples, and counts of them")
_LEAVES: Final = Bound("leaves", "nodes", "exact", "a choice by measured errors")
_AREAS: Final = Bound("areas of leaves", "cells", "exact", "they are whole numbers")
_PLACES: Final = Bound("places", "1/65536 of a cell", "exact", "whole numbers, by one division")
_ROOMS: Final = Bound(
    "errors of leaves", "m", "4 ulp", "what is asked for, less a millionth of the range of heights"
)
_WEIGHTS: Final = Bound(
    "weights of tiles", "1", "4 ulp", "a square root of a quotient, and the largest of some"
)
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
        yield Leaves(tree, stamp, marks, Allowance(view, cull=False, metres=_METRES, pixels=np.inf))


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


def _chosen(case: Ground, device: Device) -> Iterator[Difference]:
    for levels in (None, 1, 5):
        tree = _tree(case, device, levels)
        with _leaves(tree) as leaves:
            chosen = np.sort(leaves.nodes)
        yield _LEAVES.met_by(chosen, np.sort(_numbers(tree, _expected(case, tree).nodes)))


def _described(case: Ground, device: Device) -> Iterator[Difference]:
    tree = _tree(case, device)
    twin = _twin(case, tree)
    expected = _expected(case, tree).nodes
    with _leaves(tree) as leaves:
        order = np.argsort(leaves.nodes, kind="stable")
        drawn = leaves.drawn()
    by_number = sorted(zip(_numbers(tree, expected), expected, strict=True))
    areas = [
        (top, left, down, across)
        for top, left, down, across in (twin.area(leaf) for _, leaf in by_number)
    ]
    yield _AREAS.met_by(drawn.areas[order], np.array(areas).reshape(-1, 4))


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


def _asked(case: Ground, device: Device) -> Iterator[Difference]:
    tree = _tree(case, device)
    twin, shape = _twin(case, tree), case.grid.shape
    view, random = np.zeros((), VIEW), np.random.default_rng(4)
    allowance = Allowance(view, cull=False, metres=_METRES, pixels=np.inf)
    with _leaves(tree) as leaves:
        nodes = list(twin.nodes())
        numbered = dict(zip(_numbers(tree, nodes).tolist(), nodes, strict=True))
        drawn = [numbered[number] for number in leaves.nodes.tolist()]
    allowed, shown = rooms_of(leaves, allowance)
    ranges = [np.ptp(heights[known]) for heights, known in map(twin.samples, drawn)]
    expected = np.maximum(_METRES - 1e-6 * np.array(ranges), 0)
    yield _ROOMS.met_by(allowed.host(), expected, 4 * ulp(_METRES))
    yield _ROOMS.met_by(shown.host(), np.ones(len(drawn)), 0.0)
    for reach in (0, 1):
        measured = (allowed.host() * random.uniform(0.5, 6, len(drawn))).astype(np.float32)
        weights = device.empty(case.grid.count, np.float32).fill(2.0)
        exceeding = ask_for_less(leaves, allowed, device.array(measured), weights, reach)
        steps = np.ones(shape)
        excess = np.divide(measured, allowed.host(), dtype=np.float64)
        for node, times in zip(drawn, excess, strict=True):
            if times > 1:
                rows, columns = (
                    slice(
                        max((place << node.level) - reach, 0), ((place + 1) << node.level) + reach
                    )
                    for place in (node.row, node.column)
                )
                step = np.clip(np.sqrt(times), LEAST_STEP, MOST_STEP)
                steps[rows, columns] = np.maximum(steps[rows, columns], step)
        yield _WEIGHTS.met_by(weights.host().reshape(shape), 2 * steps, 4 * ulp(2 * steps))
        yield _WEIGHTS.met_by(exceeding, np.count_nonzero(excess > 1), 0.0)


def _joined(parts: list[Array]) -> Array:
    return np.concatenate(parts) if parts else np.zeros(0)


@cache
def _plain() -> dict[str, Ground]:
    """Return ordinary ground of some dozen small tiles: references of all pairs take their time."""
    fine = Heightmap(np.random.default_rng(2).normal(size=(5, 7)), spacing=(10.0, 10.0))
    return {
        "rough": Ground(_rough(31, 26), tile=5),
        "with holes": Ground(_rough(31, 26, holed=True), tile=5),
        "with holes and detail": Ground(_rough(9, 10, holed=True), detail=fine, tile=5),
    }


@cache
def _hard() -> dict[str, Ground]:
    """Return hard grounds whose errors are no ties: float32 and float64 choose alike."""
    row, column = np.mgrid[:22, :27].astype(np.float64)
    rough = np.random.default_rng(5).normal(size=row.shape).cumsum(axis=0).cumsum(axis=1)
    heights = {
        "constant, 8,848 m": np.full(row.shape, 8848.0),
        "one spike": np.where((row == 10) & (column == 11), 1e4, 0.0),
        "cliff of one cell": np.where(column > 11, 500.0, 0.0),
        "hole of one sample": np.where((row == 10) & (column == 11), np.nan, rough),
        "hole of a tile": np.where((row <= 5) & (column <= 5), np.nan, rough),
        "all but one sample missing": np.where((row == 7) & (column == 8), 5.0, np.nan),
        "2 × 2 samples": rough[:2, :2],
        "2 samples wide": rough[:, :2],
        "one sample more than a node": rough[:12, :12],
    }
    made = {name: Ground(Heightmap(each, spacing=_STEP), tile=5) for name, each in heights.items()}
    made["spacing 1 : 1000"] = Ground(Heightmap(rough, spacing=(1.0, 1000.0)), tile=5)
    return made | {
        f"tiles of {tile} cells": Ground(_rough(4 * tile + 2, 3 * tile + 3), tile=tile)
        for tile in (1, 3, 4, 8)
    }


def _rough(rows: int, columns: int, *, holed: bool = False) -> Heightmap:
    random = np.random.default_rng(1)
    heights = random.normal(size=(rows, columns)).cumsum(axis=0).cumsum(axis=1)
    if holed:
        heights[random.random(heights.shape) < 0.01] = np.nan
        heights[: rows // 4, : columns // 3] = np.nan
    return Heightmap(heights, spacing=_STEP, origin=(500_000.0, 4_000_000.0))


TREE: Final = Check(_nodes, _plain, _hard)
CHOICE: Final = Check(_chosen, _plain, _hard)
LEAVES: Final = Check(_described, _plain, _hard)
JOINTS: Final = Check(_joints, _plain, _hard)
LEAF_FIT: Final = Check(_insides, _plain, _hard)
FITTED: Final = Check(_asked, _plain, _hard)
