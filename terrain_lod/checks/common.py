"""Checks of the kernels that every room uses: prefix sums, and the benchmarks' yardsticks."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from ..device.device import Device
from ..device.scan import exclusive_scan
from ..reference.device import scan
from .check import Bound, Check, Difference

_SUMS: Final = Bound("prefix sums", "sums", "exact", "whole numbers")


def _scan(count: int, device: Device) -> Iterator[Difference]:
    counts = np.random.default_rng(count).integers(0, 9000, count).astype(np.uint32)
    offsets, total = exclusive_scan(device.array(counts))
    expected = scan.exclusive_scan(counts)
    yield _SUMS.met_by_rows(offsets.host(), expected)
    yield _SUMS.met_by(total, expected[-1])


def _counts(*counts: int) -> dict[str, int]:
    return {f"{count} counts": count for count in counts}


SCAN: Final = Check(
    _scan,
    lambda: _counts(20_001),
    # on both sides of what one group sums
    lambda: _counts(0, 1, 2, 255, 4095, 4096, 4097, 8192, 100_003),
)

_WORDS: Final = Bound(
    "words read and copied", "words", "exact", "sums of whole numbers below 2^24 are exact"
)


def _bandwidth(count: int, device: Device) -> Iterator[Difference]:
    words = np.random.default_rng(6).integers(0, 1000, count).astype(np.uint32)
    group, floats = device.group_size(), device.array(words.astype(np.float32))
    sums, target = device.zeros(group, np.float32), device.zeros(words.size, np.uint32)
    read, copy = (
        device.kernel("common/bandwidth.cl", name, GROUP=group)
        for name in ("read_floats", "copy_words")
    )
    read((group,), (group,), values=floats, count=words.size, sums=sums)
    copy((group,), (group,), source=device.array(words), count=words.size, target=target)
    yield _WORDS.met_by_rows(target.host(), words)
    yield _WORDS.met_by(sums.host().sum(), words.sum())


BANDWIDTH: Final = Check(_bandwidth, lambda: {"4096 words": 4096})
