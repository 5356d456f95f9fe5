"""A check that never ends, before and after which others would."""

from __future__ import annotations

import time

from support.doctor_checks import CHECKS as OTHERS
from support.doctor_checks import check_of
from terrain_lod.device.device import Device


def _hangs(case: object, device: Device) -> None:
    time.sleep(600)


CHECKS = {"sound": OTHERS["sound"], "hangs": check_of(_hangs)}
