"""Catmull-Clark surfaces by a bicubic patch a quad, with fields of tangents for smooth normals.

Loop, Schaefer: *Approximating Catmull-Clark Subdivision Surfaces with Bicubic Patches*, ACM
Transactions on Graphics 27, 2008. Quads whose corners all have four neighbours are exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ..camera.camera import Camera
from ..device.device import Device
from ..errors import InputError
from ..mesh.mesh import Mesh
from .bezier import bezier_mesh
from .control_mesh import Array, ControlMesh, Indices, Rings
from .patch_factors import EdgeFactor
from .quad_factors import quad_factors

# where a corner's points stand in the net [along u, along v] of its quad: its own, those along the
# edges to the next corner and to the one before, and that of the face
_OWN = ((0, 0), (3, 0), (3, 3), (0, 3))
_NEXT = ((1, 0), (3, 1), (2, 3), (0, 2))
_BEFORE = ((0, 1), (2, 0), (3, 2), (1, 3))
_INSIDE = ((1, 1), (2, 1), (2, 2), (1, 2))


@dataclass(frozen=True, eq=False)
class QuadPatches:
    """Bicubic patches, a quad each, and what their normals come from.

    Attributes
    ----------
    nets : (P, 4, 4, 3) float64
        Control points, [patch, along u, along v]. Those on an edge are the same for both patches.
    along_u : (P, 3, 4, 3) float64
        Control vectors of the tangents along u, quadratic in u and cubic in v.
    along_v : (P, 4, 3, 3) float64
        Those along v.
    """

    nets: Array
    along_u: Array
    along_v: Array


def catmull_clark_patches(mesh: ControlMesh) -> QuadPatches:
    """Return the patches that approximate the Catmull-Clark surface of a control mesh.

    Parameters
    ----------
    mesh : ControlMesh
        One that has other faces than quads, or creases that end, is subdivided once.

    Returns
    -------
    QuadPatches
        In the order of the faces, corner 0 at u = v = 0 and corner 1 at u = 1. Corners lie on the
        surface. Outlines and creases are its curves, exactly.

    Raises
    ------
    InputError
        If there are no faces.
    """
    if not mesh.faces:
        raise InputError("expected faces, got none")
    if not mesh.is_quads or (Rings.of(mesh).sharp_count == 1).any():
        mesh = mesh.refined()
    rings, points = Rings.of(mesh), mesh.vertices
    start, far = rings.starts, rings.starts[rings.after[rings.after]]
    ahead, behind = rings.starts[rings.after], rings.starts[rings.before]
    smooth_vertex = (rings.sharp_count < 2) & ~rings.corners
    valence = _valences(rings, smooth_vertex)
    n = valence[:, None]
    inside = (n * points[start] + 2 * (points[ahead] + points[behind]) + points[far]) / (n + 5)

    # the mean of both faces' points along a smooth edge, a third of the way along a sharp one
    along = (2 * points[start] + points[ahead]) / 3
    bent = ~rings.sharp_edges[rings.edges] | (smooth_vertex[start] & (rings.twins >= 0))
    beyond = rings.after[rings.twins]
    along[bent] = (inside[bent] + inside[beyond[bent]]) / 2
    back = (2 * points[start] + points[behind]) / 3
    twin_before = rings.twins[rings.before]
    bent = ~rings.sharp_edges[rings.edges[rings.before]]
    bent |= smooth_vertex[start] & (twin_before >= 0)
    back[bent] = (inside[bent] + inside[twin_before[bent]]) / 2

    faces_around = np.maximum(np.bincount(start, minlength=len(points)), 1)[:, None]
    corner = np.zeros_like(points)
    np.add.at(corner, start, inside)
    corner /= faces_around
    creased = (4 * points + rings.crease_neighbours) / 6
    kind = np.where(rings.corners, 2, np.where(smooth_vertex, 0, 1))[:, None]
    corner = np.choose(kind, [corner, creased, points])

    nets = np.empty((len(start) // 4, 4, 4, 3))
    for c in range(4):
        for place, values in (
            (_OWN, corner[start]),
            (_NEXT, along),
            (_BEFORE, back),
            (_INSIDE, inside),
        ):
            nets[:, place[c][0], place[c][1]] = values[c::4]
    return QuadPatches(nets, *_tangents(nets, mesh, rings, valence, smooth_vertex))


def _valences(rings: Rings, smooth_vertex: npt.NDArray[np.bool_]) -> Indices:
    """Return how many faces meet at each half-edge's vertex, (H,): twice those between creases."""
    # corners of faces that meet across an edge that is not sharp
    crossed = np.flatnonzero((rings.twins >= 0) & ~rings.sharp_edges[rings.edges])
    beyond = rings.after[rings.twins[crossed]]
    fan = np.arange(len(rings.starts))
    while (fan[crossed] != fan[beyond]).any():  # the least number goes around
        for one, other in ((crossed, beyond), (beyond, crossed)):
            np.minimum.at(fan, one, fan[other])
    size = np.bincount(fan)[fan]
    around = np.bincount(rings.starts)[rings.starts]
    between = np.where(rings.corners[rings.starts], np.maximum(2 * size, 4), 2 * size)
    return np.where(smooth_vertex[rings.starts], around, between)


