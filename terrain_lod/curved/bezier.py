"""Bicubic Bézier patches through the tessellator."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt

from ..arguments import array, flag, parts
from ..camera.camera import Camera
from ..device.device import Device
from ..errors import InputError
from ..files.meshes.bpt import as_nets, load_bpt
from ..mesh.mesh import Mesh
from ..mesh.vertices import DeviceVertices
from ..tessellation.pattern import DevicePattern
from .patch_factors import EdgeFactor
from .quad_factors import quad_factors
from .quads import quad_mesh


def bezier(
    patches: npt.ArrayLike | str | Path,
    *,
    factor: float | None = None,
    lod: EdgeFactor | None = None,
    camera: Camera | None = None,
    partitioning: str = "fractional_odd",
    device: Device | None = None,
) -> Mesh:
    """Return the mesh of bicubic Bézier patches.

    Patches whose edges have the same control points, in whichever direction, have the same
    vertices there to the bit: no cracks. Vertices are not shared between patches, as normals may
    differ.

    Parameters
    ----------
    patches : (P, 4, 4, 3) or (P, 16, 3) array_like, or path
        Control points [patch, along u, along v], used in float32; or a .bpt file, see
        :func:`terrain_lod.curved.load_bpt`.
    factor : float, optional
        Tessellation factor of all edges and insides, clamped to the partitioning's
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
        Triangles counter-clockwise seen from the side of the normals, which is that of
        dP/du × dP/dv. Where a patch is collapsed into a point, the normal is the limit on the way
        to the middle of the patch: always of unit length.

    Raises
    ------
    InputError
        If there are not 16 control points a patch, one is not finite, the factor is not positive,
        or a formula needs a camera.
    FileError
        If the file cannot be read.
    DeviceMemoryError
        If the mesh does not fit the device.
    """
    nets = load_bpt(patches) if isinstance(patches, str | Path) else as_nets(patches)
    points = array("control points", nets, nets.shape, np.float32)
    device = Device.of(device)
    factors = quad_factors(points, corner_normals(points), factor, lod, camera, device)
    return bezier_mesh(points, factors, partitioning, device)


def corner_normals(nets: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
    """Return the directions across bicubic patches at their corners, in turn; (P, 4, 3)."""
    wide = nets.astype(np.float64)
    across, along = np.diff(wide, axis=1), np.diff(wide, axis=2)
    u, v = across[:, [0, 2, 2, 0], [0, 0, 3, 3]], along[:, [0, 3, 3, 0], [0, 0, 2, 2]]
    return np.cross(u, v)


def bezier_mesh(
    nets: npt.NDArray[np.float32],
    factors: tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]],
    partitioning: str,
    device: Device,
    tangents: Sequence[npt.NDArray[np.float32]] = (),
) -> Mesh:
    """Return the mesh of (P, 4, 4, 3) patches.

    Parameters
    ----------
    nets : (P, 4, 4, 3) float32
    factors : (P, 4) and (P, 2) float32
        Of edges and insides.
    partitioning : str
    device : Device
    tangents : ((P, 3, 4, 3) float32, (P, 4, 3, 3) float32), optional
        Control vectors of the tangents along u and along v that normals are taken from, in place
        of the patches' own.
    """
    fields = dict(zip(("along_u", "along_v"), map(_padded, tangents), strict=False))

    def evaluate(pattern: DevicePattern, vertices: DeviceVertices, items: int, group: int) -> None:
        defines = {"GROUP": group, "LANES": device.lanes, "TANGENTS": int(bool(fields))}
        device.kernel("curved/bezier.cl", "bezier", **defines)(
            (items,),
            (group,),
            patches=len(nets),
            nets=device.array(_padded(nets)),
            point_offsets=pattern.point_offsets,
            points=pattern.points,
            positions=vertices.positions,
            normals=vertices.normals,
            **{name: device.array(field) for name, field in fields.items()},
        )

    return quad_mesh(*factors, partitioning, device, evaluate)


def _padded(vectors: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """Return control points or vectors as (P, N, 4), as kernels read them."""
    padded = np.zeros((len(vectors), vectors[0].size // 3 if len(vectors) else 0, 4), np.float32)
    padded[..., :3] = vectors.reshape(len(vectors), -1, 3)
    return padded


def b_spline(
    points: npt.ArrayLike, *, closed: tuple[bool, bool] = (False, False)
) -> npt.NDArray[np.float64]:
    """Return the Bézier patches of a uniform bicubic B-spline surface, which they are exactly.

    Parameters
    ----------
    points : (M, N, 3) array_like
        Control points along u and along v; four or more each way, or three where it is closed.
    closed : (bool, bool), optional
        Whether the surface closes along u, and along v.

    Returns
    -------
    (P, 4, 4, 3) float64
        For :func:`bezier`. Patches have the control points of a common edge in common, to the bit.

    Raises
    ------
    InputError
        If there are too few points, or one is not finite.

    Notes
    -----
    Farin: *Curves and Surfaces for CAGD*, section 8 (Boehm's knot insertion). From four points
    a, b, c, d, with thirds of the way between them, a piece is (a b' + b'' b) / 2 and so on.
    """
    net = array("control points", points, ("M", "N", 3))
    closed_u, closed_v = parts("closed", closed, "along u", "along v")
    closed = flag("closed along u", closed_u), flag("closed along v", closed_v)
    least = [3 if each else 4 for each in closed]
    if net.shape[0] < least[0] or net.shape[1] < least[1]:
        raise InputError(
            f"expected control points ({least[0]} or more, {least[1]} or more, 3), got shape "
            f"{net.shape}"
        )
    for axis in (0, 1):
        net = np.moveaxis(_pieces(np.moveaxis(net, axis, 0), closed[axis]), 0, axis)
    across, down = ((extent - 1) // 3 for extent in net.shape[:2])
    return np.array(
        [net[3 * i : 3 * i + 4, 3 * j : 3 * j + 4] for j in range(down) for i in range(across)]
    )


def _pieces(points: npt.NDArray[np.float64], closed: bool) -> npt.NDArray[np.float64]:
    """Return the (3 K + 1, ...) Bézier points of a uniform cubic B-spline along the first axis."""
    if closed:
        points = np.concatenate([points, points[:3]])
    first, last = (2 * points[:-1] + points[1:]) / 3, (points[:-1] + 2 * points[1:]) / 3
    joints = (last[:-1] + first[1:]) / 2
    pieces = np.empty((3 * len(joints) - 2, *points.shape[1:]))
    pieces[::3], pieces[1::3], pieces[2::3] = joints, first[1:-1], last[1:-1]
    if closed:  # the same bits where it closes
        pieces[-1] = pieces[0]
    return pieces
