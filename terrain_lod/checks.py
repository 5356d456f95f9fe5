"""One check a kernel: what a device computes against the float64 reference, on small data.

A check uploads all that its kernel reads, so that another kernel's fault is not taken for its own,
and returns the worst difference. A new kernel's check is one function and one row here.
"""

from __future__ import annotations

from typing import Final

from . import checks_terrain, checks_tessellator
from .checkup import Checks

CHECKS: Final[Checks] = {
    # by the stem of the kernel's file
    "analysis": checks_terrain.check_analysis,
    "control_points": checks_terrain.check_control_points,
    "hull": checks_terrain.check_hull,
    "scan": checks_tessellator.check_scan,
    "tessellator": checks_tessellator.check_tessellator,
    "domain": checks_terrain.check_domain,
    "holes": checks_terrain.check_holes,
    "vertical_error": checks_terrain.check_vertical_error,
    "bandwidth": checks_tessellator.check_bandwidth,
}
