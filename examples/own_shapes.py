"""Shapes of your own
==================

A surface and a factor of edges, each checked against its reference.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import terrain_lod as tl
from terrain_lod.checks.curved import check_shape
from terrain_lod.checks.curved_pn import check_factor

HERE = Path(__file__).parent

EGG = tl.curved.ParametricSurface(
    HERE / "egg.h", {"radius": tl.Number(1.0), "height": tl.Number(1.4)}, closed="u"
)


@dataclass(frozen=True)
class UprightFactor(tl.curved.EdgeFactor):
    """More segments along edges that stand upright."""

    most: float = tl.number(9.0, low=1, high=64, unit="segments", help="of an upright edge")
    header = HERE / "upright.h"
    needs_camera = False


def egg(u, v, numbers):
    ring, angle = numbers["radius"] * np.sin(np.pi * v), 2 * np.pi * u
    return ring * np.cos(angle), ring * np.sin(angle), -numbers["height"] * np.cos(np.pi * v)


def upright(edge, view, parameters):
    return 1 + (parameters["most"] - 1) * abs(edge.ends[1] - edge.ends[0])[2] / edge.length


if __name__ == "__main__":
    for check in (check_shape(EGG, egg), check_factor(UprightFactor(), upright)):
        unit = check.bound.unit
        print(f"off by {check.error:.1g} {unit}, {check.allowed:g} is rounding")
        assert check.is_met

    mesh = tl.curved.surface(EGG, patches=(8, 4), factor=3, height=2.0)
    smooth = tl.pn_triangles(mesh, lod=UprightFactor(most=5))
    print(f"{mesh}, curved {smooth}: {tl.crack_report(smooth)}")
    smooth.save("egg.glb")
    tl.render(smooth, "egg.png")
