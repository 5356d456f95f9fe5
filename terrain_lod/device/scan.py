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
    return _scans(counts)[0]


def exclusive_scans(
    counts: DeviceArray, others: DeviceArray
) -> tuple[tuple[DeviceArray, int], tuple[DeviceArray, int]]:
    """Return the same of two arrays of one length, in as many launches and waits as of one."""
    one, other = _scans(counts, others)
    return one, other


def _scans(*arrays: DeviceArray) -> list[tuple[DeviceArray, int]]:
    """Return offsets and total of one array, or of each of two."""
    rows, counts, others = len(arrays), arrays[0], arrays[-1]
    device, count = counts.device, counts.size
    group = device.group_size(_GROUP)
    blocks = -(-count // _BLOCK)
    # with no count at all, zero is the only offset
    empty = device.zeros if count == 0 else device.empty
    offsets = [empty(count + 1, "uint32") for _ in arrays]
    scan_one, block_sums, scan_sums, scan_blocks = (
        device.kernel("common/scan.cl", name, BLOCK=_BLOCK, GROUP=group)
        for name in ("scan_one", "block_sums", "scan_sums", "scan_blocks")
    )
    given = {"count": count, "counts": counts, "others": others}
    found = {"offsets": offsets[0], "other_offsets": offsets[-1]}
    if 0 < count <= _SHORT:
        totals = device.empty(rows, "uint64")
        scan_one((group, rows), (group, 1), **given, totals=totals, **found)
        return list(zip(offsets, totals.host().tolist(), strict=True))
    items = (blocks * group, rows)
    sums = device.zeros((rows, blocks + 1), "uint64")
    block_sums(items, (group, 1), **given, sums=sums)
    scan_sums((group, rows), (group, 1), blocks=blocks, sums=sums)
    scan_blocks(items, (group, 1), **given, sums=sums, **found)
    return list(zip(offsets, sums.host()[:, -1].tolist(), strict=True))
