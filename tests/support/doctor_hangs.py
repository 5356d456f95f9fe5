"""A check that never ends, before and after which others would."""

from __future__ import annotations

import time

from support.doctor_checks import CHECKS as OTHERS
from terrain_lod.checks.checkup import Check
from terrain_lod.device.device import Device


def _hangs(device: Device) -> Check:
    time.sleep(600)
    raise AssertionError


CHECKS = {"sound": OTHERS["sound"], "hangs": _hangs}