def _tangents(
    nets: Array,
    mesh: ControlMesh,
    rings: Rings,
    valence: Indices,
    smooth_vertex: npt.NDArray[np.bool_],
) -> tuple[Array, Array]:
    """Return the control vectors of the tangents along u and along v.

    At an edge both patches' tangents across it differ by a multiple of the one along it, which goes
    from the cosine c0 of one end to that of the other, -c1: their normals there are the same.
    """
    along_u, along_v = 3 * np.diff(nets, axis=1), 3 * np.diff(nets, axis=2)
    ahead, behind, regular = _limit_tangents(mesh, rings, smooth_vertex)
    cosine = np.where(regular, np.cos(2 * np.pi / np.maximum(valence, 1)), 0)
    # at corners: the edge ahead is along u at every other one, and backwards at the last two
    for c, (i, j) in enumerate(_OWN):
        own = slice(c, None, 4)
        known = regular[own]
        u, v = (ahead[own], behind[own]) if c % 2 == 0 else (behind[own], ahead[own])
        along_u[known, min(i, 2), j] = (u if i == 0 else -u)[known]
        along_v[known, i, min(j, 2)] = (v if j == 0 else -v)[known]
    # what is added to those across each edge, from corner c to the next, inwards
    edges = (along_u[:, :, 0], along_v[:, 3], -along_u[:, ::-1, 3], -along_v[:, 0, ::-1])
    turned = np.where(rings.sharp_edges[rings.edges], 0, 1)
    more = []
    for c, edge in enumerate(edges):
        own, other = slice(c, None, 4), slice((c + 1) % 4, None, 4)
        c0, c1 = ((turned[own] * cosine[each])[:, None] for each in (own, other))
        first = (2 * c0 * edge[:, 1] - c1 * edge[:, 0]) / 3
        more.append((first, (c0 * edge[:, 2] - 2 * c1 * edge[:, 1]) / 3))
    (first_0, last_0), (first_1, last_1), (first_2, last_2), (first_3, last_3) = more
    along_v[:, 1, 0] += first_0
    along_v[:, 2, 0] += last_0
    along_u[:, 2, 1] -= first_1
    along_u[:, 2, 2] -= last_1
    along_v[:, 2, 2] -= first_2
    along_v[:, 1, 2] -= last_2
    along_u[:, 0, 2] += first_3
    along_u[:, 0, 1] += last_3
    return along_u, along_v


