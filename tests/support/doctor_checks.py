"""Checks that fail in every way a driver can, for tests of the doctor."""

from __future__ import annotations

import ctypes
import math
import os
from collections.abc import Callable, Iterable

from terrain_lod.checks.check import Bound, Check, Difference
from terrain_lod.device.device import Device

HEIGHT = Bound("height", "m", "1 m", "for tests")


def check_of(compare: Callable[[object, Device], Iterable[Difference]]) -> Check:
    """Return a check of one case."""
    return Check(compare, lambda: {"the case": None})


def _differs(error: float, allowed: float) -> Check:
    return check_of(lambda case, device: [Difference(HEIGHT, error, allowed)])


def _raises(case: object, device: Device) -> Iterable[Difference]:
    raise RuntimeError("the first line\nthe second")


def _noisy(case: object, device: Device) -> Iterable[Difference]:
    os.write(1, b'warning: {"a": 1}\n17\n')  # as drivers write, past Python
    return [Difference(HEIGHT, 0.0, 0.0)]


def _aborts(case: object, device: Device) -> Iterable[Difference]:
    os.abort()


def _reads_nowhere(case: object, device: Device) -> Iterable[Difference]:
    ctypes.string_at(0)
    raise AssertionError


def _exits(case: object, device: Device) -> Iterable[Difference]:
    os._exit(3)


CHECKS = {
    "sound": _differs(0.5, 1.0),
    "wrong": _differs(2.0, 1.0),
    "unknown": _differs(math.nan, 1.0),
    "raises": check_of(_raises),
    "noisy": check_of(_noisy),
    "aborts": check_of(_aborts),
    "reads_nowhere": check_of(_reads_nowhere),
    "exits": check_of(_exits),
}
