"""Every case of the conformance table, on the device."""

from pathlib import Path

import numpy as np
import pytest

from terrain_lod.device import Device
from terrain_lod.tessellator import DOMAINS, tessellate_device

TABLE = dict(np.load(Path(__file__).parent / "data" / "tessellator.npz"))


def canonical(primitives):
    """Return primitives (M, corners, 2) as sorted rows, each rotated to its least corner."""
    packed = primitives[..., 0].astype(np.int64) << 32 | primitives[..., 1]
    turns = np.stack([np.roll(packed, turn, axis=1) for turn in range(packed.shape[1])], axis=1)
    order = np.lexsort(np.moveaxis(turns, 2, 0)[::-1], axis=-1)
    least = np.take_along_axis(turns, order[:, :1, None], axis=1)[:, 0]
    return least[np.lexsort(least.T[::-1])]


@pytest.mark.parametrize("partitioning", ["fractional_odd", "fractional_even", "integer"])
@pytest.mark.parametrize("domain", DOMAINS)
def test_table(domain, partitioning):
    cases = np.flatnonzero((TABLE["domain"] == domain) & (TABLE["partitioning"] == partitioning))
    edges, insides, corners = DOMAINS[domain]
    device = Device.open()
    pattern = tessellate_device(
        domain,
        device.array(TABLE["edge_factors"][cases, :edges]),
        device.array(TABLE["inside_factors"][cases, :insides]) if insides else None,
        partitioning,
        clockwise=False,  # OpenGL's clockwise, whose v points up
    )
    points, primitives = pattern.points.host(), pattern.primitives.host()
    point_offsets = pattern.point_offsets.host()
    offsets = pattern.primitive_offsets.host()
    assert len(cases)
    for number, case in enumerate(cases):
        begin, end = TABLE["point_offsets"][case : case + 2]
        expected = TABLE["points_16_16"][begin:end]
        own = points[point_offsets[number] : point_offsets[number + 1]]
        np.testing.assert_array_equal(np.unique(own, axis=0), np.unique(expected, axis=0))
        emitted = points[primitives[offsets[number] : offsets[number + 1]]]
        np.testing.assert_array_equal(
            canonical(emitted), canonical(expected.reshape(-1, corners, 2)), f"case {case}"
        )
