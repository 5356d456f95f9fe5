"""Check of the kernel that measures how far a mesh is from the ground."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from ..device.device import Device
from ..measure.error import vertical_error
from ..reference.measure import error
from .check import Bound, Check, Difference, ulp
from .grounds import Ground, hard_grounds, plain_grounds

_ERROR: Final = Bound(
    "vertical error", "m", "1/2 ulp of it", "computed in 64 bits, and rounded once"
)


def _vertical_error(case: Ground, device: Device) -> Iterator[Difference]:
    mesh = case.crossing_triangles(seed=4)
    found = vertical_error(mesh, case.sum, field=True, device=device).field
    expected = error.error_field(mesh, case.sum)
    # and what 64 bits lose of the heights
    allowed = 0.5 * ulp(np.nan_to_num(expected)) + 1e-14 * case.highest
    yield _ERROR.met_by(found, expected, allowed)


VERTICAL_ERROR: Final = Check(_vertical_error, plain_grounds, hard_grounds)
