"""How the benchmarks measure: device time, medians, and ratios within one run."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from statistics import median
from time import perf_counter
from typing import Final

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
    """Return work that reads every float of `values` once, as fast as the device can."""
    group, items = _work(device)
    kernel = device.kernel("common/bandwidth.cl", "read_floats", GROUP=group)
    sums = device.empty(items, np.float32)
    return lambda: kernel((items,), (group,), values=values, count=values.size, sums=sums)


def bare_copy(device: Device, nbytes: int, *, anew: bool = False) -> Callable[[], object]:
    """Return work that writes `nbytes` bytes, copied from as many others.

    With `anew` they go to where nothing was before.
    """
    group, items = _work(device)
    kernel = device.kernel("common/bandwidth.cl", "copy_words", GROUP=group)
    words = -(-nbytes // 64) * 16
    source = device.zeros(words, np.uint32)
    kept = None if anew else device.zeros(words, np.uint32)
    return lambda: kernel(
        (items,),
        (group,),
        source=source,
        count=words,
        target=device.empty(words, np.uint32) if kept is None else kept,
    )


def _work(device: Device) -> tuple[int, int]:
    group = device.group_size(256)
    return group, (4096 if device.is_gpu else 256) * group


# what makers state, in GB/s, by a part of the device's name
_STATED: Final = {"H200": 4800, "H100 80GB HBM3": 3350, "A100-SXM4-80GB": 2039}


def share_of_stated(device: Device, bytes_per_second: float) -> str:
    """Return which share of the bandwidth that the device's maker states this is."""
    for name, stated in _STATED.items():
        if name in device.info.name:
            return f"{bytes_per_second / stated / 1e7:.0f} % of the {stated:,} GB/s stated"
    return "no bandwidth stated"


def wall_seconds(device: Device, work: Callable[[], object], repeats: int = 15) -> float:
    """Return the median time from a call until all that it launched has ended."""
    seconds = []
    for _ in range(repeats):
        device.finish()
        start = perf_counter()
        work()
        device.finish()
        seconds.append(perf_counter() - start)
    return median(seconds)
