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
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from ..device.device import Device
from ..device.drivers import devices

Array = npt.NDArray[Any]


@dataclass(frozen=True)
class Check:
    """How far a kernel is from its reference.

    Attributes
    ----------
    error, bound : float
        The worst difference found, and the largest that rounding explains.
    unit : str
    """

    error: float
    bound: float
    unit: str


Checks = Mapping[str, Callable[[Device], Check]]
"""By the kernel's file, without its ending."""


def largest_difference(found: Array, expected: Array) -> float:
    """Return the largest difference; infinite where only one of the two is NaN."""
    found = found.reshape(expected.shape).astype(np.float64)
    if (np.isnan(found) != np.isnan(expected)).any():
        return np.inf
    with np.errstate(invalid="ignore"):  # where both are infinite
        return float(np.nanmax(np.abs(found - expected), initial=0.0))


def unequal_rows(found: Array, expected: Array) -> float:
    """Return how many rows differ; all where there are more or fewer of them."""
    if found.shape != expected.shape:
        return float(max(len(found), len(expected)))
    return float(np.count_nonzero((found != expected).reshape(len(expected), -1).any(axis=1)))


def main(arguments: list[str]) -> None:
    table, *rest = arguments
    checks: Checks = importlib.import_module(table).CHECKS
    if not rest:
        _answer(devices=[asdict(info) for info in devices()], kernels=list(checks))
        return
    number, *kernels = rest
    device = Device.open(number)
    for kernel in kernels:
        try:
            with device.timed() as timeline:
                check = checks[kernel](device)
        except Exception as error:  # whatever it is, the other kernels are still of interest
            problem = f"{type(error).__name__}: {error}".partition("\n")[0]
            _answer(kernel=kernel, problem=problem)
        else:
            seconds = timeline.seconds.get(kernel.rpartition("/")[2], math.nan)
            _answer(kernel=kernel, seconds=seconds, **asdict(check))


def _answer(**values: Any) -> None:
    print(json.dumps(values), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
