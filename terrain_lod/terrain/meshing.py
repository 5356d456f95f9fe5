"""From factors to a mesh: tessellate, leave out holes, displace, bring down."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from ..device.timeline import Timeline
from ..mesh.device_mesh import DeviceMesh
from ..mesh.mesh import Achieved, Mesh, Patches
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from ..tessellation.tessellator import tessellate_device
from .buffers import PatchSet
from .domain import displace_on_device
from .holes import without_holes_on_device


@dataclass(frozen=True, eq=False)
class Tessellated:
    """Patches with their factors, and the pattern that these make.

    Attributes
    ----------
    patches : PatchSet
    factors : DeviceFactors
    pattern : DevicePattern
        Without the triangles that reach into holes.
    achieved : Achieved or None
        What was measured of it, where an error was promised.
    """

    patches: PatchSet
    factors: DeviceFactors
    pattern: DevicePattern
    achieved: Achieved | None = None

    @classmethod
    def of(cls, patches: PatchSet, factors: DeviceFactors, partitioning: str) -> Tessellated:
        """Tessellate every patch."""
        # v runs south, so clockwise in the domain is counter-clockwise seen from above
        pattern = tessellate_device(
            "quad", factors.edge, factors.inside, partitioning, clockwise=False
        )
        if patches.ground.masked:
            pattern = without_holes_on_device(patches, pattern)
        return cls(patches, factors, pattern)

    @property
    def triangle_count(self) -> int:
        count: int = self.pattern.primitives.shape[0]
        return count


def mesh_of(
    made: Tessellated,
    areas: npt.NDArray[np.int32],
    deviation: npt.NDArray[np.float32],
    timeline: Timeline,
) -> Mesh:
    """Put a pattern on the ground and bring it down, with what is known of its patches.

    Parameters
    ----------
    made : Tessellated
    areas : (P, 4) int32
        As :attr:`Patches.areas`; patches of none, which were split, are left out.
    deviation : (P,) float32
        As :attr:`Patches.deviation`.
    timeline : Timeline
    """
    vertices, ground = displace_on_device(made.patches, made.pattern), made.patches.ground
    pattern, there = made.pattern, areas[:, 2] > 0
    # those that are left out have neither points nor triangles
    starts = np.append(there, True)
    return Mesh(
        vertices=vertices.positions.host(),
        normals=vertices.normals.host(),
        triangles=pattern.primitives.host(),
        origin=np.array(ground.origin),
        crs=ground.relief.ground.crs,
        patches=Patches(
            grid=ground.grid,
            areas=areas[there],
            edge_factors=made.factors.edge.host()[there],
            inside_factors=made.factors.inside.host()[there],
            point_offsets=pattern.point_offsets.host()[starts].astype(np.int64),
            triangle_offsets=pattern.primitive_offsets.host()[starts].astype(np.int64),
            deviation=deviation[there],
        ),
        timings=timeline.seconds,
        achieved=made.achieved,
    )


def device_mesh_of(made: Tessellated) -> DeviceMesh:
    """Put a pattern on the ground and leave it there."""
    vertices, ground = displace_on_device(made.patches, made.pattern), made.patches.ground
    return DeviceMesh(
        vertices=vertices.positions,
        normals=vertices.normals,
        triangles=made.pattern.primitives,
        origin=np.array(ground.origin),
        crs=ground.relief.ground.crs,
        achieved=made.achieved,
    )
