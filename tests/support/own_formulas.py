"""Formulas from outside the package, as a user would write them: their headers are text to be
written into a folder, their classes are made for that folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import terrain_lod as tl

SLOPE = """\
// the steeper, the more
#include "terrain/patch.h"
#include "degrees.h"

inline float patch_lod(const Patch patch, const View view, __global const float *parameters)
{
    const float3 normal = patch.normal;
    const float run = sqrt(normal.x * normal.x + normal.y * normal.y);
    return 1.0f + parameters[LOD_SEGMENTS] * fmin(degrees_of(run, normal.z) / 45.0f, 1.0f);
}
"""
DEGREES = """\
inline float degrees_of(float run, float rise)
{
    return atan2(run, rise) * 57.29577951308232f;
}
"""
MODULE = """\
from dataclasses import dataclass
from pathlib import Path

import terrain_lod as tl


@dataclass(frozen=True)
class SlopeLod(tl.Lod):
    \"\"\"The steeper, the more.\"\"\"

    segments: float = tl.number(8.0, low=1, high=62, unit="segments", help="of a steep tile, more")
    header = Path(__file__).with_name("slope.h")
    needs_camera = False


@dataclass(frozen=True)
class TiltFactor(tl.curved.EdgeFactor):
    \"\"\"More along upright edges.\"\"\"

    most: float = tl.number(9.0, low=1, high=64, help="of an upright edge")
    header = Path(__file__).with_name("tilt.h")
    needs_camera = False


class Nothing:
    pass
"""
TILT = """\
#include "curved/patch_edge.h"

inline float edge_factor(const CurvedEdge edge, const View view, __global const float *parameters)
{
    const float rise = fabs(edge.ends[1].z - edge.ends[0].z) / edge_length(edge);
    return 1.0f + (parameters[FACTOR_MOST] - 1.0f) * rise;
}
"""


def write_formulas(folder: Path) -> Path:
    """Write all of the above into `folder`; return the module's path."""
    folder.mkdir(exist_ok=True)
    texts = {"slope.h": SLOPE, "degrees.h": DEGREES, "tilt.h": TILT, "mine.py": MODULE}
    for name, text in texts.items():
        (folder / name).write_text(text)
    return folder / "mine.py"


def slope_lod(folder: Path) -> tl.Lod:
    """Return the level of detail whose header is in `folder`."""

    @dataclass(frozen=True)
    class SlopeLod(tl.Lod):
        segments: float = 8.0
        header = folder / "slope.h"
        needs_camera = False

    return SlopeLod()


def slope_reference(patch, parameters):
    """What ``slope.h`` computes, in float64."""
    normal = patch.normal
    degrees = np.degrees(np.arctan2(np.hypot(normal[..., 0], normal[..., 1]), normal[..., 2]))
    return 1 + parameters["segments"] * np.minimum(degrees / 45, 1)
