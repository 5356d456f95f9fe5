"""The tessellator against others: a table of 540 cases, and the reference tessellator itself.

Vertices must agree to the bit; triangles up to their order and their first corner.
"""

import os
from pathlib import Path

import numpy as np
import pytest

from support import oracle
from support.oracle_cases import GOLDEN, canonical, digests, factor_sets
from terrain_lod.tessellation.tessellator import tessellate

TABLE = dict(np.load(Path(__file__).parents[1] / "support" / "data" / "tessellator.npz"))
REQUIRED = "TERRAIN_LOD_LIVE_ORACLE"  # where this variable is set, a missing oracle is a failure

every_partitioning = pytest.mark.parametrize("partitioning", oracle.SPACINGS)
every_domain = pytest.mark.parametrize("domain", oracle.DOMAINS)


def primitives_of(domain, partitioning, edges, insides):
    """Return what :func:`oracle.tessellate` does, of our own making, and the pattern."""
    pattern = tessellate(
        domain, edges, insides, partitioning=partitioning, topology="counter_clockwise"
    )
    patches = np.repeat(np.arange(pattern.patch_count), np.diff(pattern.primitive_offsets))
    return pattern.points[pattern.primitives], patches, pattern


@every_partitioning
@every_domain
def test_table(domain, partitioning):
    cases = np.flatnonzero((TABLE["domain"] == domain) & (TABLE["partitioning"] == partitioning))
    assert len(cases) == 60
    edges, insides = TABLE["edge_factors"][cases], TABLE["inside_factors"][cases]
    edges, insides = edges[:, ~np.isnan(edges).all(0)], insides[:, ~np.isnan(insides).all(0)]
    made, patches, pattern = primitives_of(
        domain, partitioning, edges, insides if insides.size else None
    )
    begins, ends = TABLE["point_offsets"][cases], TABLE["point_offsets"][cases + 1]
    expected = [TABLE["points_16_16"][begin:end] for begin, end in zip(begins, ends, strict=True)]
    corners = made.shape[1]
    expected_patches = np.repeat(np.arange(len(cases)), (ends - begins) // corners)
    np.testing.assert_array_equal(
        canonical(made, patches),
        canonical(np.concatenate(expected).reshape(-1, corners, 2), expected_patches),
    )
    # no point but those of the primitives
    assert len(np.unique(pattern.primitives)) == len(pattern.points)


@pytest.mark.slow
@every_partitioning
@every_domain
def test_live_oracle(domain, partitioning):
    if problem := oracle.problem():
        refuse = pytest.fail if os.environ.get(REQUIRED) else pytest.skip
        refuse(f"{problem}; only its golden answers were compared")
    edges, insides = factor_sets(domain)
    expected = canonical(*oracle.tessellate(domain, partitioning, edges, insides))
    made, patches, _ = primitives_of(domain, partitioning, edges, insides)
    np.testing.assert_array_equal(canonical(made, patches), expected)


@pytest.mark.slow
@every_partitioning
@every_domain
def test_golden_answers_of_the_oracle(domain, partitioning):
    edges, insides = factor_sets(domain)
    made, patches, _ = primitives_of(domain, partitioning, edges, insides)
    with np.load(GOLDEN) as golden:
        expected = golden[f"{domain} {partitioning}"]
    wrong = np.flatnonzero(digests(canonical(made, patches), len(edges)) != expected)
    if len(wrong):
        inside = () if insides is None else insides[wrong[0]]
        pytest.fail(f"{len(wrong)} of {len(edges)} differ, first {edges[wrong[0]]}, {inside}")
