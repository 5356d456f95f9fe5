"""The prefix sums that lay patches one after the other."""

import numpy as np
import pytest

from terrain_lod.device.device import Device
from terrain_lod.device.scan import exclusive_scan, exclusive_scans
from terrain_lod.reference.device import scan


def test_total_is_counted_in_64_bits():
    counts = np.full(5000, 2**31, np.uint32)
    assert exclusive_scan(Device.open().array(counts))[1] == 5000 * 2**31


# none, one work-group's worth, and many blocks with a last one that is not full
@pytest.mark.parametrize("count", [0, 1, 5000, 20001])
def test_two_arrays_side_by_side_are_each_scanned_as_alone(count):
    device, rng = Device.open(), np.random.default_rng(count)
    counts = rng.integers(0, 1000, (2, count)).astype(np.uint32)
    with device.timed() as timeline:
        found = exclusive_scans(*map(device.array, counts))
    assert timeline.launches == (1 if 0 < count <= 16384 else 3 if count else 1)
    for own, (offsets, total) in zip(counts, found, strict=True):
        expected = scan.exclusive_scan(own)
        np.testing.assert_array_equal(offsets.host(), expected)
        assert total == expected[-1]
