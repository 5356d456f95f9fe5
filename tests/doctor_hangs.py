"""A check that never ends, before and after which others would."""

from __future__ import annotations

import time

from doctor_checks import CHECKS as OTHERS

from terrain_lod.device import Device
from terrain_lod.doctor.checkup import Check


def _hangs(device: Device) -> Check:
    time.sleep(600)
    raise AssertionError


CHECKS = {"sound": OTHERS["sound"], "hangs": _hangs}