def _limit_tangents(
    mesh: ControlMesh, rings: Rings, smooth_vertex: npt.NDArray[np.bool_]
) -> tuple[Array, Array, npt.NDArray[np.bool_]]:
    """Return the surface's tangents along each half-edge and along the one before it; (H, 3).

    And where they are known, (H,): at smooth vertices, whose faces go all around. There the tangent
    along edge i of n is the first harmonic of the neighbours e and of the faces' far corners d,

        t_i = 2 / n sum of (1 + s c) / 2 cos(a (j - i)) e_j + s / 2 cos(a (j - i) + a / 2) d_j

    over all j, with a = 2 pi / n, c = cos(pi / n) and s = 1 / sqrt(4 + c^2).
    """
    points, count = mesh.vertices, len(mesh.vertices)
    turn = np.where(rings.twins[rings.before] >= 0, rings.twins[rings.before], -1)
    valence = np.bincount(rings.starts, minlength=count)
    # number the half-edges around each vertex, counter-clockwise from its first
    place = np.full(len(rings.starts), -1)
    _, at = np.unique(rings.starts, return_index=True)
    for number in range(int(valence.max(initial=0))):
        at = at[(at >= 0) & (place[at] < 0)]
        place[at] = number
        at = turn[at]
    missed = np.bincount(rings.starts[place < 0], minlength=count) > 0
    known = (smooth_vertex & ~missed)[rings.starts]
    n = valence[rings.starts]
    angle = 2 * np.pi / n
    cosine = np.cos(angle / 2)
    spread = 1 / np.sqrt(4 + cosine**2)
    ahead, far = rings.starts[rings.after], rings.starts[rings.after[rings.after]]
    turned = np.exp(1j * angle * place)
    near = ((1 + spread * cosine) / 2 * turned)[:, None] * points[ahead]
    beyond = (spread / 2 * turned * np.exp(0.5j * angle))[:, None] * points[far]
    harmonic = np.zeros((count, 3), complex)
    np.add.at(harmonic, rings.starts, near + beyond)
    there = (2 / n)[:, None] * harmonic[rings.starts] / turned[:, None]
    return there.real, (there / np.exp(1j * angle)[:, None]).real, known


def catmull_clark(
    control: ControlMesh | str | Path,
    *,
    factor: float | None = None,
    lod: EdgeFactor | None = None,
    camera: Camera | None = None,
    partitioning: str = "fractional_odd",
    device: Device | None = None,
) -> Mesh:
    """Return the mesh of the Catmull-Clark surface of a control mesh, or of a file of polygons.

    Parameters
    ----------
    control : ControlMesh or path
        `control.refined()` is nearer to the surface: an error falls to about a fifth.
    factor : float, optional
        Tessellation factor of all edges and insides of the quads, clamped to the partitioning's
        range. Defaults to 5.
    lod : EdgeFactor, optional
        A formula for the segments of each edge instead.
    camera : Camera, optional
        Where detail is wanted.
    partitioning : str, optional
        ``"integer"``, ``"pow2"``, ``"fractional_odd"``, ``"fractional_even"``, or
        ``"semi_uniform"``: dyadic patterns, for factors rounded up to powers of two.
    device : Device, optional

    Returns
    -------
    Mesh
        Closed where the control mesh is: patches have bit-equal vertices on the edges that they
        share, each its own copy. Normals are smooth across all edges that are not sharp.

    Raises
    ------
    FileError
        If the file cannot be read.
    InputError
        If there are no faces, a coordinate is beyond float32, a factor is not positive, or a
        formula needs a camera.
    DeviceMemoryError
        If the mesh does not fit the device.

    Notes
    -----
    Loop, Schaefer: *Approximating Catmull-Clark Subdivision Surfaces with Bicubic Patches*, 2008.
    """
    mesh = control if isinstance(control, ControlMesh) else ControlMesh.load(control)
    patches = catmull_clark_patches(mesh)
    with np.errstate(over="ignore"):
        nets, *fields = (
            each.astype(np.float32) for each in (patches.nets, patches.along_u, patches.along_v)
        )
    if not np.isfinite(nets).all():
        raise InputError(f"expected vertices within float32, got {abs(mesh.vertices).max():g}")
    u, v = (
        patches.along_u[:, [0, 2, 2, 0], [0, 0, 3, 3]],
        patches.along_v[:, [0, 3, 3, 0], [0, 0, 2, 2]],
    )
    device = Device.of(device)
    factors = quad_factors(nets, np.cross(u, v), factor, lod, camera, device)
    return bezier_mesh(nets, factors, partitioning, device, fields)
