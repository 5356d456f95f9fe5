"""Checks of the tessellator, of the sums it needs, and of the benchmarks' yardsticks."""

from __future__ import annotations

import numpy as np

from ..device.device import Device
from ..device.layout import PARTITIONINGS
from ..device.scan import exclusive_scan
from ..reference.device import scan
from ..reference.tessellation import tessellator
from ..tessellation.factors import DOMAINS
from ..tessellation.tessellator import tessellate
from .checkup import Check, unequal_rows


def check_scan(device: Device) -> Check:
    counts = np.random.default_rng(2).integers(0, 1000, 20_001).astype(np.uint32)
    offsets, total = exclusive_scan(device.array(counts))
    expected = scan.exclusive_scan(counts)
    wrong = unequal_rows(offsets.host(), expected) + (total != expected[-1])
    return Check(wrong, 0.0, "offsets")


def check_tessellator(device: Device) -> Check:
    random, wrong = np.random.default_rng(5), 0.0
    for name, shape in DOMAINS.items():
        for partitioning in PARTITIONINGS:
            edges = random.uniform(0.5, 20, (12, shape.edges))
            insides = random.uniform(0.5, 20, (12, shape.insides)) if shape.insides else None
            found = tessellate(name, edges, insides, partitioning=partitioning, device=device)
            expected = tessellator.tessellate(name, edges, insides, partitioning=partitioning)
            wrong += unequal_rows(found.points, expected.points)
            wrong += unequal_rows(
                *(tessellator.sorted_primitives(one.primitives) for one in (found, expected))
            )
    return Check(wrong, 0.0, "rows")


def check_bandwidth(device: Device) -> Check:
    words = np.random.default_rng(6).integers(0, 1000, 4096).astype(np.uint32)
    group, floats = device.group_size(), device.array(words.astype(np.float32))
    sums, target = device.zeros(group, np.float32), device.zeros(words.size, np.uint32)
    read, copy = (
        device.kernel("common/bandwidth.cl", name, GROUP=group)
        for name in ("read_floats", "copy_words")
    )
    read((group,), (group,), values=floats, count=words.size, sums=sums)
    copy((group,), (group,), source=device.array(words), count=words.size, target=target)
    # sums of whole numbers are exact
    wrong = unequal_rows(target.host(), words) + (sums.host().sum() != words.sum())
    return Check(float(wrong), 0.0, "words")
