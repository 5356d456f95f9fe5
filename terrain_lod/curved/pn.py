"""Curved point-normal triangles on the device: control nets, factors, and points on the surface.

After A. Vlachos, J. Peters, C. Boyd, J. L. Mitchell: *Curved PN Triangles*, I3D 2001.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..device import layout
from ..device.device import Device, DeviceArray
from ..device.formulas import formula_defines, formula_numbers
from ..mesh.vertices import DeviceVertices
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from .adjacency import Adjacency
from .patch_factors import EdgeFactor

_GROUP: Final = 64
_LANES: Final = 8  # points that a CPU evaluates side by side
# a cosine that nothing is turned away by
KEEP_ALL: Final = 2.0


@dataclass(frozen=True, eq=False)
class DevicePatchMesh:
    """T triangles as patches of 12 indices, see :class:`terrain_lod.curved.adjacency.Adjacency`.

    Attributes
    ----------
    positions, normals : DeviceArray, (V, 3) float32
    patches : DeviceArray, (T, 12) int32
    edges : DeviceArray, (T, 3) int32
    sides : DeviceArray, (E, 2) int32
    """

    positions: DeviceArray
    normals: DeviceArray
    patches: DeviceArray
    edges: DeviceArray
    sides: DeviceArray

    @classmethod
    def upload(
        cls,
        vertices: npt.NDArray[np.float32],
        normals: npt.NDArray[np.float32],
        adjacency: Adjacency,
        device: Device,
    ) -> DevicePatchMesh:
        """Copy a mesh to the device, or refuse it with the bytes wanted and had."""
        arrays = (vertices, normals, adjacency.patches, adjacency.edges, adjacency.sides)
        triangles = len(adjacency.patches)
        device.require(f"a mesh of {triangles} triangles", *(array.nbytes for array in arrays))
        return cls(*(device.array(np.ascontiguousarray(array)) for array in arrays))

    @property
    def device(self) -> Device:
        return self.positions.device

    @property
    def count(self) -> int:
        return self.patches.shape[0]


def nets_on_device(mesh: DevicePatchMesh) -> DeviceArray:
    """Return the control net of every patch: ten vectors for positions and six for normals.

    Their order and meaning stand in ``kernels/curved/pn_net.h``. Two patches at an edge find the
    same bits for what lies on it.

    Returns
    -------
    DeviceArray, (T, 16, 3) float32

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold them.
    """
    device, shape = mesh.device, (mesh.count, layout.NET_VECTORS, 3)
    device.require(f"control nets of {mesh.count} triangles", 4 * int(np.prod(shape)))
    nets = device.empty(shape, np.float32)
    device.kernel("curved/pn_hull.cl", "pn_hull")(
        (mesh.count,),
        (_GROUP,),
        triangles=mesh.count,
        patches=mesh.patches,
        positions=mesh.positions,
        normals=mesh.normals,
        nets=nets,
    )
    return nets


def edge_factors_on_device(
    mesh: DevicePatchMesh, formula: EdgeFactor, diagonal: float, view: npt.NDArray[Any]
) -> DeviceArray:
    """Return the factor of every edge; (E,) float32.

    Parameters
    ----------
    mesh : DevicePatchMesh
    formula : EdgeFactor
    diagonal : float
        Of the mesh's bounds.
    view : layout.VIEW record
        All zero where the formula needs no camera.
    """
    device, count = mesh.device, mesh.sides.shape[0]
    parameters = formula.parameters(diagonal)
    defines = formula_defines("FACTOR", formula.header, parameters, prefix="FACTOR_")
    factors = device.empty(count, np.float32)
    device.kernel("curved/pn_edges.cl", "pn_edges", **defines)(
        (count,),
        (_GROUP,),
        edges=count,
        view=view,
        parameters=formula_numbers(device, parameters),
        sides=mesh.sides,
        patches=mesh.patches,
        positions=mesh.positions,
        normals=mesh.normals,
        factors=factors,
    )
    return factors


def patch_factors_on_device(
    mesh: DevicePatchMesh,
    nets: DeviceArray,
    factors: DeviceArray,
    view: npt.NDArray[Any],
    *,
    cull: bool,
    back_cosine: float | None,
) -> DeviceFactors:
    """Give every patch its edges' factors, the largest of them inside, or none if it is unseen.

    Parameters
    ----------
    mesh : DevicePatchMesh
    nets : DeviceArray, (T, 16, 3) float32
    factors : DeviceArray, (E,) float32
    view : layout.VIEW record
    cull : bool
        Leave out patches whose control points are all out of view.
    back_cosine : float or None
        Leave out patches all of whose normals are turned away from the eye by more than that.
    """
    device = mesh.device
    made = DeviceFactors(
        device.empty((mesh.count, 3), np.float32), device.empty((mesh.count, 1), np.float32)
    )
    device.kernel("curved/pn_patches.cl", "pn_patches")(
        (mesh.count,),
        (_GROUP,),
        triangles=mesh.count,
        view=view,
        cull_frustum=int(cull),
        back_cosine=KEEP_ALL if back_cosine is None else back_cosine,
        edges=mesh.edges,
        factors=factors,
        nets=nets,
        edge_factors=made.edge,
        inside_factors=made.inside,
    )
    return made


def evaluate_on_device(
    nets: DeviceArray, pattern: DevicePattern, *, linear_normals: bool = False
) -> DeviceVertices:
    """Put every point of `pattern` on its patch.

    Parameters
    ----------
    nets : DeviceArray, (T, 16, 3) float32
    pattern : DevicePattern
        Of the triangle domain: u, v, w = 1 - u - v are the weights of corners 0, 1, 2.
    linear_normals : bool, optional
        Blend the corners' normals alone, as shading does without PN-triangles.

    Returns
    -------
    DeviceVertices
        Normals of unit length; where the blend has no direction, as half-way between opposite
        normals, the plane triangle's, and where that has none, (0, 0, 1).

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold the vertices.
    """
    lanes = 1 if nets.device.is_gpu else _LANES
    defines = {"LANES": lanes, "LINEAR_NORMALS": int(linear_normals)}
    return _vertices("pn_domain", nets, pattern, defines)


def _vertices(
    stage: str,
    nets: DeviceArray,
    pattern: DevicePattern,
    defines: dict[str, int],
    **inputs: DeviceArray,
) -> DeviceVertices:
    """Run one of the kernels that make a vertex of every point."""
    device, count, patches = nets.device, pattern.points.shape[0], nets.shape[0]
    vertices = DeviceVertices.empty(device, count)
    group = device.group_size(32)
    groups = device.runs(patches)
    device.kernel(f"curved/{stage}.cl", stage, GROUP=group, **defines)(
        (groups * group,),
        (group,),
        patches=patches,
        nets=nets,
        point_offsets=pattern.point_offsets,
        points=pattern.points,
        positions=vertices.positions,
        normals=vertices.normals,
        **inputs,
    )
    return vertices


def levels_on_device(factors: DeviceArray, maximum: int) -> DeviceArray:
    """Return the semi-uniform level of every factor, its binary logarithm; below 0 where culled.

    Parameters
    ----------
    factors : DeviceArray, (T, 3) float32
    maximum : int
        Largest level; higher ones are lowered to it.

    Returns
    -------
    DeviceArray, (T, 3) float32
    """
    device = factors.device
    levels = device.empty(factors.shape, np.float32)
    kernel = device.kernel("curved/pn_blend.cl", "pn_levels", GROUP=1, LANES=1, LINEAR_NORMALS=0)
    kernel(
        (factors.size,),
        (_GROUP,),
        count=factors.size,
        maximum=float(maximum),
        factors=factors,
        levels=levels,
    )
    return levels


def turns_on_device(nets: DeviceArray) -> DeviceArray:
    """Return where semi-uniform patterns put the middles of edges of level 0.

    Returns
    -------
    DeviceArray, (T,) int32
        For :func:`terrain_lod.tessellation.semi_uniform.semi_uniform_device`; both sides of an edge
        agree.
    """
    device, patches = nets.device, nets.shape[0]
    turns = device.empty(patches, np.int32)
    kernel = device.kernel("curved/pn_blend.cl", "pn_turns", GROUP=1, LANES=1, LINEAR_NORMALS=0)
    kernel((patches,), (_GROUP,), patches=patches, nets=nets, turns=turns)
    return turns


def blend_on_device(
    nets: DeviceArray, levels: DeviceArray, pattern: DevicePattern, *, linear_normals: bool = False
) -> DeviceVertices:
    """Put every point of a semi-uniform `pattern` on its patch, or on its way there.

    Points that a level has and the next lower one has not, come out of that one by the fraction of
    the level, see ``kernels/curved/pn_blend.cl``.

    Parameters
    ----------
    nets : DeviceArray, (T, 16, 3) float32
    levels : DeviceArray, (T, 3) float32
        Those that the pattern was made for.
    pattern : DevicePattern
        Of :func:`~terrain_lod.tessellation.semi_uniform.semi_uniform_device`, with the turns of
        `nets`.
    linear_normals : bool, optional
        As for :func:`evaluate_on_device`.

    Returns
    -------
    DeviceVertices

    Raises
    ------
    DeviceMemoryError
        If the device cannot hold the vertices.
    """
    defines = {"LANES": 1, "LINEAR_NORMALS": int(linear_normals)}
    return _vertices("pn_blend", nets, pattern, defines, levels=levels)
