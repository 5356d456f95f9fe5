"""The doctor's child process: says what devices there are, and runs checks on one of them.

::

    python -m terrain_lod.checks.checkup TABLE                  the devices, the table's kernels
    python -m terrain_lod.checks.checkup TABLE DEVICE KERNEL .. one check after the other

TABLE is a module with a dictionary ``CHECKS``. Each answer is one line of JSON, printed at once:
where a driver ends the process, the answers before it have arrived.
"""

from __future__ import annotations

import importlib
import json
import math
import sys
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from ..device.device import Device
from ..device.drivers import devices
from .check import Check


def main(arguments: list[str]) -> None:
    table, *rest = arguments
    checks: Mapping[str, Check] = importlib.import_module(table).CHECKS
    if not rest:
        _answer(devices=[asdict(info) for info in devices()], kernels=list(checks))
        return
    number, *kernels = rest
    device = Device.open(number)
    for kernel in kernels:
        try:
            with device.timed() as timeline:
                worst = checks[kernel].worst(device)
        except Exception as error:  # whatever it is, the other kernels are still of interest
            problem = f"{type(error).__name__}: {error}".partition("\n")[0]
            _answer(kernel=kernel, problem=problem)
        else:
            seconds = timeline.seconds.get(kernel.rpartition("/")[2], math.nan)
            _answer(
                kernel=kernel,
                quantity=worst.bound.quantity,
                error=worst.error,
                bound=worst.allowed,
                unit=worst.bound.unit,
                seconds=seconds,
            )


def _answer(**values: Any) -> None:
    print(json.dumps(values), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
