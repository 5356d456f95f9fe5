"""Factor sets to compare tessellators at, and the one form in which their primitives compare.

python oracle_cases.py        asks the live oracle and writes data/tessellator_golden.npz
"""

from __future__ import annotations

import hashlib
import random
from itertools import pairwise
from pathlib import Path

import numpy as np

from support import oracle

GOLDEN = Path(__file__).parent / "data" / "tessellator_golden.npz"

RANDOM_SETS = 1000
WHOLE = (1, 2, 3, 4, 5, 6, 7, 8, 9, 15, 16, 17, 31, 32, 33, 47, 48, 61, 62, 63, 64)
BESIDE = (-(2.0**-16), -(2.0**-17), -1e-7, 0.0, 1e-7, 2.0**-17, 2.0**-16)
SPECIAL = (0.0, -1.0, float("nan"), float("inf"), float("-inf"), 1e30, 1e-7, 0.5, 65.0, 100.0)
AWKWARD = [whole + beside for whole in WHOLE for beside in BESIDE] + list(SPECIAL)


def factor_sets(domain: str):
    """Return edge and inside factors: RANDOM_SETS random ones, then every awkward one, the same
    everywhere: once in all places, once in each place among random ones.
    """
    edges, insides = {"quad": (4, 2), "triangle": (3, 1), "isoline": (2, 0)}[domain]
    width = edges + insides
    chance = random.Random(f"{domain} factors")  # the same in every Python and on every machine

    def factor(most: float) -> float:
        return 0.5 + (most - 0.5) * chance.random() ** 3  # small ones more often

    sets = [[factor(66.0) for _ in range(width)] for _ in range(RANDOM_SETS)]
    for value in AWKWARD:
        sets.append([value] * width)
        for place in range(width):
            sets.append([value if i == place else factor(12.0) for i in range(width)])
    factors = np.array(sets, np.float32)
    return factors[:, :edges], factors[:, edges:] if insides else None


def canonical(primitives, patches):
    """Return rows (patch, corner, ...) in one order, each turned to begin with its least corner.

    `primitives` is (M, corners, 2) in 16.16, `patches` (M,).
    """
    corners = primitives[..., 0].astype(np.int64) << 17 | primitives[..., 1]
    least = corners
    for turn in range(1, corners.shape[1]):
        turned = np.roll(corners, turn, axis=1)
        # degenerate triangles have the least corner twice: go on to the first that differs
        first = np.argmax(turned != least, axis=1)[:, None]
        before = np.take_along_axis(turned, first, 1) < np.take_along_axis(least, first, 1)
        least = np.where(before, turned, least)
    rows = np.column_stack([patches, least])
    return rows[np.lexsort(rows.T[::-1])]


def digests(rows, patch_count: int):
    """Return a 64-bit digest of each patch's canonical rows; (P,) uint64."""

    def digest(patch_rows) -> int:
        data = np.ascontiguousarray(patch_rows[:, 1:], "<i8").tobytes()
        return int.from_bytes(hashlib.blake2b(data, digest_size=8).digest(), "little")

    starts = np.searchsorted(rows[:, 0], np.arange(patch_count + 1))
    return np.array([digest(rows[begin:end]) for begin, end in pairwise(starts)], np.uint64)


def write_golden() -> None:
    """Ask the live oracle about every factor set and keep digests of its answers."""
    golden = {}
    for domain in oracle.DOMAINS:
        edges, insides = factor_sets(domain)
        for partitioning in oracle.SPACINGS:
            rows = canonical(*oracle.tessellate(domain, partitioning, edges, insides))
            golden[f"{domain} {partitioning}"] = digests(rows, len(edges))
    np.savez_compressed(GOLDEN, **golden)


if __name__ == "__main__":
    write_golden()
