"""Checks that fail in every way a driver can, for tests of the doctor."""

from __future__ import annotations

import ctypes
import math
import os

from terrain_lod.checks.checkup import Check
from terrain_lod.device.device import Device


def _sound(device: Device) -> Check:
    return Check(0.5, 1.0, "m")


def _wrong(device: Device) -> Check:
    return Check(2.0, 1.0, "m")


def _unknown(device: Device) -> Check:
    return Check(math.nan, 1.0, "m")


def _raises(device: Device) -> Check:
    raise RuntimeError("the first line\nthe second")


def _noisy(device: Device) -> Check:
    os.write(1, b'warning: {"a": 1}\n17\n')  # as drivers write, past Python
    return Check(0.0, 0.0, "m")


def _aborts(device: Device) -> Check:
    os.abort()


def _reads_nowhere(device: Device) -> Check:
    ctypes.string_at(0)
    raise AssertionError


def _exits(device: Device) -> Check:
    os._exit(3)


CHECKS = {
    "sound": _sound,
    "wrong": _wrong,
    "unknown": _unknown,
    "raises": _raises,
    "noisy": _noisy,
    "aborts": _aborts,
    "reads_nowhere": _reads_nowhere,
    "exits": _exits,
}
