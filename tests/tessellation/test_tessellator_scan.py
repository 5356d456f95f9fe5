"""The prefix sum that lays patches one after the other."""

import numpy as np
import pytest

from terrain_lod.device.device import Device
from terrain_lod.device.scan import exclusive_scan
from terrain_lod.reference.device import scan as reference


@pytest.mark.parametrize("count", [0, 1, 2, 255, 4095, 4096, 4097, 8192, 100_003])
def test_offsets_and_total_are_the_sums(count):
    counts = np.random.default_rng(count).integers(0, 9000, count).astype(np.uint32)
    offsets, total = exclusive_scan(Device.open().array(counts))
    expected = reference.exclusive_scan(counts)
    np.testing.assert_array_equal(offsets.host(), expected)
    assert total == expected[-1]


def test_total_is_counted_in_64_bits():
    counts = np.full(5000, 2**31, np.uint32)
    assert exclusive_scan(Device.open().array(counts))[1] == 5000 * 2**31
