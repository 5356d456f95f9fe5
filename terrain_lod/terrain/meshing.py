"""From factors to a mesh: tessellate, leave out holes, displace, bring down."""

from __future__ import annotations

import numpy as np

from ..device.timeline import Timeline
from ..mesh.mesh import Achieved, Mesh, Patches
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from ..tessellation.tessellator import tessellate_device
from .domain import displace_on_device
from .holes import without_holes_on_device
from .tiles import DeviceTiles


def pattern_on_device(
    tiles: DeviceTiles, factors: DeviceFactors, partitioning: str
) -> DevicePattern:
    """Tessellate every patch and leave out the triangles that reach into holes."""
    # v runs south, so clockwise in the domain is counter-clockwise seen from above
    pattern = tessellate_device("quad", factors.edge, factors.inside, partitioning, clockwise=False)
    return without_holes_on_device(tiles, pattern) if tiles.ground.masked else pattern


def mesh_of(
    tiles: DeviceTiles,
    factors: DeviceFactors,
    pattern: DevicePattern,
    timeline: Timeline,
    achieved: Achieved | None = None,
) -> Mesh:
    """Put `pattern` on the ground and bring it down, with what is known of its patches."""
    vertices, ground = displace_on_device(tiles, pattern), tiles.ground
    return Mesh(
        vertices=vertices.positions.host(),
        normals=vertices.normals.host(),
        triangles=pattern.primitives.host(),
        origin=np.array(ground.origin),
        crs=ground.relief.ground.crs,
        patches=Patches(
            grid=tiles.grid,
            edge_factors=factors.edge.host(),
            inside_factors=factors.inside.host(),
            point_offsets=pattern.point_offsets.host().astype(np.int64),
            triangle_offsets=pattern.primitive_offsets.host().astype(np.int64),
            deviation=tiles.found.deviation.ravel(),
        ),
        timings=timeline.seconds,
        achieved=achieved,
    )
