"""Normal maps baked: what a fine mesh has and a coarse one lacks, on the device."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np
import numpy.typing as npt

from ..arguments import parts, whole
from ..device.device import Device
from ..errors import InputError
from .mesh import Mesh
from .normal_map import NormalMap
from .queries import MeshQueries
from .soundness import sound_mesh
from .tangents import with_tangents

_GROUP: Final = 64
_LONGEST: Final = 1024  # texels, where no size is given
_MOST: Final = 16384  # texels along a side
_SHARED: Final = 0.01  # of the texels, that triangles may share: those on edges
_PADDING: Final = 4  # texels around what is covered, for who blends between texels


def bake_normals(
    coarse: Mesh,
    fine: Mesh,
    size: tuple[int, int] | None = None,
    *,
    device: Device | None = None,
) -> Mesh:
    """Return a coarse mesh with the normals of a fine one as a map that it carries.

    Parameters
    ----------
    coarse : Mesh
        With texture coordinates from 0 to 1 that no two of its triangles share. Without any it is
        ground: its map lies on it from above, over its whole extent.
    fine : Mesh
        What it stands for; its normals are blended over its triangles. It is looked for along the
        coarse mesh's normals, both ways, or straight up and down on ground; the nearest side that
        faces alike counts.
    size : (int, int), optional
        Texels across and down. Defaults to 1024 along the longer side.
    device : Device, optional

    Returns
    -------
    Mesh
        The coarse one with `textures` and `normal_map`, which .glb files hold. Where the fine mesh
        is not found, the map is flat. A texel cannot face away from the coarse mesh: such normals
        are laid into its plane.

    Raises
    ------
    InputError
        If a mesh is not sound, texture coordinates are not in the range, or triangles share texels.
    DeviceError
        If the device has no 64-bit floats.
    DeviceMemoryError
        If the device cannot hold meshes and map.

    Notes
    -----
    J. McDonald: *Tessellation on Any Budget*, GDC 2011, keeps such maps beside displacement;
    Khronos Group: *glTF 2.0 Specification*, 2021, 3.7.2.1 and 3.9.3, for the tangent space, with
    M. Mikkelsen, *Simulation of Wrinkled Surfaces Revisited*, 2008.
    """
    coarse, fine = sound_mesh(coarse), sound_mesh(fine)
    if not len(coarse.triangles):
        raise InputError("expected a coarse mesh with triangles, got an empty one")
    is_ground = coarse.textures is None
    if is_ground:
        coarse = replace(coarse, textures=_from_above(coarse))
    coarse, tangents = with_tangents(coarse)
    assert coarse.textures is not None
    low, high = coarse.textures.min(), coarse.textures.max()
    if not (low >= 0 and high <= 1):
        raise InputError(f"expected texture coordinates from 0 to 1, got {low:g} to {high:g}")
    columns, rows = _default_size(coarse, is_ground) if size is None else _checked(size)
    device = Device.of(device)
    device.require_doubles("normal maps")
    device.require(f"a map of {columns} x {rows} texels", 4 * rows * columns)

    # which triangle each texel belongs to
    arrays = {
        "triangles": device.array(coarse.triangles),
        "textures": device.array(coarse.textures),
        "rows": rows,
        "columns": columns,
    }
    owners, counts = device.empty(rows * columns, np.int32), device.zeros(1, np.uint32)
    owners.fill(-1)
    device.kernel("mesh/normal_map.cl", "cover")(
        (len(coarse.triangles),), (_GROUP,), count=len(coarse.triangles), **arrays, owners=owners
    )
    device.kernel("mesh/normal_map.cl", "shared_texels")(
        (len(coarse.triangles),),
        (_GROUP,),
        count=len(coarse.triangles),
        **arrays,
        owners=owners,
        counts=counts,
    )
    texels = np.flatnonzero(owners.host() >= 0).astype(np.int32)
    shared = int(counts.host()[0])
    if shared > _SHARED * len(texels) + 16:
        raise InputError(
            "expected texture coordinates that no two triangles share, got "
            f"{shared:,} of {len(texels):,} texels in several: unwrap the mesh anew"
        )

    # where each texel lies on the coarse mesh, and which triangle of the fine one it sees
    count = len(texels)
    device.require(f"normals of {count} texels", 24 * count, 24 * count, 24 * count)
    at = {
        "count": count,
        "texels": device.array(texels),
        "owners": owners,
        **arrays,
        "normals": device.array(coarse.normals),
    }
    points, ways = (device.empty((count, 3), np.float64) for _ in range(2))
    device.kernel("mesh/normal_map.cl", "place")(
        (count,),
        (_GROUP,),
        **at,
        vertices=device.array(coarse.vertices),
        points=points,
        ways=ways,
    )
    upright = np.tile([0.0, 0.0, 1.0], (count, 1))
    found, positions = _seen(
        fine, points.host() + coarse.origin, upright if is_ground else ways.host(), device
    )

    pixels = device.empty((count, 3), np.uint8)
    device.kernel("mesh/normal_map.cl", "encode")(
        (count,),
        (_GROUP,),
        **at,
        tangents=device.array(tangents),
        fine_triangles=device.array(fine.triangles),
        fine_vertices=device.array(fine.vertices),
        fine_normals=device.array(fine.normals),
        found=device.array(found),
        positions=device.array(positions - fine.origin),
        pixels=pixels,
    )
    picture = _padded(rows, columns, texels, pixels.host())
    return replace(coarse, normal_map=NormalMap(picture, tangents))


def _from_above(mesh: Mesh) -> npt.NDArray[np.float32]:
    """Return texture coordinates of ground: west to east, south to north."""
    across = mesh.vertices[:, :2].astype(np.float64)
    low, high = across.min(axis=0), across.max(axis=0)
    from_corner = (across - low) / np.maximum(high - low, 1e-30)
    textures: npt.NDArray[np.float32] = from_corner.astype(np.float32)
    return textures


def _default_size(mesh: Mesh, is_ground: bool) -> tuple[int, int]:
    if not is_ground:
        return _LONGEST, _LONGEST
    extent = np.ptp(mesh.vertices[:, :2].astype(np.float64), axis=0)
    columns, rows = np.maximum(np.ceil(_LONGEST * extent / extent.max()), 1).astype(int).tolist()
    return columns, rows


def _checked(size: tuple[int, int]) -> tuple[int, int]:
    across, down = (
        whole("size", texels, 1, _MOST) for texels in parts("size", size, "across", "down")
    )
    return across, down


def _seen(
    fine: Mesh, points: npt.NDArray[np.float64], ways: npt.NDArray[np.float64], device: Device
) -> tuple[npt.NDArray[np.int32], npt.NDArray[np.float64]]:
    """Return which triangle is nearest to each point along its way, or -1, and where."""
    queries = MeshQueries(fine, device=device)
    nearest = np.full(len(points), np.inf)
    found, positions = np.full(len(points), -1, np.int32), points.copy()
    for sign in (1.0, -1.0):
        hits = queries.cast(points, sign * ways)
        faces = (hits.normal * ways).sum(axis=1) > 0
        better = hits.hit & faces & (hits.distance < nearest)
        nearest[better] = hits.distance[better]
        found[better], positions[better] = hits.triangle[better], hits.position[better]
    return found, positions


def _padded(
    rows: int, columns: int, texels: npt.NDArray[np.int32], colours: npt.NDArray[np.uint8]
) -> npt.NDArray[np.uint8]:
    """Return the picture; what is not covered takes a neighbour's colour, or is flat far away."""
    picture = np.full((rows, columns, 3), (128, 128, 255), np.uint8)
    picture.reshape(-1, 3)[texels] = colours
    covered = np.zeros((rows, columns), bool)
    covered.reshape(-1)[texels] = True
    for _ in range(_PADDING):
        if covered.all():
            break
        before, colours = covered.copy(), picture.copy()
        for axis, step in ((0, 1), (0, -1), (1, 1), (1, -1)):
            beside = np.roll(before, step, axis)
            edge = 0 if step == 1 else -1
            beside[(edge,) if axis == 0 else (slice(None), edge)] = False
            fresh = beside & ~covered
            picture[fresh] = np.roll(colours, step, axis)[fresh]
            covered |= fresh
    return picture
