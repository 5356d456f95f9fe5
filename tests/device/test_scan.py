"""The prefix sum that lays patches one after the other."""

import numpy as np

from terrain_lod.device.device import Device
from terrain_lod.device.scan import exclusive_scan


def test_total_is_counted_in_64_bits():
    counts = np.full(5000, 2**31, np.uint32)
    assert exclusive_scan(Device.open().array(counts))[1] == 5000 * 2**31
