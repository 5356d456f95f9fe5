"""The tessellator: its counts, its rules, what it refuses, and the twin it is compared with."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from terrain_lod.device.device import Device
from terrain_lod.device.layout import FIXED_ONE, PARTITIONINGS
from terrain_lod.errors import DeviceMemoryError, InputError
from terrain_lod.reference.tessellation import tessellator as reference
from terrain_lod.tessellation.factors import DOMAINS
from terrain_lod.tessellation.tessellator import TOPOLOGIES, counts, tessellate

AWKWARD = [0.0, -1.0, np.nan, np.inf, -np.inf, 1e30, 1e-7, 0.5, 1.0, 100.0]
NEAR = [n + d for n in (1, 2, 3, 4, 15, 16, 63, 64) for d in (-(2**-16), -1e-7, 0, 1e-7, 2**-16)]

factor = st.sampled_from(AWKWARD + NEAR) | st.floats(0.5, 66, width=32)
every_kind = pytest.mark.parametrize("partitioning", PARTITIONINGS)
every_domain = pytest.mark.parametrize("domain", DOMAINS)


def uniform(domain, value):
    """Return the factors of one patch, all alike."""
    edges, insides, _ = DOMAINS[domain]
    return np.full((1, edges), value), np.full((1, insides), value) if insides else None


def random_factors(domain, patches, seed, low=0.5, high=20.0):
    rng = np.random.default_rng(seed)
    edges, insides, _ = DOMAINS[domain]
    edge_factors = rng.uniform(low, high, (patches, edges))
    return edge_factors, rng.uniform(low, high, (patches, insides)) if insides else None


# counts


@pytest.mark.parametrize(
    ("domain", "value", "partitioning", "points", "triangles"),
    [
        ("quad", 1, "fractional_odd", 4, 2),
        ("quad", 1, "integer", 4, 2),
        ("quad", 2, "fractional_even", 9, 8),
        ("quad", 64, "fractional_even", 65 * 65, 8192),
        ("quad", 64, "integer", 65 * 65, 8192),
        ("quad", 63, "fractional_odd", 64 * 64, 7938),
        ("triangle", 1, "fractional_odd", 3, 1),
        ("triangle", 5, "fractional_odd", 27, 37),
        ("triangle", 63, "fractional_odd", 3072, 5953),
        ("isoline", 5, "integer", 30, 25),
    ],
)
def test_known_counts(domain, value, partitioning, points, triangles):
    factors = uniform(domain, value)
    assert [n.item() for n in counts(domain, *factors, partitioning)] == [points, triangles]
    pattern = tessellate(domain, *factors, partitioning=partitioning)
    assert (len(pattern.points), len(pattern.primitives)) == (points, triangles)


@every_kind
@every_domain
@settings(deadline=None, max_examples=30)
@given(data=st.data())
def test_kernels_agree_with_counts_and_reference(domain, partitioning, data):
    edges, insides, _ = DOMAINS[domain]
    row = st.lists(factor, min_size=edges + insides, max_size=edges + insides)
    rows = np.array(data.draw(st.lists(row, min_size=1, max_size=4)))
    factors = rows[:, :edges], rows[:, edges:] if insides else None
    topology = data.draw(st.sampled_from(TOPOLOGIES))
    pattern = tessellate(domain, *factors, partitioning=partitioning, topology=topology)
    expected = reference.tessellate(domain, *factors, partitioning=partitioning, topology=topology)
    np.testing.assert_array_equal(pattern.points, expected.points)
    np.testing.assert_array_equal(
        reference.sorted_primitives(pattern.primitives),
        reference.sorted_primitives(expected.primitives),
    )
    points, primitives = counts(domain, *factors, partitioning)
    np.testing.assert_array_equal(np.diff(pattern.point_offsets), points)
    np.testing.assert_array_equal(np.diff(pattern.primitive_offsets), primitives)


# rules


@pytest.mark.parametrize("culling", [0.0, -1.0, -np.inf, np.nan])
@every_domain
def test_an_edge_factor_culls_its_patch_alone(domain, culling):
    edge_factors, inside_factors = random_factors(domain, 2 * DOMAINS[domain].edges, 1)
    culled = np.arange(DOMAINS[domain].edges)
    edge_factors[culled, culled] = culling
    pattern = tessellate(domain, edge_factors, inside_factors)
    sizes = np.diff(pattern.point_offsets)
    assert not sizes[culled].any()
    assert sizes[len(culled) :].all()


@every_kind
def test_an_edge_has_the_same_points_in_both_directions(partitioning):
    # the edge u = 0 of one patch and u = 1 of another run against each other
    values = np.random.default_rng(2).uniform(1, 64, 500)
    others = np.full_like(values, 3)
    left, right = (np.stack([values, others, others, others], axis=1) for _ in range(2))
    right = np.roll(right, 2, axis=1)
    insides = np.full((len(values), 2), 4)

    def along(factors, u):
        pattern = tessellate("quad", factors, insides, partitioning=partitioning)
        for begin, end in pairwise(pattern.point_offsets):
            points = pattern.points[begin:end]
            yield sorted(points[points[:, 0] == u, 1].tolist())

    for west, east in zip(along(left, 0), along(right, FIXED_ONE), strict=True):
        assert west == east
        assert west == [FIXED_ONE - v for v in reversed(west)]


@every_kind
@pytest.mark.parametrize("domain", ["quad", "triangle"])
def test_triangles_tile_the_domain(domain, partitioning):
    patches = 40
    factors = random_factors(domain, patches, 3, high=40)
    pattern = tessellate(domain, *factors, partitioning=partitioning)
    a, b, c = np.moveaxis(pattern.points.astype(np.int64)[pattern.triangles], 1, 0)
    (au, av), (bu, bv) = (b - a).T, (c - a).T
    # twice the area, positive where clockwise with v down; what folds over cancels
    areas = np.add.reduceat(au * bv - av * bu, pattern.triangle_offsets[:-1])
    assert (areas == (2 if domain == "quad" else 1) * FIXED_ONE**2).all()
    # no edge is walked twice in one direction, and Euler's count of edges holds: V + F - 1 a patch
    edges = np.concatenate([pattern.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    assert len(np.unique(edges, axis=0)) == len(edges)
    edge_count = len(np.unique(np.sort(edges, axis=1), axis=0))
    assert edge_count == len(pattern.points) + len(pattern.triangles) - patches


@every_domain
def test_topology_turns_triangles_and_leaves_the_rest(domain):
    factors = random_factors(domain, 5, 4)
    one, other = (tessellate(domain, *factors, topology=topology) for topology in TOPOLOGIES)
    np.testing.assert_array_equal(one.points, other.points)
    np.testing.assert_array_equal(one.triangles, other.triangles[:, [0, 2, 1]])
    np.testing.assert_array_equal(one.lines, other.lines)


def test_pow2_is_integer_at_the_next_power_of_two():
    edges, insides = random_factors("quad", 200, 5, high=70)
    edges[0], insides[0] = 1, 1
    insides[1] = np.nan

    def next_power(factors):
        return np.exp2(np.ceil(np.log2(np.fmin(np.fmax(factors, 1), 64))))

    pattern = tessellate("quad", edges, insides, partitioning="pow2")
    expected = tessellate("quad", next_power(edges), next_power(insides), partitioning="integer")
    np.testing.assert_array_equal(pattern.points, expected.points)
    np.testing.assert_array_equal(pattern.triangles, expected.triangles)


def test_a_tile_of_fifteen_cells_has_its_samples():
    points = tessellate("quad", *uniform("quad", 15)).points
    samples = np.arange(16) * FIXED_ONE / 15
    for axis in range(2):
        np.testing.assert_allclose(np.unique(points[:, axis]), samples, rtol=0, atol=8)


# bad input


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("hexagon", [[1] * 6]), "unknown domain 'hexagon': .* quad, triangle, isoline"),
        (
            ("quad", [[1, 2, 3]], [[1, 2]]),
            r"edge_factors of a quad of shape \(P, 4\), got \(1",
        ),
        (("quad", [1, 2, 3, 4], [[1, 2]]), r"quad of shape \(P, 4\), got \(4,\)"),
        (("quad", [[1, 2, 3, 4], [1]], [[1, 2]]), r"quad as real numbers \(P, 4\)"),
        (("quad", [[1, 2, 3, 4]]), r"inside_factors \(P, 2\) for a quad, got none"),
        (("quad", [[1, 2, 3, 4]], [[1]]), r"inside_factors of a quad of shape \(P, 2\)"),
        (("triangle", [[1, 2, 3]], [[1]] * 2), "as many patches, got 1 and 2"),
        (("isoline", [[1, 2]], [[1]]), "no inside_factors for isolines"),
        (("quad", [["a"] * 4], [[1, 2]]), r"real numbers \(P, 4\), got \[\['a'"),
        (("quad", [[None] * 4], [[1, 2]]), r"real numbers \(P, 4\), got \[\[None"),
    ],
)
def test_bad_factors_say_what_was_expected(arguments, message):
    for function in (tessellate, counts):
        with pytest.raises(InputError, match=message):
            function(*arguments)


def test_unknown_words_list_what_exists():
    with pytest.raises(InputError, match=f"'cubic'.*{', '.join(PARTITIONINGS)}"):
        tessellate("quad", *uniform("quad", 3), partitioning="cubic")
    with pytest.raises(InputError, match=r"'ccw'.*clockwise, counter_clockwise"):
        tessellate("quad", *uniform("quad", 3), topology="ccw")


@every_domain
def test_no_patches_make_an_empty_pattern(domain):
    edges, insides, corners = DOMAINS[domain]
    for nothing in ([], np.empty((0, edges))):
        pattern = tessellate(domain, nothing, np.empty((0, insides)) if insides else None)
        assert pattern.points.shape == (0, 2)
        assert pattern.primitives.shape == (0, corners)
        assert pattern.point_offsets.tolist() == [0]
        assert pattern.patch_count == 0


@pytest.mark.parametrize(
    ("patches", "error", "numbers"),
    [
        (2**31 // (3 * 8192) + 1, InputError, f"at most {2**31} indices, got {87382 * 3 * 8192}"),
        (50_000, DeviceMemoryError, f"{50_000 * 3 * 8192} indices wants .* bytes.* has .* bytes"),
    ],
)
def test_too_much_is_refused_before_it_is_allocated(patches, error, numbers):
    device = Device.open()
    if error is DeviceMemoryError and device.info.largest_buffer > 4 * 50_000 * 3 * 8192:
        pytest.skip(f"{device} has the room")
    before = device.allocated
    factors = np.full((patches, 4), 64), np.full((patches, 2), 64)
    with pytest.raises(error, match=numbers):
        tessellate("quad", *factors, partitioning="integer", device=device)
    assert device.allocated == before
