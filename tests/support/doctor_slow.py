"""A check that takes too long when it is first asked for, as kernels do that are built then."""

from __future__ import annotations

import os
import time
from collections.abc import Iterable
from pathlib import Path

from support.doctor_checks import CHECKS as OTHERS
from support.doctor_checks import HEIGHT, check_of
from terrain_lod.checks.check import Difference
from terrain_lod.device.device import Device


def _is_slow_at_first(case: object, device: Device) -> Iterable[Difference]:
    built = Path(os.environ["DOCTOR_SLOW"])
    if not built.exists():
        built.touch()
        time.sleep(600)
    return [Difference(HEIGHT, 0.0, 0.0)]


CHECKS = {"sound": OTHERS["sound"], "slow": check_of(_is_slow_at_first)}
