"""Any triangle mesh, curved: PN-triangles through the tessellator.

::

    mesh --adjacency--> 12-index patches --hull--> control nets, factors
         --tessellate--> points, triangles --evaluate--> vertices, normals

Data stays on the device between the stages and comes down once, as a Mesh.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..arguments import each, finite, flag, instance, one_of, told
from ..camera.camera import Camera
from ..device import layout
from ..device.device import Device, DeviceArray
from ..device.timeline import Timeline
from ..errors import InputError
from ..mesh.mesh import Mesh
from ..mesh.vertices import DeviceVertices
from ..tessellation.factors import DeviceFactors
from ..tessellation.pattern import DevicePattern
from ..tessellation.semi_uniform import semi_uniform_device
from ..tessellation.tessellator import tessellate_device
from .adjacency import Adjacency
from .curved_mesh import CurvedMesh
from .patch_factors import MAX_FACTOR, EdgeFactor, UniformFactor, checked_formula
from .patched_mesh import PatchedMesh, require_curvable
from .pn import (
    DevicePatchMesh,
    blend_on_device,
    edge_factors_on_device,
    evaluate_on_device,
    levels_on_device,
    patch_factors_on_device,
    turns_on_device,
)

NORMALS: Final = ("quadratic", "linear")
# patterns of another tessellator: semi_uniform.py
SEMI_UNIFORM: Final = "semi_uniform"

# a factor of 64, the largest
_LARGEST_LEVEL: Final = 6


def pn_triangles(
    mesh: Mesh,
    factor: float | npt.ArrayLike | None = None,
    *,
    lod: EdgeFactor | None = None,
    camera: Camera | None = None,
    normals: str = "quadratic",
    sharp: bool | float = True,
    partitioning: str = "fractional_odd",
    cull: bool = True,
    back_faces: float | None = None,
    device: Device | None = None,
) -> CurvedMesh:
    """Replace every triangle of a mesh by a curved one, and tessellate it.

    Parameters
    ----------
    mesh : Mesh
        Its normals shape the surface: it stands across them at the vertices.
    factor : float or (T, 3) array_like, optional
        Segments along the edges, 1 to 64: everywhere, or along the edge opposite each corner; of an
        edge's two the larger counts. Defaults to 5.
    lod : EdgeFactor, optional
        A formula for the segments instead.
    camera : Camera, optional
        Where detail is wanted, and what is in view. Without one, nothing is culled.
    normals : {"quadratic", "linear"}, optional
        Normals that follow the curved surface, or those that shading would blend.
    sharp : bool or float, optional
        What happens where vertices at the same position have different normals. True: the edge is
        sharp, and one curve for both sides (PN-AEN), so that the surface stays closed. A number:
        also make sharp all edges at which faces meet at more than so many degrees. False: PN as
        first published; the two sides part.
    partitioning : str, optional
        ``"fractional_odd"``, ``"fractional_even"``, ``"integer"`` or ``"pow2"`` of the tessellator,
        or ``"semi_uniform"``: dyadic patterns, whose levels are the factors' binary logarithms, and
        blended between whole levels.
    cull : bool, optional
        Leave out patches that are out of the camera's view.
    back_faces : float, optional
        Leave out patches that are turned away from the camera everywhere, by more than this cosine:
        0 leaves out the most. For closed meshes; by default they are kept.
    device : Device, optional

    Returns
    -------
    CurvedMesh
        A mesh that also carries over what the source has at its vertices, such as texture
        coordinates. Corners are kept exactly. Patches have bit-equal vertices on the edges that
        they share, each its own copy. Where no normal can be computed, see
        :func:`terrain_lod.curved.pn.evaluate_on_device`.

    Raises
    ------
    InputError
        If the mesh is empty or has positions or normals that are not finite or corners that are no
        vertices; if a factor is out of range or a word is unknown; if a formula needs a camera.
    DeviceMemoryError
        If the device cannot hold the mesh.

    Notes
    -----
    A. Vlachos, J. Peters, C. Boyd, J. L. Mitchell: *Curved PN Triangles*, I3D 2001.
    J. McDonald, M. Kilgard: *Crack-Free Point-Normal Triangles Using Adjacent Edge Normals*, 2010.

    Examples
    --------
    >>> smooth = pn_triangles(load_mesh("bunny.ply"), 5)        # doctest: +SKIP
    """
    require_curvable(mesh)
    one_of("normals", normals, NORMALS)
    one_of("partitioning", partitioning, (*layout.PARTITIONINGS, SEMI_UNIFORM))
    back_cosine = back_cosine_of(back_faces, camera)
    view = view_for(mesh, factor, lod, camera)
    device = Device.of(device)
    with device.timed() as timeline:
        base = PatchedMesh.upload(mesh, device, sharp=sharp)
        of_edges = edge_factors(base.patches, base.adjacency, factor, lod, diagonal_of(mesh), view)
        factors = patch_factors_on_device(
            base.patches,
            base.nets,
            of_edges,
            view,
            cull=flag("cull", cull) and camera is not None,
            back_cosine=back_cosine,
        )
        return tessellate_nets(
            mesh, base.nets, factors, partitioning, normals == "linear", timeline
        )


def view_for(
    mesh: Mesh,
    factor: float | npt.ArrayLike | None,
    lod: EdgeFactor | None,
    camera: Camera | None,
) -> npt.NDArray[Any]:
    """Return the ``layout.VIEW`` record that factors are found with, zero without a camera.

    Raises
    ------
    InputError
        If there are both a factor and a formula, `lod` is no formula for edges, or it lacks the
        camera that it needs.
    """
    if lod is not None and factor is not None:
        raise InputError(f"expected a factor or a lod, got both {told(factor)} and {told(lod)}")
    if lod is not None and checked_formula(lod).needs_camera and camera is None:
        raise InputError(f"{type(lod).__name__} needs a camera, got none")
    if camera is None:
        return np.zeros((), layout.VIEW)
    return instance("a Camera for camera", camera, Camera).view(mesh.origin)


def tessellate_nets(
    mesh: Mesh,
    nets: DeviceArray,
    factors: DeviceFactors,
    partitioning: str,
    linear_normals: bool,
    timeline: Timeline,
) -> CurvedMesh:
    """Return the patches of `mesh`, whose control nets and factors are known, tessellated."""
    # corners 0, 1, 2 are u, v, w: counter-clockwise in the mesh is clockwise in the domain
    if partitioning == SEMI_UNIFORM:
        levels = levels_on_device(factors.edge, _LARGEST_LEVEL)
        pattern = semi_uniform_device(
            levels,
            maximum=_LARGEST_LEVEL,
            keep_degenerate=False,
            clockwise=True,
            turns=turns_on_device(nets),
        )
        vertices = blend_on_device(nets, levels, pattern, linear_normals=linear_normals)
    else:
        pattern = tessellate_device(
            "triangle", factors.edge, factors.inside, partitioning, clockwise=True
        )
        vertices = evaluate_on_device(nets, pattern, linear_normals=linear_normals)
    return from_device(mesh, pattern, vertices, timeline)


def from_device(
    mesh: Mesh, pattern: DevicePattern, vertices: DeviceVertices, timeline: Timeline
) -> CurvedMesh:
    """Return what the triangles of `mesh` were tessellated to, with its texture coordinates."""
    made = CurvedMesh(
        vertices=vertices.positions.host(),
        normals=vertices.normals.host(),
        triangles=pattern.primitives.host(),
        origin=mesh.origin,
        crs=mesh.crs,
        timings=timeline.seconds,
        source_triangles=mesh.triangles,
        points=pattern.points.host(),
        point_offsets=pattern.point_offsets.host().astype(np.int64),
    )
    if mesh.textures is None:
        return made
    return replace(made, textures=made.interpolate(mesh.textures))


def edge_factors(
    patches: DevicePatchMesh,
    adjacency: Adjacency,
    factor: float | npt.ArrayLike | None,
    lod: EdgeFactor | None,
    diagonal: float,
    view: npt.NDArray[Any],
) -> DeviceArray:
    """Return the factor of every edge, by formula or as given; (E,) float32."""
    if factor is None:
        return edge_factors_on_device(patches, lod or UniformFactor(), diagonal, view)
    given = each("factor", factor, adjacency.edges.shape, np.float32)
    if (outside := (given < 1) | (given > MAX_FACTOR)).any():
        raise InputError(f"expected factor from 1 to {MAX_FACTOR}, got {given[outside][0]:g}")
    of_edge = np.zeros(len(adjacency.sides), np.float32)
    np.maximum.at(of_edge, adjacency.edges.ravel(), given.ravel())
    return patches.device.array(of_edge)


def back_cosine_of(back_faces: float | None, camera: Camera | None) -> float | None:
    if back_faces is None:
        return None
    if camera is None:
        raise InputError("back_faces needs a camera, got none")
    cosine = finite("back_faces", back_faces)
    if not 0 <= cosine < 1:
        raise InputError(f"expected back_faces from 0 to below 1, got {cosine:g}")
    return cosine


def diagonal_of(mesh: Mesh) -> float:
    """Return the diagonal of the mesh's bounds, above 0."""
    used = mesh.vertices[mesh.triangles.ravel()]
    return float(np.linalg.norm(np.ptp(used.astype(np.float64), axis=0))) or 1.0
