"""A level of detail of your own
=============================

A header, a class, and the reference that it is checked against::

    terrain-lod report ridge -o out --lod examples/own_lod.py:SlopeLod --steep 40
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import terrain_lod as tl
from terrain_lod.checks.terrain import check_lod


@dataclass(frozen=True)
class SlopeLod(tl.Lod):
    """The steeper the ground, the more detail."""

    steep: float = tl.number(30.0, low=1, high=90, unit="degrees", help="slope with all detail")
    maximum: float = tl.number(15.0, low=1, high=63, unit="segments", help="most factor")
    header = Path(__file__).with_name("slope.h")
    needs_camera = False


def slope(patch, parameters):
    """The same in float64: segments of patches from their normals."""
    normal = patch.normal
    degrees = np.degrees(np.arctan2(np.hypot(normal[..., 0], normal[..., 1]), normal[..., 2]))
    share = np.minimum(degrees / parameters["steep"], 1)
    return 1 + (parameters["maximum"] - 1) * share


if __name__ == "__main__":
    check = check_lod(SlopeLod(), slope)
    print(f"off by {check.error:.1g} of a segment, {check.allowed:g} is rounding")
    assert check.is_met

    ground = tl.sample("ridge")
    terrain = tl.Terrain(ground, levels=1)  # the flat grid, which formulas are at their best on
    for lod in (tl.UniformLod(5), SlopeLod(steep=80)):
        mesh = terrain.mesh(lod=lod)
        print(f"{lod}: {len(mesh.triangles):,} triangles, {tl.vertical_error(mesh, ground)}")
    mesh.save("slopes.glb")
    tl.render(mesh, "slopes.png", style="lod", camera=tl.default_camera(ground))
