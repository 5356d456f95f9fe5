"""How the benchmarks measure: device time, medians, and ratios within one run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from statistics import median

import numpy as np

from terrain_lod.device.device import Device, DeviceArray


def device_seconds(device: Device, work: Callable[[], object]) -> float:
    """Return the device time of everything that `work` launches."""
    with device.timed() as timeline:
        work()
        return sum(timeline.seconds.values())


def interleaved(
    device: Device, works: Mapping[str, Callable[[], object]], repeats: int = 15
) -> dict[str, list[float]]:
    """Return the device times of each of `works`, run in turn so that noise meets all alike."""
    times: dict[str, list[float]] = {name: [] for name in works}
    for work in works.values():  # the first call builds kernels
        work()
    for _ in range(repeats):
        for name, work in works.items():
            times[name].append(device_seconds(device, work))
    return times


def ratio(times: Mapping[str, list[float]], name: str, to: str) -> float:
    """Return the median over the rounds of one work's time to another's."""
    return median(a / b for a, b in zip(times[name], times[to], strict=True))


def bare_read(device: Device, values: DeviceArray) -> Callable[[], object]:
    """Return work that reads every float of `values` once."""
    group = device.group_size(256)
    groups = 4096 if device.is_gpu else 256
    kernel = device.kernel("common/bandwidth.cl", "read_floats", GROUP=group)
    sums = device.empty(groups * group, np.float32)
    return lambda: kernel((groups * group,), (group,), values=values, count=values.size, sums=sums)


def bare_copy(device: Device, nbytes: int) -> Callable[[], object]:
    """Return work that writes `nbytes` bytes, copied from as many others."""
    group = device.group_size(256)
    groups = 4096 if device.is_gpu else 256
    kernel = device.kernel("common/bandwidth.cl", "copy_words", GROUP=group)
    source, target = (device.zeros(nbytes // 4, np.uint32) for _ in range(2))
    return lambda: kernel(
        (groups * group,), (group,), source=source, count=source.size, target=target
    )
