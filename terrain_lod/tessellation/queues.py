"""Queues of patches that are treated alike, built on the device."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..device.device import DeviceArray
from ..device.scan import exclusive_scan


@dataclass(frozen=True, eq=False)
class Queues:
    """Patches by queue.

    Attributes
    ----------
    members : DeviceArray, (P,) uint32
        Patches of queue 0, then of queue 1, ...; ascending in each. What is left over where
        patches are in no queue means nothing.
    begins : (Q + 1,) int64
        Where each queue begins among the members; the last is where all end.
    """

    members: DeviceArray
    begins: npt.NDArray[np.int64]


def queues_of(keys: DeviceArray, count: int) -> Queues:
    """Return `count` queues, of the patches whose key is 0, 1, ...

    Parameters
    ----------
    keys : DeviceArray, (P,) int32
        Queue of each patch, below `count`; below 0 where it is in none.
    count : int

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold 8 bytes a patch and queue.
    """
    device, patches = keys.device, keys.size
    cells = count * patches
    device.require(f"{count} queues of {patches} patches", 4 * cells, 4 * cells, 4 * patches)
    flags = device.empty(cells, np.uint32)
    group = (device.group_size(),)
    device.kernel("tessellation/queues.cl", "queue_flags")(
        (patches,), group, patches=patches, queues=count, keys=keys, flags=flags
    )
    offsets, _ = exclusive_scan(flags)
    members = device.empty(patches, np.uint32)
    begins = device.empty(count + 1, np.uint32)
    device.kernel("tessellation/queues.cl", "queue_fill")(
        (max(patches, count + 1),),
        group,
        patches=patches,
        queues=count,
        keys=keys,
        offsets=offsets,
        members=members,
        begins=begins,
    )
    return Queues(members, begins.host().astype(np.int64))
