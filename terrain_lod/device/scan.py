"""Exclusive prefix sums on the device: from how many to where."""

from __future__ import annotations

from typing import Final

from .device import DeviceArray

_BLOCK: Final = 4096  # counts that a work-group adds up
_GROUP: Final = 256  # its work-items, on a GPU
_SHORT: Final = 4 * _BLOCK  # so few are added up by one work-group, in one launch


def exclusive_scan(counts: DeviceArray) -> tuple[DeviceArray, int]:
    """Return where each of `counts` begins when they are laid one after the other.

    Parameters
    ----------
    counts : DeviceArray, (n,) uint32

    Returns
    -------
    offsets : DeviceArray, (n + 1,) uint32
        ``offsets[i]`` is the sum of the counts before ``i``; the last is the total.
    total : int
        Summed in 64 bits: where it is 2³² or more, `offsets` have wrapped and mean nothing, so
        compare it with what may be allocated before anything else.
    """
    device, count = counts.device, counts.size
    group = device.group_size(_GROUP)
    if 0 < count <= _SHORT:
        offsets, total = device.empty(count + 1, "uint32"), device.empty(1, "uint64")
        scan_one = device.kernel("common/scan.cl", "scan_one", BLOCK=_BLOCK, GROUP=group)
        scan_one((group,), (group,), count=count, counts=counts, total=total, offsets=offsets)
        return offsets, int(total.host()[0])
    blocks = -(-count // _BLOCK)
    items = blocks * group
    # with no block at all, zero is the only offset
    sums = device.zeros(blocks + 1, "uint64")
    offsets = device.zeros(1, "uint32") if count == 0 else device.empty(count + 1, "uint32")
    block_sums, scan_sums, scan_blocks = (
        device.kernel("common/scan.cl", name, BLOCK=_BLOCK, GROUP=group)
        for name in ("block_sums", "scan_sums", "scan_blocks")
    )
    block_sums((items,), (group,), count=count, counts=counts, sums=sums)
    scan_sums((group,), (group,), blocks=blocks, sums=sums)
    scan_blocks((items,), (group,), count=count, counts=counts, sums=sums, offsets=offsets)
    return offsets, int(sums.host()[-1])
